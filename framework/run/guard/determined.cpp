#include "framework/run/guard/determined.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/core/numbers/math.hpp"
#include "framework/core/text/axis_names.hpp"
#include "framework/run/guard/side_run.hpp"
#include "framework/run/results/observables.hpp"

namespace tomlin {
namespace {

constexpr double kMostDigits = 17.0;                // of a double
constexpr const char* kPerturbKey = "run.perturb";  // of warnings
constexpr double kLog10 = 2.302585092994046;
/// Halving a force takes half of a change that is in proportion to it, and nothing of a change of
/// branch. Where it takes more than this the two runs are on different branches.
constexpr double kMostTakenByHalving = 0.75;

/// An observable that is followed, and the size that its spread is held against: a component of a
/// vector is as large as the vector.
struct Followed {
  std::string path;
  std::vector<std::string> vector;
  std::vector<double> values;
};

std::vector<Followed> mean_forces(const RunResult& result) {
  std::vector<Followed> all;
  for (const ResultGroup& driver : result.family("drivers")) {
    std::vector<std::string> components;
    for (std::size_t d = 0; d < driver["mean_force"].count(); ++d) {
      components.push_back("drivers." + driver.name + ".mean_force." + kAxisNames[d]);
    }
    for (const std::string& path : components) all.push_back({path, components, {}});
  }
  return all;
}

/// `measured`: the only observables of the run, if it has been asked for some.
std::vector<Followed> asked_for(const PerturbSettings& settings,
                                const std::vector<std::string>& measured, const RunResult& result) {
  const std::vector<std::string>& paths =
      settings.observables.empty() ? measured : settings.observables;
  if (paths.empty()) return mean_forces(result);
  const SourceLocation& location = settings.location_of("observables");
  std::vector<Followed> all;
  for (const std::string& path : paths) {
    observable(result, path, location);
    if (path.starts_with("performance.")) {
      throw InputError(
          {Fault(FaultCode::observable_unknown, location, "run.perturb.observables", path,
                 "how fast a run was is not a result of it", "an observable of the scene")});
    }
    all.push_back({path, {path}, {}});
  }
  return all;
}

/// Returns a result on the branch that a disturbed path has taken, where it has been repeated under
/// half the force: extrapolated to none at all. The force itself, which moves results in
/// proportion, is no reason to call them not determined.
std::optional<double> without_force(std::optional<double> alone, std::optional<double> under,
                                    std::optional<double> under_half) {
  if (!alone || !under || !under_half) return under;
  const double change = std::abs(*under - *alone);
  const double step = std::abs(*under - *under_half);
  return step > kMostTakenByHalving * change ? under : 2.0 * *under_half - *under;
}

double size_of(const RunResult& result, const Followed& followed) {
  double squares = 0.0;
  for (const std::string& path : followed.vector) {
    const double x = observable(result, path).value_or(0.0);
    squares += x * x;
  }
  return std::sqrt(squares);
}

DeterminedResult judged(const RunResult& result, const Followed& followed, double largest) {
  DeterminedResult found;
  found.path = followed.path;
  found.value = observable(result, followed.path);
  const auto [low, high] = std::minmax_element(followed.values.begin(), followed.values.end());
  found.min = *low;
  found.max = *high;
  found.spread = found.max - found.min;
  if (found.spread <= 0.0) {
    found.digits = kMostDigits;
  } else if (largest > 0.0) {
    found.digits = std::clamp(log(largest / found.spread) / kLog10, 0.0, kMostDigits);
  }
  return found;
}

}  // namespace

void determine(const std::shared_ptr<const Scene>& scene, const RunOptions& options,
               RunResult& result) {
  if (result.status != RunStatus::finished) return;
  const PerturbSettings& settings = *scene->run.perturb;
  std::vector<Followed> all = asked_for(settings, scene->measure.observables, result);
  std::vector<double> sizes;
  for (Followed& followed : all) {
    sizes.push_back(size_of(result, followed));
    if (const auto value = observable(result, followed.path)) followed.values.push_back(*value);
  }
  const bool quasistatic = scene->run.dynamics == Dynamics::quasistatic;
  const std::int64_t repeats = std::max(settings.repeats, std::int64_t{quasistatic ? 2 : 1});
  RunOptions quiet = options;
  const auto repeated = [&](std::int64_t repeat, double size, const char* more) {
    quiet.perturbation =
        Perturbation{settings.bodies, size, static_cast<std::uint64_t>(scene->run.seed),
                     static_cast<std::uint64_t>(repeat)};
    return side_run(scene, quiet, fmt::format("perturbed start {}{}", repeat, more));
  };
  for (std::int64_t repeat = 1; repeat <= repeats; ++repeat) {
    const RunResult other = repeated(repeat, settings.size, "");
    std::optional<RunResult> half;
    if (quasistatic && other.status == RunStatus::finished) {
      half = repeated(repeat, 0.5 * settings.size, ", half the size");
    }
    if (other.status == RunStatus::interrupted ||
        (half && half->status == RunStatus::interrupted)) {
      result.status = RunStatus::interrupted;
      result.warnings.push_back(
          {FaultCode::run_comparison_stopped,
           fmt::format("stopped after {} of {} runs from perturbed starts", repeat - 1, repeats),
           kPerturbKey});
      break;
    }
    if (other.failure) {
      result.warnings.push_back({FaultCode::run_perturb_failed,
                                 fmt::format("the run from perturbed start {} failed: {}", repeat,
                                             to_string(*other.failure)),
                                 kPerturbKey});
      continue;
    }
    for (std::size_t k = 0; k < all.size(); ++k) {
      std::optional<double> value = observable(other, all[k].path);
      double size = size_of(other, all[k]);
      if (half && !half->failure) {
        value =
            without_force(observable(result, all[k].path), value, observable(*half, all[k].path));
        size = std::abs(value.value_or(0.0));
      }
      if (value) all[k].values.push_back(*value);
      sizes[k] = std::max(sizes[k], size);
    }
  }
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (all[k].values.size() < 2) continue;
    const DeterminedResult found = judged(result, all[k], sizes[k]);
    if (found.digits < kDigitsOfADeterminedResult) {
      result.warnings.push_back({FaultCode::run_not_determined,
                                 fmt::format("{} is not determined: starts that differ by {:g} "
                                             "move it between {:.6g} and {:.6g}",
                                             found.path, settings.size, found.min, found.max),
                                 found.path});
    }
    result.determined.push_back(found);
  }
}

}  // namespace tomlin
