#include "framework/study/sweep/sweep_plan.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "framework/core/records/parameter.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/output/checkpoint.hpp"
#include "framework/output/checksum.hpp"
#include "framework/run/results/observables.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/effective.hpp"
#include "framework/scene/settings.hpp"
#include "framework/scene/text.hpp"
#include "framework/study/tradeoff/trial_run.hpp"

namespace tomlin {
namespace {

/// Points that are tried before all are taken to be refused.
constexpr std::size_t kMostTried = 1000;
/// Values of one axis whose faults are shown.
constexpr std::size_t kMostWrongValues = 10;

constexpr double kNoPoint = std::numeric_limits<double>::quiet_NaN();

/// Columns of the results besides axes and observables.
constexpr std::string_view kTakenTitles[] = {"status", "reason", "point"};

/// Wrong whatever the other values of a scene are.
bool is_wrong_anyway(const Fault& fault) {
  using enum FaultCode;
  constexpr FaultCode kCodes[] = {
      scene_encoding,       scene_unknown_key,       scene_unknown_name, scene_wrong_type,
      scene_unknown_choice, scene_unknown_component, expression_syntax,  expression_unknown_name,
      scene_syntax,         command_invalid_value};
  return std::find(std::begin(kCodes), std::end(kCodes), fault.code) != std::end(kCodes);
}

bool is_among(const InputError& error, const Fault& fault) {
  return std::any_of(error.faults().begin(), error.faults().end(), [&fault](const Fault& other) {
    return other.code == fault.code && to_string(other) == to_string(fault);
  });
}

/// "driver.work" of "drivers.driver.work", where that is found by it.
std::string short_name(const RunResult& result, const std::string& path) {
  const std::size_t dot = path.find('.');
  if (dot == std::string::npos) return path;
  const std::string name = path.substr(dot + 1);
  try {
    return full_path(result, name) == path ? name : path;
  } catch (const InputError&) {
    return path;
  }
}

bool sets_below(const std::vector<SweepAxis>& axes, std::string_view key) {
  return std::any_of(axes.begin(), axes.end(), [key](const SweepAxis& axis) {
    return axis.name.substr(0, key.size()) == key;
  });
}

}  // namespace

SweepPlan::SweepPlan(SceneDocument document, const Registry& registry,
                     std::vector<Setting> settings, SweepSettings sweep,
                     std::string program_version, std::vector<Fault> faults)
    : document_(std::move(document)),
      registry_(registry),
      settings_(std::move(settings)),
      sweep_(std::move(sweep)),
      program_version_(std::move(program_version)) {
  document_.drop_sweep();
  document_.keep_files();
  find_points(faults);
  for (std::size_t axis = 0; axis < axes().size(); ++axis) check_axis(axis, faults);
  find_scene(faults);
  if (scene_) find_observables(faults);
  if (!faults.empty()) throw InputError(std::move(faults));
  name_columns();
  scene_text_ = write_scene();
  identity_ = find_identity();
}

void SweepPlan::find_points(std::vector<Fault>& faults) {
  const std::size_t before = faults.size();
  dimensions_ = sweep_dimensions(sweep_, faults);
  dimension_of_.resize(sweep_.over.size());
  stride_.resize(dimensions_.size());
  std::size_t points = 1;
  for (std::size_t d = dimensions_.size(); d-- > 0;) {
    for (const std::size_t axis : dimensions_[d].axes) dimension_of_[axis] = d;
    stride_[d] = points;
    points *= dimensions_[d].count;
  }
  refinement_ = sweep_refinement(sweep_, dimensions_, faults);
  if (faults.size() == before) points_ = points;
  if (refinement_) added_.assign(points_ * refinement_->rounds, kNoPoint);
}

/// A fault that occurs without the axes and at the first points as well is one of the scene itself.
void SweepPlan::find_scene(std::vector<Fault>& faults) {
  std::vector<Fault> always;
  std::vector<Fault> of_first;
  try {
    scene_ = document_.read(registry_, settings_);
    return;
  } catch (const InputError& error) {
    always = of_first = error.faults();
  }
  for (std::size_t point = 0; point < std::min(points_, kMostTried); ++point) {
    try {
      scene_ = scene_at(point);
      return;
    } catch (const InputError& error) {
      if (point == 0) of_first = error.faults();
      std::erase_if(always, [&error](const Fault& fault) { return !is_among(error, fault); });
      if (std::any_of(always.begin(), always.end(), is_wrong_anyway)) break;
    }
  }
  // An axis that is not right may be what the scene lacks.
  if (points_ == 0 || !sweep_.unread.empty()) std::erase_if(always, std::not_fn(is_wrong_anyway));
  if (always.empty() && faults.empty()) always = of_first;
  faults.insert(faults.end(), always.begin(), always.end());
}

std::size_t SweepPlan::index(std::size_t axis, std::size_t point) const {
  const std::size_t d = dimension_of_[axis];
  return left_of(point) / stride_[d] % dimensions_[d].count;
}

double SweepPlan::number(std::size_t axis, std::size_t point) const {
  return is_added(axis, point) ? added_[point - points_]
                               : axes()[axis].values.number(index(axis, point));
}

std::string SweepPlan::text(std::size_t axis, std::size_t point) const {
  return is_added(axis, point) ? number_as_setting(added_[point - points_])
                               : axes()[axis].values.text(index(axis, point));
}

std::vector<Setting> SweepPlan::settings_at(std::size_t point) const {
  std::vector<Setting> settings;
  settings.reserve(axes().size());
  for (std::size_t axis = 0; axis < axes().size(); ++axis) {
    settings.push_back({axes()[axis].name, text(axis, point)});
  }
  return settings;
}

std::vector<Setting> SweepPlan::all_settings_at(std::size_t point) const {
  std::vector<Setting> settings = settings_;
  std::vector<Setting> more = settings_at(point);
  settings.insert(settings.end(), std::make_move_iterator(more.begin()),
                  std::make_move_iterator(more.end()));
  return settings;
}

std::shared_ptr<const Scene> SweepPlan::scene_at(std::size_t point, EffectiveText text) const {
  return document_.read(registry_, all_settings_at(point), text);
}

/// Returns a fault of setting n that does not depend on the rest of the scene, if there is one.
std::optional<Fault> SweepPlan::fault_of(const std::vector<Setting>& settings,
                                         std::size_t n) const {
  try {
    document_.read(registry_, settings);
  } catch (const InputError& error) {
    Extent of_setting;
    of_setting.setting = static_cast<std::uint32_t>(n + 1);
    const std::string location = Source("", "", settings).location(of_setting).file;
    const auto found =
        std::find_if(error.faults().begin(), error.faults().end(), [&location](const Fault& fault) {
          return fault.location.file == location && is_wrong_anyway(fault);
        });
    if (found != error.faults().end()) return *found;
  }
  return std::nullopt;
}

/// Whether it is; then its scene, with what it reads from files, becomes part of the identity.
bool SweepPlan::is_accepted(std::size_t point) {
  try {
    const std::string text = without_plugin_paths(scene_at(point)->effective_toml);
    contents_ = checksum_of(std::as_bytes(std::span(text)), contents_);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

/// A value is wrong where it is so without the other axes and at the first point that has it. One
/// that only does not go together with the others is left to its points.
void SweepPlan::check_axis(std::size_t index, std::vector<Fault>& faults) {
  const SweepAxis& axis = axes()[index];
  const std::size_t before = faults.size();
  for (std::size_t k = 0; k < axis.values.size(); ++k) {
    if (k > 0 && axis.values.numeric()) return;
    const std::size_t first = k * stride_[dimension_of_[index]];
    if (points_ > 0 && !axis.values.numeric() && is_accepted(first)) continue;
    std::vector<Setting> alone = settings_;
    alone.push_back({axis.name, axis.values.text(k)});
    std::optional<Fault> found = fault_of(alone, settings_.size());
    if (found && points_ > 0) {
      found = fault_of(all_settings_at(first), settings_.size() + index);
    }
    if (!found) continue;
    const bool of_name = found->code == FaultCode::scene_unknown_key ||
                         found->code == FaultCode::scene_unknown_name ||
                         found->code == FaultCode::command_invalid_value;
    found->location = axis.location;
    found->value = shortened(axis.values.text(k), kLongestShownValue);
    faults.push_back(*std::move(found));
    if (of_name || faults.size() == before + kMostWrongValues) return;
  }
}

/// Observables are known once a scene is bound: scene(), which gives the sweep its name and text,
/// or, where binding it is refused, the scene of the first point that is accepted.
void SweepPlan::find_observables(std::vector<Fault>& faults) {
  std::optional<RunResult> result;
  std::optional<InputError> refused;
  try {
    result = result_at_start(scene_);
  } catch (const InputError& error) {
    refused = error;
  }
  if (!faults.empty() && !result) return;
  for (std::size_t point = 0; !result && point < std::min(points_, kMostTried); ++point) {
    try {
      result = result_at_start(scene_at(point));
    } catch (const InputError&) {
      continue;
    }
  }
  if (!result) throw InputError(*refused);

  for (const std::string& given : sweep_.observables) {
    find_observable(*result, given, sweep_.observables_location, faults);
  }
  const std::string refined = refined_observable(sweep_.refine);
  if (refined.empty()) return;
  const SourceLocation& location = sweep_.refine.what->location;
  find_observable(*result, refined, location, faults);
  if (!faults.empty()) return;
  const std::string path = full_path(*result, refined, location);
  refined_column_ =
      static_cast<std::size_t>(std::find(paths_.begin(), paths_.end(), path) - paths_.begin());
}

/// One that is there already comes once.
void SweepPlan::find_observable(const RunResult& result, const std::string& given,
                                const SourceLocation& location, std::vector<Fault>& faults) {
  try {
    const std::string path = full_path(result, given, location);
    if (path.starts_with("performance.")) {
      faults.emplace_back(FaultCode::command_invalid_value, location, given, "",
                          "how fast a run was is not a result of it", "an observable of the scene");
      return;
    }
    if (std::find(paths_.begin(), paths_.end(), path) != paths_.end()) return;
    const std::vector<Observable> all = tomlin::observables(result);
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const Observable& one) { return one.path == path; });
    observables_.push_back({path, short_name(result, path),
                            unit_in_tables(scene_->units, *found->quantity),
                            found->quantity->meaning});
    paths_.push_back(path);
  } catch (const InputError& error) {
    faults.insert(faults.end(), error.faults().begin(), error.faults().end());
  }
}

void SweepPlan::name_columns() {
  const auto add = [this](SweepColumn::Kind kind, const char* before) {
    for (std::size_t k = 0; k < observables_.size(); ++k) {
      columns_.push_back({kind, k, before + observables_[k].name});
    }
  };
  add(SweepColumn::Kind::value, "");
  if (scene_->run.accuracy || sets_below(axes(), "run.accuracy") || has_noise_somewhere()) {
    add(SweepColumn::Kind::error, "error.");
  }
  if (scene_->run.perturb || sets_below(axes(), "run.perturb")) {
    add(SweepColumn::Kind::spread, "spread.");
  }
}

template <class Holds>
bool SweepPlan::somewhere(Holds holds) const {
  if (holds(*scene_)) return true;
  if (points_ == 0) return false;
  try {
    return holds(*scene_at(points_ - 1));
  } catch (const InputError&) {
    return false;
  }
}

bool SweepPlan::has_noise_somewhere() const { return somewhere(&has_noise); }
bool SweepPlan::is_random_somewhere() const { return somewhere(&draws_by_stream); }

std::string SweepPlan::axis_title(std::size_t axis) const {
  const std::string& name = axes()[axis].name;
  const bool taken =
      name.starts_with("point_") ||  // as dimensions of zipped axes
      std::find(std::begin(kTakenTitles), std::end(kTakenTitles), name) != std::end(kTakenTitles) ||
      std::any_of(columns_.begin(), columns_.end(),
                  [&](const SweepColumn& column) { return column.name == name; });
  return taken ? "parameters." + name : name;
}

/// The effective scene has by value what its files hold. A component of which axes change the file,
/// or what is taken from it, stands as it was written, and the files are given with the scene.
std::string SweepPlan::scene_without_sweep() {
  const std::map<std::string, std::string> read = document_.files();
  if (read.empty()) return scene_->effective_toml;
  std::optional<Table> effective;
  const Table written = document_.with(settings_);
  for (const char* kind : {"body", "force"}) {
    const Node* const components = written.find(kind);
    const List* const list = components != nullptr ? components->as<List>() : nullptr;
    for (std::size_t k = 0; list != nullptr && k < list->size(); ++k) {
      const auto* const table = (*list)[k].as<Table>();
      if (table == nullptr) continue;
      const std::string path = fmt::format("{}.{}.", kind, name_of(*table));
      std::set<std::string> names;
      bool is_swept = false;
      for (const SweepAxis& axis : axes()) {
        if (!axis.name.starts_with(path)) continue;
        is_swept = true;
        for (std::size_t v = 0; !axis.values.numeric() && v < axis.values.size(); ++v) {
          names.insert(axis.values.plain_text(v));
        }
      }
      for (const Entry& entry : table->entries) {
        if (const auto* text = entry.value.as<std::string>()) names.insert(*text);
      }
      std::erase_if(names, [&read](const std::string& name) { return !read.contains(name); });
      if (!is_swept || names.empty()) continue;
      for (const std::string& name : names) files_.emplace(name, read.at(name));
      if (!effective) effective = parse_document(scene_->effective_toml, scene_->file);
      (*effective->find(kind)->as<List>())[k] = (*list)[k];
    }
  }
  return effective ? to_toml(*effective) : scene_->effective_toml;
}

std::string SweepPlan::write_scene() {
  std::string text = scene_without_sweep();
  text += fmt::format("\n[sweep]\nobservables = [{}]\n", fmt::join(in_quotes(paths_), ", "));
  if (!sweep_.zips.empty()) {
    std::vector<std::string> groups;
    for (const SweepZip& zip : sweep_.zips) {
      groups.push_back(fmt::format("[{}]", fmt::join(in_quotes(zip.names), ", ")));
    }
    text += fmt::format("zip = [{}]\n", fmt::join(groups, ", "));
  }
  if (sweep_.continues) text += "continue_from_neighbour = true\n";
  if (refinement_) {
    std::string what = paths_[refined_column_];
    if (refinement_->level) what += fmt::format("={}", *refinement_->level);
    text += fmt::format("refine = {}\nrefine_along = {}\nrefine_to = {}\n", quoted_text(what),
                        quoted_text(axes()[refinement_->axis].name), refinement_->width);
  }
  text += "\n[sweep.over]\n";
  for (const SweepAxis& axis : axes()) {
    std::string values;
    if (axis.values.spacing() != SweepValues::Spacing::list) {
      values = quoted_text(axis.values.canonical());
    } else {
      std::vector<std::string> all;
      for (std::size_t k = 0; k < axis.values.size(); ++k) {
        all.push_back(value_text(parse_setting(axis.values.text(k), 0)));
      }
      values = fmt::format("[{}]", fmt::join(all, ", "));
    }
    text += quoted_text(axis.name) + " = " + values + "\n";
  }
  if (!files_.empty()) text += "\n[sweep.files]\n";
  for (const auto& [name, content] : files_) {
    text += fmt::format("{} = {}\n", quoted_text(name), quoted_text(content));
  }
  return text;
}

std::uint64_t SweepPlan::find_identity() const {
  std::string text = program_version_ + "\n" + without_plugin_paths(scene_text()) + "\n";
  for (const Library& library : scene_->libraries) text += library.hash + "\n";
  for (const SweepColumn& column : columns_) text += column.name + "\n";
  text += fmt::format("{:x}\n", contents_);
  return checksum_of(std::as_bytes(std::span(text)), 0);
}

}  // namespace tomlin
