#include "framework/core/records/fetched_numbers.hpp"

#include <utility>

#include <fmt/format.h>

#include "framework/core/text/text_file.hpp"

namespace tomlin {
namespace {

constexpr std::size_t kLargestFile = std::size_t{16} << 20;  // bytes; as of a scene

}  // namespace

FetchedText fetch_text(const std::string& name, const std::filesystem::path& folder,
                       const std::string& key) {
  FetchedText fetched;
  const auto refuse = [&](FaultCode code, std::string why, std::string admissible = "") {
    fetched.complaints.push_back(
        {.key = key, .why = std::move(why), .admissible = std::move(admissible), .code = code});
  };
  if (name.find('\0') != std::string::npos) {
    refuse(FaultCode::file_cannot_read, "not the name of a file");
    return fetched;
  }
  fetched.path = folder / name;
  TextFile contents = read_text_file(fetched.path, kLargestFile);
  if (!contents.why.empty()) {
    refuse(FaultCode::file_cannot_read, fetched.path.string() + ": " + contents.why);
  } else if (contents.too_large) {
    refuse(FaultCode::scene_too_large, fetched.path.string() + ": the file is too large",
           fmt::format("at most {} MB", kLargestFile >> 20));
  }
  fetched.text = std::move(contents.text);
  return fetched;
}

FetchedNumbers fetch_numbers(const std::string& name, const std::filesystem::path& folder,
                             const std::string& key, std::size_t most_columns,
                             const std::string& why_most) {
  FetchedText text = fetch_text(name, folder, key);
  FetchedNumbers fetched{{}, std::move(text.path), std::move(text.complaints)};
  if (!fetched.complaints.empty()) return fetched;
  fetched.file = parse_numbers(text.text, fetched.path.string(), most_columns, why_most);
  for (std::string& fault : fetched.file.faults) {
    fetched.complaints.push_back(
        {.key = key, .why = std::move(fault), .code = FaultCode::file_invalid});
  }
  return fetched;
}

}  // namespace tomlin
