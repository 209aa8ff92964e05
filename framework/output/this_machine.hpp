#pragma once

#include <string>

namespace tomlin {

/// Machine that this program runs on, for those who ask where a result came from.
struct Machine {
  std::string processor;  ///< "Intel(R) Xeon(R) Processor"; empty where nothing says so
  std::string system;     ///< "Linux 6.1.0 x86_64"
};

Machine this_machine();

}  // namespace tomlin
