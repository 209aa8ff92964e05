#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "framework/core/records/body.hpp"
#include "framework/core/text/number_file.hpp"

namespace tomlin {

/// Texts of files by the names that a scene has for them: each file is read once and has the same
/// text from then on. Safe to call from several threads.
class FileTexts {
 public:
  FileTexts() = default;
  explicit FileTexts(const std::map<std::string, std::string>& accepted);

  /// Returns the files of scenes that were accepted; the text of any other file stays private.
  std::map<std::string, std::string> accepted() const;
  std::optional<std::string> find(const std::string& name) const;
  void keep(const std::string& name, std::string_view text);
  void accept(const std::set<std::string>& names);

 private:
  struct Text {
    std::string text;
    bool accepted = false;
  };
  mutable std::mutex mutex_;
  std::map<std::string, Text> texts_;
};

/// While this lives, fetch_text() takes texts from here in this thread, and keeps there what it has
/// read. Null: it reads files.
class FileTextsInUse {
 public:
  explicit FileTextsInUse(FileTexts* texts);
  ~FileTextsInUse();
  FileTextsInUse(const FileTextsInUse&) = delete;
  FileTextsInUse& operator=(const FileTextsInUse&) = delete;

  std::optional<std::string> find(const std::string& name);
  /// Returns the text of a file as UTF-8; bytes that are not valid are replaced.
  void keep(const std::string& name, std::string& text);
  /// The scene is accepted that these texts were for.
  void accept();

 private:
  FileTexts* texts_;
  FileTextsInUse* before_;
  std::set<std::string> names_;
};

/// Text of a file that a scene names, or the reason why it cannot be had.
struct FetchedText {
  std::string text;
  std::filesystem::path path;  ///< the folder included
  std::vector<Complaint> complaints;
};

/// For `prepare`: the text of a file that `key` names, relative to the scene's folder.
FetchedText fetch_text(const std::string& name, const std::filesystem::path& folder,
                       const std::string& key);

/// Numbers of a file that a scene names, or the reason why there are none.
struct FetchedNumbers {
  NumberFile file;
  std::filesystem::path path;  ///< the folder included
  std::vector<Complaint> complaints;
};

/// For `prepare`: the rows of numbers in a file that `key` names, relative to the scene's folder;
/// see parse_numbers.
FetchedNumbers fetch_numbers(const std::string& name, const std::filesystem::path& folder,
                             const std::string& key, std::size_t most_columns,
                             const std::string& why_most);

}  // namespace tomlin
