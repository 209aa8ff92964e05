#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/scene/scene.hpp"
#include "framework/standard_registry.hpp"
#include "framework/study/tradeoff/measurer.hpp"
#include "framework/study/tradeoff/tradeoff.hpp"

/// How good are the recommendations of `tomlin tradeoff`? Each is held against the cheapest of an
/// exhaustive grid: every method of the ladder in double (other numbers count the same), eight
/// steps or tolerances to a factor of two or ten, as long as they may turn out cheaper. Its error
/// is taken from a run of this program's own. Takes many minutes.
///
///   tomlin_tradeoff_grid FOLDER_OF_SCENARIOS [NAME...]
///
/// Exit status 1 when a recommendation misses the tolerance or costs more than 1.5 times the best.
namespace tomlin {
namespace {

constexpr double kTolerance = 1e-4;
constexpr double kMostTimesTheBest = 1.5;
constexpr double kBudget = 120.0;  // seconds, of a recommendation
constexpr double kLongest = 1e9;   // seconds, of the grid
constexpr double kLongestRun = 30.0;
constexpr int kPerFactor = 8;
constexpr double kFinest = 1e-10;
constexpr double kTruthTolerance = 1e-13;

struct Case {
  std::string name;
  std::string file;
  std::string observable;
  std::vector<Setting> settings;
};

std::vector<Case> all_cases() {
  constexpr const char* kForce = "driver.mean_force.x";
  constexpr const char* kChain = "chain.mean_velocity.x";
  std::vector<Case> cases;
  for (const char* lambda : {"0.001", "0.01", "0.1", "1", "10", "100"}) {
    cases.push_back({std::string("ring_") + lambda,
                     "rolling_ring/table_1_rigid.toml",
                     kForce,
                     {{"lambda", lambda}}});
  }
  cases.push_back({"pt_smooth", "prandtl_tomlinson/smooth.toml", kForce, {}});
  cases.push_back({"pt_stick_slip", "prandtl_tomlinson/stick_slip.toml", kForce, {}});
  cases.push_back({"pt_multiple_slip", "prandtl_tomlinson/multiple_slip.toml", kForce, {}});
  cases.push_back(
      {"pt_overdamped", "prandtl_tomlinson/overdamped.toml", "tip.mean_velocity.x", {}});
  cases.push_back({"fk_driven", "frenkel_kontorova/driven.toml", kForce, {}});
  cases.push_back({"fk_commensurate", "frenkel_kontorova/commensurate.toml", kChain, {}});
  return cases;
}

/// The cheapest that a grid finds.
struct Best {
  std::string what;
  std::uint64_t cost = std::numeric_limits<std::uint64_t>::max();
  int runs = 0;
};

class Grid {
 public:
  /// The recommended point is the first best.
  Grid(const Variants& variants, const Tradeoff& tradeoff, double truth, double tolerance)
      : tradeoff_(tradeoff),
        measurer_(variants, tradeoff.observable, kLongest, nullptr),
        duration_(variants.scene().run.duration),
        truth_(truth),
        tolerance_(tolerance) {
    const TradeoffPoint& chosen = tradeoff.points[tradeoff.recommendation->point];
    best_.cost = chosen.cost();
    best_.what = "the same";
  }

  Best best() {
    for (const Method& method : tradeoff_.methods) {
      if (!method.refused.empty() || method.number_type != NumberType::double_precision) continue;
      if (method.resolution == Resolution::step) {
        take_steps(method);
      } else {
        take_tolerances(method);
      }
    }
    return best_;
  }

 private:
  void take_steps(const Method& method) {
    double dt = std::min(method.stable_step, 0.1 * duration_);
    while (take(method, dt) <= best_.cost) dt /= std::exp2(1.0 / kPerFactor);
  }

  /// The cost of coarse tolerances goes up and down; after three decades above the best there is
  /// nothing to find.
  void take_tolerances(const Method& method) {
    int above = 0;
    for (double t = 1.0; t > kFinest && above < 3 * kPerFactor;
         t /= std::pow(10.0, 1.0 / kPerFactor)) {
      above = take(method, t) > best_.cost ? above + 1 : 0;
    }
  }

  std::uint64_t take(const Method& method, double resolution) {
    const Measurement& found = measurer_.at(method, resolution, kLongestRun);
    ++best_.runs;
    if (found.defined() && std::abs(*found.value - truth_) <= tolerance_ &&
        found.cost() < best_.cost) {
      best_.cost = found.cost();
      best_.what =
          fmt::format("{} {} = {:.3g}", method.name, to_string(method.resolution), resolution);
    }
    return found.cost();
  }

  const Tradeoff& tradeoff_;
  Measurer measurer_;
  double duration_;
  double truth_;
  double tolerance_;
  Best best_;
};

bool is_good(const Case& one, const std::string& folder) {
  const Registry registry = standard_registry();
  const auto scene = read_scene(folder + "/" + one.file, registry, one.settings);
  const Tradeoff tradeoff = measure_tradeoff(
      scene, registry, {.observable = one.observable, .tolerance = kTolerance, .budget = kBudget});
  if (!tradeoff.recommendation) {
    fmt::print("{:<17} no recommendation: {}\n", one.name, tradeoff.why_none);
    return false;
  }
  const Variants variants(scene, registry);
  Measurer measurer(variants, tradeoff.observable, kLongest, nullptr);
  const double truth =
      measurer
          .with({{"run.integrator", fmt::format("{{ type = \"dopri5\", absolute_tolerance = {0}, "
                                                "relative_tolerance = {0} }}",
                                                kTruthTolerance)}},
                kLongest)
          .value.value();
  const double tolerance = kTolerance * std::abs(truth);
  const TradeoffPoint& chosen = tradeoff.points[tradeoff.recommendation->point];
  const double error = std::abs(chosen.value - truth);
  const Best best = Grid(variants, tradeoff, truth, tolerance).best();
  const double ratio = static_cast<double>(chosen.cost()) / static_cast<double>(best.cost);
  const bool good = error <= tolerance && ratio <= kMostTimesTheBest;
  fmt::print("{:<17} {:>8} {:.1e} {:<44} {:>8} {:<44} {:>5} {:.2f} {}\n", one.name, chosen.cost(),
             error / std::abs(truth),
             fmt::format("{} {:.3g}", tradeoff.methods[chosen.method].name, chosen.resolution),
             best.cost, best.what, best.runs, ratio, good ? "" : "NOT GOOD");
  std::fflush(stdout);
  return good;
}

int check_all(const std::string& folder, const std::vector<std::string>& names) {
  fmt::print("{:<17} {:>8} {:<7} {:<44} {:>8} {:<44} {:>5} {}\n", "scene", "cost", "error",
             "recommended", "best", "of the grid", "runs", "ratio");
  bool all_good = true;
  for (const Case& one : all_cases()) {
    if (!names.empty() && std::find(names.begin(), names.end(), one.name) == names.end()) continue;
    all_good = is_good(one, folder) && all_good;
  }
  return all_good ? 0 : 1;
}

}  // namespace
}  // namespace tomlin

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fputs("usage: tomlin_tradeoff_grid FOLDER_OF_SCENARIOS [NAME...]\n", stderr);
    return 2;
  }
  try {
    return tomlin::check_all(argv[1], {argv + 2, argv + argc});
  } catch (const std::exception& error) {
    std::fputs((std::string(error.what()) + "\n").c_str(), stderr);
    return 2;
  }
}
