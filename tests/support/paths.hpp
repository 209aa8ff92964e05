#pragma once

/// Paths of the files that tests read and run; defined in a file that CMake makes for each test
/// binary, so that the sources of tests compile alike in every folder.
namespace tomlin::paths {

extern const char* const source;         ///< the checkout
extern const char* const program;        ///< `tomlin`
extern const char* const plugins;        ///< the folder of the tests' shared libraries
extern const char* const failing_calls;  ///< a library to preload: errors of the system on demand

}  // namespace tomlin::paths
