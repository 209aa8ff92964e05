#include "framework/output/this_machine.hpp"

#include <fstream>
#include <string_view>

#include <sys/utsname.h>

namespace tomlin {
namespace {

/// Name of the processor, as the system gives it.
std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (!std::string_view(line).starts_with("model name")) continue;
    const std::size_t colon = line.find(':');
    const std::size_t name = line.find_first_not_of(" \t", colon + 1);
    if (colon != std::string::npos && name != std::string::npos) return line.substr(name);
  }
  return "";
}

}  // namespace

Machine this_machine() {
  Machine machine;
  machine.processor = processor_name();
  utsname name = {};
  if (::uname(&name) == 0) {
    machine.system = std::string(name.sysname) + " " + name.release + " " + name.machine;
  }
  return machine;
}

}  // namespace tomlin
