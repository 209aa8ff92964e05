#pragma once

#include <string>
#include <utility>
#include <vector>

namespace tomlin {

/// Text for people: titled sections of rows, all labels in one column.
class Sections {
 public:
  void section(std::string title);
  void row(std::string label, std::string content);

  /// Sections without rows are not shown.
  std::string text() const;

 private:
  struct Section {
    std::string title;
    std::vector<std::pair<std::string, std::string>> rows;
  };
  std::vector<Section> sections_;
};

}  // namespace tomlin
