#include "framework/plot/stored_sweep.hpp"

#include <filesystem>
#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/output/sweep_files.hpp"
#include "framework/scene/document.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kColumnsAtTheEnd = 2;  // status and reason

bool holds_file(const std::string& folder, const char* name) {
  std::error_code error;
  return fs::is_regular_file(fs::path(folder) / name, error);
}

/// `[scene] axes`: what the scene calls its units.
std::map<std::string, std::string> units_of(const SceneDocument& document) {
  std::map<std::string, std::string> units;
  const Table* table = document.contents();
  for (const char* key : {"scene", "axes"}) {
    const Node* node = table == nullptr ? nullptr : table->find(key);
    table = node == nullptr ? nullptr : node->as<Table>();
  }
  if (table == nullptr) return units;
  for (const Entry& entry : table->entries) {
    if (const auto* unit = entry.value.as<std::string>()) units[entry.key] = *unit;
  }
  return units;
}

}  // namespace

std::vector<std::string> StoredSweep::observables() const {
  std::vector<std::string> names = table.names();
  names.erase(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(axes.size()));
  names.resize(names.size() - kColumnsAtTheEnd);
  return names;
}

std::vector<std::vector<double>> StoredSweep::read(const std::vector<std::size_t>& columns) const {
  std::vector<std::vector<double>> numbers = table.read(columns);
  if (numbers.front().size() != points) {
    refuse_input(FaultCode::file_damaged, table.file(), "",
                 fmt::format("{} rows, and {} has a sweep of {} points", numbers.front().size(),
                             kSceneFile, points));
  }
  return numbers;
}

bool holds_sweep(const std::string& folder) {
  return holds_file(folder, kSweepJournalFile) || holds_file(folder, kSweepTableFile);
}

StoredSweep read_stored_sweep(const std::string& folder) {
  if (!holds_file(folder, kSweepTableFile)) {
    refuse_input(FaultCode::plot_no_data, folder, "",
                 "the sweep is not finished; the same `tomlin sweep` command continues it");
  }
  const auto path = [&folder](const char* name) { return (fs::path(folder) / name).string(); };
  const SceneDocument document(path(kSceneFile));
  std::vector<Fault> faults;
  std::optional<SweepSettings> settings = document.sweep(faults);
  if (!faults.empty()) throw InputError(std::move(faults));
  if (!settings) {
    refuse_input(FaultCode::file_invalid, path(kSceneFile), "", "there is no [sweep] in it",
                 "the scene.toml that the sweep has left");
  }
  std::vector<SweepDimension> dimensions = sweep_dimensions(*settings, faults);
  if (!faults.empty()) throw InputError(std::move(faults));
  StoredSweep sweep = {{},
                       std::move(settings->over),
                       std::move(dimensions),
                       {},
                       {},
                       1,
                       SampleTable(path(kSweepTableFile), SampleTable::Rows::points)};
  sweep.run.folder = folder;
  sweep.run.units = units_of(document);
  sweep.dimension_of.resize(sweep.axes.size());
  sweep.stride.resize(sweep.dimensions.size());
  for (std::size_t d = sweep.dimensions.size(); d-- > 0;) {
    for (const std::size_t axis : sweep.dimensions[d].axes) sweep.dimension_of[axis] = d;
    sweep.stride[d] = sweep.points;
    sweep.points *= sweep.dimensions[d].count;
  }
  if (sweep.axes.empty() || sweep.table.columns().size() <= sweep.axes.size() + kColumnsAtTheEnd) {
    refuse_input(FaultCode::file_damaged, sweep.table.file(), "",
                 fmt::format("it is not the table of the sweep of {}", kSceneFile));
  }
  return sweep;
}

}  // namespace tomlin
