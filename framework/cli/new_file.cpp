#include "framework/cli/new_file.hpp"

#include <system_error>
#include <utility>

#include "framework/core/fault.hpp"

namespace tomlin {
namespace fs = std::filesystem;

void refuse_to_replace(const fs::path& file, bool force) {
  std::error_code error;
  const auto status = fs::status(file, error);
  Fault fault;
  fault.place.file = "-o";
  fault.key = file.string();
  if (fs::is_directory(status)) {
    fault.why = "this is a folder";
    fault.admissible = "a file";
  } else if (fs::exists(status) && !force) {
    fault.why = "the file is there already";
    fault.admissible = "another name, or --force to replace it";
  } else {
    return;
  }
  throw InputError({std::move(fault)});
}

}  // namespace tomlin
