#include "framework/output/output_size.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <system_error>

#include <fmt/format.h>
#include <sys/stat.h>

#include "framework/core/text/fault.hpp"
#include "framework/output/extended_xyz.hpp"
#include "framework/output/h5md.hpp"
#include "framework/output/journal.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/output/table.hpp"
#include "framework/output/trajectory.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

/// Unit of block counts of stat() in bytes, whatever the file system's are.
constexpr double kBytesOfBlock = 512.0;
/// Usable part of the room: the rest is for folders and blocks that are not full.
constexpr double kFillable = 0.99;
/// Bytes around the state in a checkpoint: version, fingerprint, libraries.
constexpr double kAroundState = 4096.0;

/// Rounds up to three digits; a number that has three but for rounding stays.
double rounded_up(double x) {
  constexpr double kRounding = 1e-12;
  const double unit = std::pow(10.0, std::floor(std::log10(x)) - 2.0);
  return std::ceil(x / unit * (1.0 - kRounding)) * unit;
}

/// The folder that is there, or is the nearest above.
fs::path existing(fs::path path) {
  std::error_code error;
  while (!fs::exists(path, error) && path.has_relative_path()) path = path.parent_path();
  return path.empty() ? fs::path(".") : path;
}

/// Runs whose states are kept in run.store: perturbed starts, repeats, and companions that errors
/// are estimated with.
double runs_beside(const Scene& scene) {
  constexpr double kCompanions = 2.0;
  if (scene.run.accuracy) return kCompanions;
  const std::int64_t repeats =
      scene.run.perturb ? scene.run.perturb->repeats : scene.run.repeats - 1;
  return static_cast<double>(repeats);
}

std::string sizes(const Scene& scene, const OutputSize& size) {
  std::string text = fmt::format("{} of {}", bytes_text(size.table), kTableFile);
  if (scene.output.trajectory) {
    const bool xyz = scene.output.trajectory_format == TrajectoryFormat::xyz;
    text += fmt::format(", {} of {}", bytes_text(size.trajectory), xyz ? kXyzFile : kH5mdFile);
  }
  return text +
         fmt::format(" and {} of {}, a temporary file", bytes_text(size.journal), kJournalFile);
}

std::string room_text(double room) {
  return std::isfinite(room) ? "there is room for " + bytes_text(room)
                             : std::string("how much room there is is not known");
}

}  // namespace

OutputSize output_size(const Scene& scene, const RunLayout& layout) {
  OutputSize size;
  size.checkpoint = static_cast<double>(layout.state_bytes) + kAroundState;
  size.store = runs_beside(scene) * size.checkpoint;
  if (layout.columns.empty()) return size;
  size.rows = layout.most_samples;
  const auto table = static_cast<double>(table_bytes_per_row(layout));
  double frame = 0.0;
  double besides = 0.0;
  if (!layout.bodies.empty()) {
    const TrajectoryFacts facts = trajectory_facts(scene, "");
    const bool xyz = scene.output.trajectory_format == TrajectoryFormat::xyz;
    frame = xyz ? static_cast<double>(xyz_bytes_per_frame(layout, facts))
                : h5md_bytes_per_frame(layout);
    besides = xyz ? 0.0 : h5md_bytes_besides(layout, facts);
  }
  double names = 0.0;
  for (const SampleColumn& column : layout.columns) {
    names += static_cast<double>(column.name.size() + column.unit.size() + 4);
  }
  size.table = names + size.rows * table;
  size.trajectory = besides + size.rows * frame;
  size.journal = size.rows * journal_bytes_per_row(layout);
  size.per_row = table + frame + journal_bytes_per_row(layout);
  return size;
}

double room_in(const fs::path& folder) {
  std::error_code error;
  const fs::space_info space = fs::space(existing(folder), error);
  // Some file systems have no size.
  if (error || space.capacity == 0) return std::numeric_limits<double>::infinity();
  auto room = static_cast<double>(space.available);
  for (const char* name : kFilesOfARun) {
    struct stat status = {};
    if (::lstat((folder / name).c_str(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
    room += kBytesOfBlock * static_cast<double>(status.st_blocks);
  }
  return room;
}

double shortest_every(const Scene& scene, const OutputSize& size, double room) {
  if (!(size.per_row > 0.0)) return 0.0;
  const double besides = size.together() - size.rows * size.per_row;
  const double rows = std::min(kMostRows, std::floor((kFillable * room - besides) / size.per_row));
  // The start is a row, too.
  return rows < 2.0 ? 0.0 : rounded_up(scene.run.duration / (rows - 1.0));
}

void require_room(const Scene& scene, const OutputSize& size, double room) {
  if (size.rows <= kMostRows && size.together() <= room) return;
  Fault fault(FaultCode::output_too_large);
  if (!scene.output.every) {
    fault.location = scene.run.location;
    fault.key = "run";
    fault.why = fmt::format("its checkpoints take up to {}; {}",
                            bytes_text(2.0 * (size.checkpoint + size.store)), room_text(room));
    fault.admissible = "a folder with more room";
    throw InputError({fault});
  }
  fault.location = scene.output.location_of("every");
  fault.key = "output.every";
  fault.value = fmt::format("{:g}", *scene.output.every);
  fault.why = fmt::format("the run would write {}{:.10g} rows, up to {}; {}",
                          scene.run.until ? "as many as " : "", size.rows, sizes(scene, size),
                          room_text(room));
  const double every = shortest_every(scene, size, room);
  fault.admissible = every > 0.0 ? fmt::format(">= {:g}, which is {:.3g} rows", every,
                                               std::floor(scene.run.duration / every) + 1.0)
                                 : std::string("a folder with more room");
  if (size.together() <= room) fault.admissible += fmt::format("; at most {:g} rows", kMostRows);
  throw InputError({fault});
}

std::string bytes_text(double bytes) {
  constexpr double kThousand = 1000.0;
  constexpr std::array kUnits = {"bytes", "kB", "MB", "GB", "TB", "PB"};
  std::size_t unit = 0;
  while (bytes >= kThousand && unit + 1 < kUnits.size()) {
    bytes /= kThousand;
    ++unit;
  }
  return fmt::format("{:.3g} {}", bytes, kUnits.at(unit));
}

}  // namespace tomlin
