#include "framework/study/tradeoff/tradeoff.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/run/engine.hpp"
#include "framework/run/results/observables.hpp"
#include "framework/study/tradeoff/measurer.hpp"
#include "framework/study/tradeoff/work_precision.hpp"

namespace tomlin {
namespace {

/// An error a hundred times below the tolerance need not get smaller.
constexpr double kFineEnough = 0.01;
/// A method may be better than the reference by chance, not by more than that.
constexpr double kErrorsOfReference = 2.0;
/// A spread beyond this part of the value leaves nothing to recommend a setting for.
constexpr double kMostSpread = 0.1;
constexpr const char* kNotDetermined = "the result is not determined: no digit of it has a meaning";

[[noreturn]] void refuse(const std::string& path, const char* why) {
  throw InputError({Fault(FaultCode::command_invalid_value, {.file = "--observable"}, path, "", why,
                          "an observable of the scene")});
}

/// The path in full. Throws for what is no result of a scene.
std::string full_path(const std::shared_ptr<const Scene>& scene, const std::string& path) {
  const RunResult result = result_at_start(scene);
  observable(result, path, {.file = "--observable"});
  std::string full = path;
  for (const Observable& one : observables(result)) {
    if (one.path == "drivers." + path || one.path == "bodies." + path) full = one.path;
  }
  if (full.starts_with("performance.")) {
    refuse(path, "how fast a run was is not a result of it");
  }
  if (full.starts_with("time.") && full != "time.end") {
    refuse(path, "how many steps a run took is not a result of it");
  }
  return full;
}

class TradeoffStudy {
 public:
  TradeoffStudy(const std::shared_ptr<const Scene>& scene, const Registry& registry,
                const TradeoffRequest& request)
      : request_(request),
        variants_(scene, registry),
        measurer_(variants_, full_path(scene, request.observable), request.budget, request.stop,
                  request.pace) {
    found_.observable = measurer_.observable();
    found_.units = scene->units;
    found_.tolerance = request.tolerance;
    found_.budget = request.budget;
  }

  Tradeoff measure() {
    found_.methods = methods_for(variants_);
    say("reference");
    found_.reference =
        find_reference(variants_, found_.methods, measurer_, found_.tolerance, found_.why_none);
    if (found_.reference) {
      found_.scale = error_scale(*found_.reference);
      say("perturbed starts");
      found_.sensitivity = find_sensitivity(variants_, found_.methods, *found_.reference, measurer_,
                                            found_.tolerance);
      if (!found_.scale.resolved) return unresolved();
      climb();
      recommend();
    } else {
      leave_all_out("there is no reference");
    }
    return finished();
  }

 private:
  Tradeoff finished() {
    found_.interrupted = measurer_.interrupted();
    found_.seconds = measurer_.used();
    return std::move(found_);
  }

  /// No error can be measured against it, and no setting be recommended.
  Tradeoff unresolved() {
    const Reference& reference = *found_.reference;
    leave_all_out("the reference is not resolved");
    if (!is_determined()) {
      found_.why_none = kNotDetermined;
      return finished();
    }
    found_.why_none = fmt::format(
        "the reference is not resolved: {:.2g} with an error of {:.1e}{}", reference.value,
        reference.error,
        reference.finest ? ", at the finest that its numbers keep" : "; a larger budget may do");
    return finished();
  }

  void say(const std::string& what) const {
    if (request_.on_progress) request_.on_progress(what);
  }

  bool is_determined() const {
    return found_.sensitivity.verdict != Sensitivity::Verdict::not_determined;
  }

  /// The tolerance that has a meaning: below the spread no digit does.
  double tolerance() const {
    const double asked = found_.tolerance * found_.scale.size;
    return is_determined() ? asked : std::max(asked, found_.sensitivity.spread);
  }

  Aim aim() const {
    const Reference& reference = *found_.reference;
    Aim aim;
    aim.reference = reference.value;
    aim.tolerance = tolerance();
    aim.fine_enough = std::max(kFineEnough * aim.tolerance, kErrorsOfReference * reference.error);
    aim.doubt = reference.error;
    return aim;
  }

  void climb() {
    const Aim aim = this->aim();
    const double duration = variants_.scene().run.duration;
    const std::size_t count = found_.methods.size();
    for (std::size_t r = 0; r < count; ++r) {
      if (measurer_.interrupted()) return;
      if (found_.methods[r].refused.empty()) say(found_.methods[r].name);
      // The part of its share that a method leaves goes to those that follow.
      const auto runs = std::count_if(found_.methods.begin() + static_cast<std::ptrdiff_t>(r),
                                      found_.methods.end(),
                                      [](const Method& method) { return method.refused.empty(); });
      const double share =
          measurer_.left() / static_cast<double>(std::max<std::ptrdiff_t>(runs, 1));
      walk(r, found_.methods, duration, aim, share, measurer_, found_);
    }
    say("steps near the tolerance");
    refine(aim, measurer_, found_);
    std::stable_sort(found_.points.begin(), found_.points.end(),
                     [](const TradeoffPoint& a, const TradeoffPoint& b) {
                       return a.method != b.method ? a.method < b.method
                                                   : a.resolution > b.resolution;
                     });
    mark_best(found_);
  }

  void recommend() {
    if (!is_determined() &&
        found_.sensitivity.spread > kMostSpread * std::abs(found_.reference->value)) {
      found_.why_none = kNotDetermined;
      return;
    }
    if (!found_.reference->settled && found_.reference->error > tolerance()) {
      found_.why_none =
          fmt::format("the reference is known to {:.2g} only: no error below that can be measured",
                      found_.reference->error);
      return;
    }
    const std::size_t best = cheapest_point(aim(), found_.points);
    if (best == found_.points.size()) {
      found_.why_none = "no setting within the budget keeps the tolerance";
      return;
    }
    const TradeoffPoint& point = found_.points[best];
    found_.recommendation = Recommendation{best, tolerance() / found_.scale.size,
                                           found_.methods[point.method].at(point.resolution)};
  }

  void leave_all_out(const char* why) {
    for (const Method& method : found_.methods) {
      const bool refused = !method.refused.empty();
      found_.gaps.push_back({refused ? TradeoffGap::Kind::refused : TradeoffGap::Kind::over_budget,
                             method.name, refused ? method.refused : why});
    }
  }

  TradeoffRequest request_;
  Variants variants_;
  Measurer measurer_;
  Tradeoff found_;
};

}  // namespace

Tradeoff measure_tradeoff(const std::shared_ptr<const Scene>& scene, const Registry& registry,
                          const TradeoffRequest& request) {
  if (has_thermostat(*scene)) {
    throw InputError(
        {Fault(FaultCode::component_unsuitable, scene->run.location, "tradeoff", "",
               "the scene has a thermostat: a result of one setting differs from that of another "
               "by chance",
               "tomlin sweep --over run.integrator.dt=... --repeats N")});
  }
  return TradeoffStudy(scene, registry, request).measure();
}

std::vector<std::string> scene_lines(const std::vector<Setting>& settings) {
  constexpr std::string_view kRun = "run.";
  constexpr std::string_view kBody = "body.";
  std::vector<std::string> run;
  std::vector<std::string> bodies;
  for (const Setting& setting : settings) {
    const std::string_view path = setting.path;
    if (path.starts_with(kRun)) {
      run.push_back(fmt::format("{} = {}", path.substr(kRun.size()), setting.value));
    } else if (path.starts_with(kBody)) {
      const std::size_t dot = path.rfind('.');
      bodies.push_back(fmt::format("{} = {}    # [[body]] {}", path.substr(dot + 1), setting.value,
                                   path.substr(kBody.size(), dot - kBody.size())));
    }
  }
  std::vector<std::string> lines = {"[run]"};
  lines.insert(lines.end(), run.begin(), run.end());
  lines.insert(lines.end(), bodies.begin(), bodies.end());
  return lines;
}

}  // namespace tomlin
