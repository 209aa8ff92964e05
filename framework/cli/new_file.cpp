#include "framework/cli/new_file.hpp"

#include <cerrno>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include "framework/core/text/fault.hpp"
#include "framework/output/output_file.hpp"

namespace tomlin {
namespace fs = std::filesystem;

void refuse_to_replace(const fs::path& file, bool force) {
  std::error_code error;
  const auto status = fs::status(file, error);
  if (fs::is_directory(status)) {
    refuse_input(FaultCode::file_invalid, "-o", file.string(), "this is a folder", "a file");
  }
  if (fs::exists(status) && !force) {
    refuse_input(FaultCode::file_exists, "-o", file.string(), "the file is there already",
                 "another name, or --force to replace it");
  }
}

void refuse_unwritable(const fs::path& file, const char* option) {
  const auto refuse = [&](const std::string& why) {
    refuse_input(FaultCode::file_cannot_write, option, file.string(), why,
                 "a file in a folder that is there and may be written to");
  };
  std::error_code error;
  if (fs::is_directory(file, error) || fs::is_directory(unfinished(file), error)) {
    refuse_input(FaultCode::file_invalid, option, file.string(), "this is a folder", "a file");
  }
  const fs::path parent = file.parent_path().empty() ? fs::path(".") : file.parent_path();
  const auto status = fs::status(parent, error);
  if (!fs::exists(status)) refuse("there is no folder " + parent.string());
  if (!fs::is_directory(status)) refuse(parent.string() + " is not a folder");
  if (::faccessat(AT_FDCWD, parent.c_str(), W_OK | X_OK, AT_EACCESS) != 0) {
    refuse("cannot be written to: " + std::generic_category().message(errno));
  }
}

void write_new_file(const fs::path& file, std::string_view text) {
  OutputFile output(file);
  output.append(text);
  output.publish();
}

}  // namespace tomlin
