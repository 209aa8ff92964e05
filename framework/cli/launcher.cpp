#include "framework/cli/launcher.hpp"

#include <array>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

#include <dlfcn.h>
#include <fmt/format.h>

#include "framework/core/text/fault.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

/// Where launchers say how many processes they have started together. The first one that is set
/// counts: mpirun starts its processes within a step of SLURM. SLURM_NTASKS does not: in a batch
/// script it is set for a single process as well.
struct LauncherVariable {
  const char* name;
  const char* launcher;
};
constexpr std::array kLauncherVariables = {
    LauncherVariable{"OMPI_COMM_WORLD_SIZE", "Open MPI"},
    LauncherVariable{"PMI_SIZE", "a launcher with PMI"},
    LauncherVariable{"SLURM_STEP_NUM_TASKS", "srun"},
};

/// From the folder of the program, installed and in a build folder.
constexpr const char* kModule = "../lib/tomlin/tomlin_mpi.so";

constexpr const char* kRemedy =
    "one process, tomlin sweep --shard I/N in each process, or tomlin built where Open MPI is "
    "installed (Debian: libopenmpi-dev)";

int number_in(const char* text) {
  const std::string_view view = text;
  int number = 0;
  const auto [end, error] = std::from_chars(view.data(), view.data() + view.size(), number);
  return error == std::errc() && end == view.data() + view.size() ? number : 0;
}

fs::path module_path() {
  std::error_code error;
  return (fs::read_symlink("/proc/self/exe", error).parent_path() / kModule).lexically_normal();
}

[[noreturn]] void refuse_launch(int processes, const char* launcher, const std::string& why) {
  refuse_input(FaultCode::command_conflict, "tomlin", "",
               fmt::format("{} has started {} processes, which cannot share the sweep: {}",
                           launcher, processes, why),
               kRemedy);
}

const ProcessLink& loaded_link(int processes, const char* launcher) {
  const fs::path path = module_path();
  std::error_code error;
  if (!fs::exists(path, error)) {
    refuse_launch(processes, launcher, fmt::format("there is no {}", path.string()));
  }
  // MPI loads parts of its own, which find its symbols in this way only. It stays to the end.
  void* const handle = ::dlopen(path.c_str(), RTLD_NOW | RTLD_GLOBAL);
  if (handle == nullptr) refuse_launch(processes, launcher, ::dlerror());
  void* const symbol = ::dlsym(handle, kProcessLinkFunction);
  if (symbol == nullptr) refuse_launch(processes, launcher, ::dlerror());
  std::array<char, 200> why = {};
  const ProcessLink* const link =
      reinterpret_cast<ProcessLinkFunction>(symbol)(why.data(), why.size());
  if (link == nullptr) refuse_launch(processes, launcher, why.data());
  if (link->format != kProcessLinkFormat) {
    refuse_launch(processes, launcher, path.string() + " is of another version of tomlin");
  }
  if (link->size != processes) {
    link->end(link->context);
    refuse_launch(
        processes, launcher,
        fmt::format("the MPI of {} finds {}: it is not the launcher's", path.string(), link->size));
  }
  return *link;
}

}  // namespace

std::unique_ptr<LaunchedProcess> LaunchedProcess::find() {
  for (const LauncherVariable& variable : kLauncherVariables) {
    const char* const value = std::getenv(variable.name);  // NOLINT(concurrency-mt-unsafe)
    if (value == nullptr) continue;
    const int processes = number_in(value);
    if (processes <= 1) return nullptr;
    return std::unique_ptr<LaunchedProcess>(
        new LaunchedProcess(loaded_link(processes, variable.launcher)));
  }
  return nullptr;
}

LaunchedProcess::~LaunchedProcess() { link_.end(link_.context); }

}  // namespace tomlin
