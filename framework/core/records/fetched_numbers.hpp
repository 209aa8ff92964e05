#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "framework/core/records/body.hpp"
#include "framework/core/text/number_file.hpp"

namespace tomlin {

/// What stands in a file that a scene names, or why it cannot be had.
struct FetchedText {
  std::string text;
  std::filesystem::path path;  ///< the folder included
  std::vector<Complaint> complaints;
};

/// For `prepare`: the text of a file that `key` names, relative to the scene's folder.
FetchedText fetch_text(const std::string& name, const std::filesystem::path& folder,
                       const std::string& key);

/// What a file holds that a scene names, or why not.
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
