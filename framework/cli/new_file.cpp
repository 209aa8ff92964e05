#include "framework/cli/new_file.hpp"

#include <cerrno>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "framework/core/text/fault.hpp"
#include "framework/output/output_file.hpp"

namespace tomlin {
namespace fs = std::filesystem;

void refuse_to_replace(const fs::path& file, bool force) {
  std::error_code error;
  const auto status = fs::status(file, error);
  Fault fault(FaultCode::file_exists);
  fault.location.file = "-o";
  fault.key = file.string();
  if (fs::is_directory(status)) {
    fault.code = FaultCode::file_invalid;
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

void refuse_unwritable(const fs::path& file, const char* option) {
  Fault fault(FaultCode::file_cannot_write);
  fault.location.file = option;
  fault.key = file.string();
  fault.admissible = "a file in a folder that is there and may be written to";
  const fs::path parent = file.parent_path().empty() ? fs::path(".") : file.parent_path();
  std::error_code error;
  if (fs::is_directory(file, error) || fs::is_directory(unfinished(file), error)) {
    fault.code = FaultCode::file_invalid;
    fault.why = "this is a folder";
    fault.admissible = "a file";
  } else if (const auto status = fs::status(parent, error); !fs::exists(status)) {
    fault.why = "there is no folder " + parent.string();
  } else if (!fs::is_directory(status)) {
    fault.why = parent.string() + " is not a folder";
  } else if (::faccessat(AT_FDCWD, parent.c_str(), W_OK | X_OK, AT_EACCESS) != 0) {
    fault.why = "cannot be written to: " + std::generic_category().message(errno);
  } else {
    return;
  }
  throw InputError({std::move(fault)});
}

}  // namespace tomlin
