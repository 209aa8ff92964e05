#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/core/text/fault.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/fault_list.hpp"

/// `plugins = ["libmorse.so"]`: shared libraries with components that a scene is made of. They are
/// loaded before the scene is read; see framework/plugin.
namespace tomlin {

/// One of them, as it is named.
struct NamedLibrary {
  std::string given;
  std::filesystem::path path;  ///< absolute; relative ones are to the scene's folder
  SourceLocation location;
};

/// Libraries of a document; an entry that is no name of a file is reported.
std::vector<NamedLibrary> named_libraries(const Table& document, const std::string& file,
                                          const Source& source, FaultList& faults);

}  // namespace tomlin
