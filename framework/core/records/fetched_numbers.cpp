#include "framework/core/records/fetched_numbers.hpp"

#include <utility>

#include <fmt/format.h>

#include "framework/core/text/text_file.hpp"

namespace tomlin {
namespace {

constexpr std::size_t kLargestFile = std::size_t{16} << 20;  // bytes; as of a scene

}  // namespace

FetchedNumbers fetch_numbers(const std::string& name, const std::filesystem::path& folder,
                             const std::string& key, std::size_t most_columns,
                             const std::string& why_most) {
  FetchedNumbers fetched;
  const auto refuse = [&](FaultCode code, std::string why, std::string admissible = "") {
    fetched.complaints.push_back(
        {.key = key, .why = std::move(why), .admissible = std::move(admissible), .code = code});
  };
  if (name.find('\0') != std::string::npos) {
    refuse(FaultCode::file_cannot_read, "not the name of a file");
    return fetched;
  }
  fetched.path = folder / name;
  const TextFile contents = read_text_file(fetched.path, kLargestFile);
  if (!contents.why.empty()) {
    refuse(FaultCode::file_cannot_read, fetched.path.string() + ": " + contents.why);
  } else if (contents.too_large) {
    refuse(FaultCode::scene_too_large, fetched.path.string() + ": the file is too large",
           fmt::format("at most {} MB", kLargestFile >> 20));
  } else {
    fetched.file = parse_numbers(contents.text, fetched.path.string(), most_columns, why_most);
    for (std::string& fault : fetched.file.faults) {
      refuse(FaultCode::file_invalid, std::move(fault));
    }
  }
  return fetched;
}

}  // namespace tomlin
