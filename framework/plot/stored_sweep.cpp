#include "framework/plot/stored_sweep.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <numeric>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/output/number_text.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/output/sweep_files.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/sweep_refinement.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kColumnsAtTheEnd = 2;  // status and reason

bool holds_file(const std::string& folder, const char* name) {
  std::error_code error;
  return fs::is_regular_file(fs::path(folder) / name, error);
}

/// A table in another; null where there is none.
const Table* table_in(const Table* table, const char* key) {
  const Node* node = table == nullptr ? nullptr : table->find(key);
  return node == nullptr ? nullptr : node->as<Table>();
}

/// `[scene]` units and axes: the system of units, and what the scene calls them.
void read_units(const SceneDocument& document, StoredRun& run) {
  const Table* heading = table_in(document.contents(), "scene");
  const Node* system = heading == nullptr ? nullptr : heading->find("units");
  if (system != nullptr && system->as<std::string>() != nullptr) {
    run.system = value_named<UnitSystem>(*system->as<std::string>()).value_or(run.system);
  }
  const Table* axes = table_in(heading, "axes");
  if (axes == nullptr) return;
  for (const Entry& entry : axes->entries) {
    if (const auto* unit = entry.value.as<std::string>()) run.units[entry.key] = *unit;
  }
}

/// The words of an axis, as the table has them.
std::string word_of(const SweepValues& values, std::size_t k) {
  if (!values.numeric()) return values.plain_text(k);
  std::string text;
  append_number(text, values.number(k));
  return text;
}

/// Points of a refined sweep, from the words of the axes in each row.
void find_points(StoredSweep& sweep) {
  std::vector<std::size_t> columns(sweep.axes.size());
  std::iota(columns.begin(), columns.end(), std::size_t{0});
  const std::vector<std::vector<std::string>> words = sweep.table.read_words(columns);
  const std::size_t refined = *sweep.refined;
  const bool rises = sweep.axes[refined].values.number(1) > sweep.axes[refined].values.number(0);
  std::vector<double> numbers = sweep.table.read({refined})[0];
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  if (!rises) std::reverse(numbers.begin(), numbers.end());
  std::vector<std::string> texts;
  texts.reserve(numbers.size());
  for (const double number : numbers) texts.push_back(number_as_setting(number));
  sweep.axes[refined].values = SweepValues::listed(std::move(texts));
  sweep.points = words[0].size();
  sweep.indices.assign(sweep.points, std::vector<std::size_t>(sweep.dimensions.size()));
  for (std::size_t d = 0; d < sweep.dimensions.size(); ++d) {
    const std::vector<std::size_t>& axes = sweep.dimensions[d].axes;
    if (axes.front() == refined) sweep.dimensions[d].count = numbers.size();
    std::map<std::vector<std::string>, std::size_t> index_of;
    for (std::size_t k = 0; k < sweep.dimensions[d].count; ++k) {
      std::vector<std::string> key(axes.size());
      std::transform(axes.begin(), axes.end(), key.begin(),
                     [&sweep, k](std::size_t axis) { return word_of(sweep.axes[axis].values, k); });
      index_of.emplace(std::move(key), k);
    }
    for (std::size_t point = 0; point < sweep.points; ++point) {
      std::vector<std::string> key(axes.size());
      std::transform(axes.begin(), axes.end(), key.begin(),
                     [&words, point](std::size_t axis) { return words[axis][point]; });
      const auto found = index_of.find(key);
      if (found == index_of.end()) {
        refuse_input(FaultCode::file_damaged, sweep.table.file(), "",
                     fmt::format("{} = {} in row {} is no value of the sweep of {}",
                                 sweep.axes[axes.front()].name, key.front(), point, kSceneFile));
      }
      sweep.indices[point][d] = found->second;
    }
  }
}

}  // namespace

std::vector<std::size_t> StoredSweep::line(std::size_t dimension, std::size_t point) const {
  std::vector<std::size_t> found;
  if (!refined) {
    const std::size_t first = point - index(dimension, point) * stride[dimension];
    for (std::size_t k = 0; k < dimensions[dimension].count; ++k) {
      found.push_back(first + k * stride[dimension]);
    }
    return found;
  }
  std::vector<std::size_t> wanted = indices[point];
  for (std::size_t other = 0; other < points; ++other) {
    wanted[dimension] = indices[other][dimension];
    if (indices[other] == wanted) found.push_back(other);
  }
  return found;
}

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
  const auto refinement = sweep_refinement(*settings, dimensions, faults);
  if (!faults.empty()) throw InputError(std::move(faults));
  StoredSweep sweep = {{},
                       std::move(settings->over),
                       std::move(dimensions),
                       {},
                       {},
                       1,
                       {},
                       {},
                       {},
                       SampleTable(path(kSweepTableFile), SampleTable::Rows::points)};
  sweep.run.folder = folder;
  read_units(document, sweep.run);
  sweep.dimension_of.resize(sweep.axes.size());
  sweep.stride.resize(sweep.dimensions.size());
  for (std::size_t d = sweep.dimensions.size(); d-- > 0;) {
    for (const std::size_t axis : sweep.dimensions[d].axes) sweep.dimension_of[axis] = d;
    sweep.stride[d] = sweep.points;
    sweep.points *= sweep.dimensions[d].count;
  }
  for (const SweepAxis& axis : sweep.axes) {
    sweep.logarithmic.push_back(axis.values.spacing() == SweepValues::Spacing::logarithmic);
  }
  if (sweep.axes.empty() || sweep.table.columns().size() <= sweep.axes.size() + kColumnsAtTheEnd) {
    refuse_input(FaultCode::file_damaged, sweep.table.file(), "",
                 fmt::format("it is not the table of the sweep of {}", kSceneFile));
  }
  if (refinement) {
    sweep.refined = refinement->axis;
    find_points(sweep);
  }
  return sweep;
}

}  // namespace tomlin
