#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/force.hpp"
#include "tests/support/flow_check.hpp"
#include "tests/support/force_bench.hpp"
#include "tests/support/number_types.hpp"
#include "tests/support/order.hpp"
#include "tests/support/random_description.hpp"

/// The claims of a force's record, held against what the bound force does. The checker knows no
/// force by name: it draws parameters from the record's own rows, lays out bodies of its own, and
/// names the claims that do not hold.
namespace tomlin::test {

// Central differences of an energy or a force have errors that fall as h^2.
inline constexpr double kLongestDifference = 0.02;  // well below periods and bonds, which are ~1
inline constexpr int kDifferences = 4;              // halved each time
inline constexpr Window kSecondOrder{1.75, 2.25};   // h^4 terms are a few percent at most
// Rounding of a sum of a few hundred terms: some tens of units in the last place of its size.
inline constexpr double kRounding = 64.0 * std::numeric_limits<double>::epsilon();
// A shift by whole periods rounds positions; a phase of some turns keeps about 14 digits.
inline constexpr double kShiftRounding = 1e-12;
// A bound that is never half reached is no estimate.
inline constexpr double kTightness = 0.5;

// ---- second derivatives and friction

/// The Hessian in the bench's variables.
class DenseHessian : public HessianSink {
 public:
  explicit DenseHessian(const ForceBench<double>& bench)
      : bench_(bench), n_(bench.variables()), value_(n_ * n_, 0.0) {}

  void site(std::size_t body, std::size_t index, int a, int b, double value) override {
    const std::size_t particle = bench_.particle(body, index);
    at(bench_.variable(particle, a), bench_.variable(particle, b)) += value;
  }
  void pair(std::size_t body1, std::size_t index1, std::size_t body2, std::size_t index2, int a,
            int b, double value) override {
    const std::size_t i = bench_.particle(body1, index1);
    const std::size_t j = bench_.particle(body2, index2);
    at(bench_.variable(i, a), bench_.variable(i, b)) += value;
    at(bench_.variable(j, a), bench_.variable(j, b)) += value;
    at(bench_.variable(i, a), bench_.variable(j, b)) -= value;
    at(bench_.variable(j, a), bench_.variable(i, b)) -= value;
  }
  void block(std::size_t body1, std::size_t index1, int a, std::size_t body2, std::size_t index2,
             int b, double value) override {
    at(bench_.variable(bench_.particle(body1, index1), a),
       bench_.variable(bench_.particle(body2, index2), b)) += value;
  }
  void centre(std::size_t, const double* weight, int a, int b, double value) override {
    if (bench_.on_centre()) {
      at(bench_.centre(a), bench_.centre(b)) += value;
      return;
    }
    for (std::size_t i = 0; i < bench_.count(); ++i) {
      for (std::size_t j = 0; j < bench_.count(); ++j) {
        at(bench_.variable(i, a), bench_.variable(j, b)) += weight[i] * weight[j] * value;
      }
    }
  }

  double value(std::size_t i, std::size_t j) const { return value_[i * n_ + j]; }

  /// Spectral norm of one particle's block, by power iteration.
  double block_norm(std::size_t particle) const {
    const int axes = bench_.axes();
    double u[3] = {0.6, 0.5, 0.4};
    double norm = 0.0;
    constexpr int kPasses = 200;  // the two eigenvalues may be close; 200 squarings settle them
    for (int pass = 0; pass < kPasses; ++pass) {
      double w[3] = {};
      for (int a = 0; a < axes; ++a) {
        for (int b = 0; b < axes; ++b) {
          w[a] += value(bench_.variable(particle, a), bench_.variable(particle, b)) * u[b];
        }
      }
      const double size = std::hypot(w[0], w[1], w[2]);
      if (size == 0.0) return 0.0;
      norm = size / std::hypot(u[0], u[1], u[2]);
      for (int a = 0; a < 3; ++a) u[a] = w[a] / size;
    }
    return norm;
  }

 private:
  double& at(std::size_t i, std::size_t j) { return value_[i * n_ + j]; }

  const ForceBench<double>& bench_;
  std::size_t n_;
  std::vector<double> value_;
};

class FrictionOfParticles : public FrictionSink {
 public:
  template <class Real>
  explicit FrictionOfParticles(const ForceBench<Real>& bench)
      : coefficient(bench.count(), 0.0), first_of_second_(bench.particle(1, 0)) {}
  void site(std::size_t body, std::size_t particle, double value) override {
    coefficient[(body == 0 ? 0 : first_of_second_) + particle] += value;
    given = true;
  }
  std::vector<double> coefficient;
  bool given = false;

 private:
  std::size_t first_of_second_;
};

// ---- the checker --------------------------------------------------------------------------------

/// Holds a force against its claims on as many arrangements as it is shown; what a claim denies
/// (a force "not internal", say) must have been seen at least once.
class ClaimCheck {
 public:
  explicit ClaimCheck(const ForceRecord& record) : record_(record), number_types_(record) {}

  /// Everything about one set of parameters on one arrangement.
  void examine(const void* description, const Arrangement& arrangement, std::uint64_t seed) {
    Random random(seed);
    ForceBench<double> bench(record_, description, arrangement, seed);
    const double time = uniform(random, 0.5, 3.0);
    bench.begin_step(time, 0.125);
    look_at_gradient(bench, random);
    look_at_passes(bench, random);
    look_at_sums(bench, random);
    look_at_velocities(bench, random);
    look_at_time(bench, random, time);
    look_at_driver(bench, time);
    look_at_period(description, arrangement, seed);
    look_at_origin(description, arrangement, seed, time);
    look_at_curvature(bench, random);
    if (!arrangement.mapped()) look_at_friction(bench, random);
    if (!arrangement.mapped()) look_at_flow(bench, random);
    if (record_.traits.conservative && record_.traits.depends_on_time &&
        !record_.traits.does_work) {
      look_at_changing_energy(bench, random, time);
    } else {
      look_at_heat(bench, random);
    }
    look_at_instruction_sets<double>(description, arrangement, seed, time);
    look_at_instruction_sets<float>(description, arrangement, seed, time);
    number_types_.examine(description, arrangement, seed, time);
  }

  /// Draw parameters and examine them on points, chains and rings in 1, 2 and 3 dimensions, free,
  /// rigid and prescribed, in a box, and between two bodies where the force takes two.
  void examine_everywhere(std::uint64_t seed, std::size_t most = 9) {
    Random random(seed);
    for (std::size_t count = 1; count <= most; ++count) {
      for (const Arrangement& arrangement : arrangements_of(record_, count)) {
        const auto description = random_description(record_, arrangement, random);
        if (!description) continue;
        ++examined_;
        examine(description.get(), arrangement, random());
      }
    }
  }

  int examined() const { return examined_; }

  /// The claims that do not hold, each once.
  std::vector<std::string> broken() const {
    std::set<std::string> all = broken_;
    for (const std::string& claim : number_types_.broken()) all.insert(claim);
    const Traits& traits = record_.traits;
    if (!traits.conservative && !saw_no_gradient_) all.insert("conservative is not claimed");
    if (!traits.internal && !saw_net_force_) all.insert("internal is not claimed");
    if (traits.depends_on_velocity && !saw_velocity_) all.insert("velocity");
    if (traits.depends_on_time && !saw_time_) all.insert("time");
    if (saw_bound_ && !(tightest_ > kTightness)) all.insert("curvature bound is far too large");
    return {all.begin(), all.end()};
  }

 private:
  void fault(const char* claim) { broken_.insert(claim); }

  static double largest(const std::vector<double>& numbers) {
    double size = 0.0;
    for (const double x : numbers) size = std::max(size, std::abs(x));
    return size;
  }

  /// Root mean square of what `error_at` says at random points, for halved differences; fine when
  /// it falls as h^2, or when there is nothing but rounding.
  template <class ErrorAt>
  static bool falls_as_square(ErrorAt&& error_at) {
    std::vector<double> step, error;
    double floor = 0.0;
    bool only_rounding = true;
    for (int k = 0; k < kDifferences; ++k) {
      const double h = kLongestDifference / static_cast<double>(1 << k);
      double rounding = 0.0;
      const double e = error_at(h, rounding);
      if (!std::isfinite(e)) return false;
      only_rounding = only_rounding && e <= rounding;
      floor = std::max(floor, 30.0 * rounding);
      step.push_back(h);
      error.push_back(e);
    }
    if (only_rounding) return true;
    const double order = fitted_order(step, error, floor);
    // Too small an error to fit: then it must at least be close to rounding throughout.
    if (std::isnan(order)) return error.front() <= 10.0 * floor;
    return kSecondOrder.holds(order);
  }

  /// Force = -gradient of the energy; Hessian = -gradient of the force.
  void look_at_gradient(ForceBench<double>& bench, Random& random) {
    constexpr int kPoints = 6;
    const std::size_t n = bench.variables();
    struct Point {
      std::vector<double> x, direction, force, hessian;
    };
    std::vector<Point> points(kPoints);
    for (Point& point : points) {
      bench.disturb(random);
      for (std::size_t k = 0; k < n; ++k) {
        point.x.push_back(bench.x(k));
        point.direction.push_back(uniform(random, -1.0, 1.0));
      }
      point.force = bench.evaluate();
      DenseHessian hessian(bench);
      bench.force().hessian(bench.stage(), hessian);
      for (std::size_t i = 0; i < n; ++i) {
        double along = 0.0;
        for (std::size_t j = 0; j < n; ++j) along += hessian.value(i, j) * point.direction[j];
        point.hessian.push_back(along);
      }
      if (!std::isfinite(largest(point.force))) fault("finite");
    }
    const auto move_to = [&](const Point& point, double h) {
      for (std::size_t k = 0; k < n; ++k) bench.x(k) = point.x[k] + h * point.direction[k];
    };

    bool has_energy = false;
    const bool gradient = falls_as_square([&](double h, double& rounding) {
      double squares = 0.0;
      for (const Point& point : points) {
        move_to(point, h);
        const double above = bench.energy();
        move_to(point, -h);
        const double under = bench.energy();
        has_energy = has_energy || above != 0.0;
        double work = 0.0;
        for (std::size_t k = 0; k < n; ++k) work += point.force[k] * point.direction[k];
        const double error = (above - under) / (2.0 * h) + work;
        squares += error * error;
        const double size = std::abs(above) + static_cast<double>(bench.count());
        rounding = std::max(rounding, kRounding * (size / h + std::abs(work)));
      }
      return std::sqrt(squares / kPoints);
    });
    if (!gradient) saw_no_gradient_ = true;
    if (record_.traits.conservative && !gradient) fault("gradient");
    if (record_.traits.conservative && !has_energy) {
      for (const Point& point : points) {
        if (largest(point.force) > 0.0) fault("gradient");
      }
    }

    const bool curvature = falls_as_square([&](double h, double& rounding) {
      double squares = 0.0;
      for (const Point& point : points) {
        move_to(point, h);
        const std::vector<double> above = bench.evaluate();
        move_to(point, -h);
        const std::vector<double> under = bench.evaluate();
        for (std::size_t k = 0; k < n; ++k) {
          const double error = (above[k] - under[k]) / (2.0 * h) + point.hessian[k];
          squares += error * error;
        }
        rounding = std::max(rounding, kRounding * (largest(above) + 1.0) / h);
      }
      return std::sqrt(squares / kPoints);
    });
    // A force that is no gradient and depends on place gives none.
    const bool gives_none = std::all_of(points.begin(), points.end(), [](const Point& point) {
      return largest(point.hessian) == 0.0;
    });
    if (!curvature && (record_.traits.conservative || !gives_none)) fault("hessian");
  }

  /// `set` and `add` do the same to their region; the padding stays zero; twice is the same.
  void look_at_passes(ForceBench<double>& bench, Random& random) {
    bench.disturb(random);
    const std::vector<double> set = bench.evaluate();
    if (bench.padding() != 0.0) fault("padding");
    const std::vector<double> again = bench.evaluate();
    if (set != again && !record_.traits.stochastic) fault("repeatable");
    if (record_.traits.stochastic) return;
    constexpr double kBackground = 8.0;
    const std::vector<double> added = bench.evaluate(true, kBackground);
    const std::vector<double> afresh = bench.evaluate(true, 0.0);
    // A pass that sets clears whatever was there before.
    const auto passes = bench.force().passes();
    const bool sets = !passes.empty() && passes.front().set != nullptr;
    const std::vector<double> over = sets ? bench.evaluate(false, kBackground) : set;
    for (std::size_t k = 0; k < set.size(); ++k) {
      const bool acts = set[k] != 0.0;
      const double sum = kBackground + set[k];
      if (afresh[k] != set[k] || over[k] != set[k]) fault("set and add");
      if (acts && std::abs(added[k] - sum) > kRounding * (std::abs(sum) + kBackground)) {
        fault("set and add");
      }
    }
  }

  /// Internal forces and their torques sum to zero.
  void look_at_sums(ForceBench<double>& bench, Random& random) {
    bench.disturb(random);
    const std::vector<double> force = bench.evaluate();
    double total[3] = {};
    double torque[3] = {};
    double reach = 1.0;
    const std::size_t particles = bench.count();
    for (std::size_t i = 0; i < particles; ++i) {
      double x[3] = {}, f[3] = {};
      for (int d = 0; d < bench.axes(); ++d) {
        x[d] = bench.x(bench.variable(i, d));
        f[d] = force[bench.variable(i, d)];
        reach = std::max(reach, std::abs(x[d]));
        total[d] += f[d];
      }
      for (int a = 0; a < 3; ++a) {
        torque[a] += x[(a + 1) % 3] * f[(a + 2) % 3] - x[(a + 2) % 3] * f[(a + 1) % 3];
      }
    }
    for (std::size_t k = particles * bench.axes(); k < force.size(); ++k) {
      total[bench.axis(k)] += force[k];
    }
    const double allowed =
        kRounding * reach * (largest(force) + 1.0) * static_cast<double>(particles);
    for (int d = 0; d < 3; ++d) {
      // Through a box the far end of a lever is an image.
      const bool levers = !bench.arrangement().boxed;
      if (std::abs(total[d]) <= allowed && !(levers && std::abs(torque[d]) > allowed)) continue;
      saw_net_force_ = true;
      if (record_.traits.internal) fault("internal");
    }
  }

  void look_at_velocities(ForceBench<double>& bench, Random& random) {
    bench.disturb(random);
    const std::vector<double> before = bench.evaluate();
    const std::size_t n = bench.variables();
    double power = 0.0;
    for (std::size_t k = 0; k < n; ++k) power += bench.v(k) * before[k];
    if (record_.traits.dissipative && power > 0.0) fault("dissipative");
    const std::vector<double> rates = bench.own_rates();
    for (std::size_t k = 0; k < n; ++k) bench.v(k) = uniform(random, -1.0, 1.0);
    if (bench.evaluate() == before && bench.own_rates() == rates) return;
    saw_velocity_ = true;
    if (!record_.traits.depends_on_velocity) fault("velocity");
  }

  /// Time enters by the start of the step plus what has elapsed, however the two are divided.
  void look_at_time(ForceBench<double>& bench, Random& random, double time) {
    if (bench.force().depends_on_time() != record_.traits.depends_on_time) fault("time");
    bench.disturb(random);
    const std::vector<double> before = bench.evaluate();
    bench.begin_step(time + 1.0, 0.125);
    if (bench.evaluate() != before) {
      saw_time_ = true;
      if (!record_.traits.depends_on_time) fault("time");
    }
    bench.begin_step(time + 0.125, 0.0);
    const std::vector<double> shifted = bench.evaluate();
    for (std::size_t k = 0; k < before.size(); ++k) {
      if (std::abs(shifted[k] - before[k]) > kRounding * (largest(before) + 10.0)) fault("elapsed");
    }
    bench.begin_step(time, 0.125);
  }

  /// A driver reports the force that it exerts, and the power that its moving end puts in.
  void look_at_driver(ForceBench<double>& bench, double time) {
    const Drive* drive = bench.force().drive();
    const auto axes = static_cast<std::size_t>(bench.axes());
    if (record_.traits.does_work != (drive != nullptr)) fault("driver");
    if (bench.force().rate_count() != (record_.traits.does_work ? axes + 1 : 0)) fault("driver");
    if (!drive || bench.force().rate_count() != axes + 1) return;
    const std::vector<double> force = bench.evaluate();
    std::vector<double> total(axes, 0.0);
    double size = 1.0;
    for (std::size_t k = 0; k < force.size(); ++k) {
      total[bench.axis(k)] += force[k];
      size += std::abs(force[k]);
    }
    double power = 0.0;
    double speed = 1.0;
    for (std::size_t d = 0; d < axes; ++d) {
      if (std::abs(bench.rate(d) - total[d]) > kRounding * size) fault("driver");
      power += drive->velocity[d] * total[d];
      speed += std::abs(drive->velocity[d]);
    }
    const double reported = bench.rate(axes);
    if (std::abs(reported - power) > kRounding * size * speed) fault("driver");
    // With the particles held, all of that power goes into the stored energy. Springs are quadratic
    // in time, so that the central difference is exact but for rounding.
    constexpr double kHalf = 0.0625;
    bench.begin_step(time, 0.125 + kHalf);
    const double above = bench.energy();
    bench.begin_step(time, 0.125 - kHalf);
    const double under = bench.energy();
    bench.begin_step(time, 0.125);
    const double gained = (above - under) / (2.0 * kHalf);
    if (std::abs(gained - reported) > kRounding * (above / kHalf + size * speed)) fault("driver");
  }

  /// A shift of everything by the declared period changes nothing: made in the positions, and in
  /// the cells of the origin.
  void look_at_period(const void* description, const Arrangement& arrangement, std::uint64_t seed) {
    bool declared = false;
    for (int axis = 0; axis < arrangement.dimension; ++axis) {
      const double period = record_.period(description, axis);
      if (period < 0.0) fault("periodic");
      if (!(period > 0.0)) continue;
      declared = true;
      ForceBench<double> bench(record_, description, arrangement, seed);
      const std::vector<double> before = bench.evaluate();
      const double energy = bench.energy();
      for (const std::int64_t cells :
           {std::int64_t{3}, std::int64_t{-7}, std::int64_t{2000000011}}) {
        Origin origin;
        origin.unit[axis] = period;
        origin.cells[axis] = cells;
        bench.force().rebase(origin);
        if (bench.evaluate() != before || bench.energy() != energy) fault("periodic");
        bench.force().rebase(Origin{});
      }
      for (std::size_t k = 0; k < bench.variables(); ++k) {
        if (bench.axis(k) == axis) bench.x(k) += period;
      }
      const std::vector<double> after = bench.evaluate();
      for (std::size_t k = 0; k < after.size(); ++k) {
        if (!close_by_shift(after[k], before[k], largest(before))) fault("periodic");
      }
      if (!close_by_shift(bench.energy(), energy, std::abs(energy) + 1.0)) fault("periodic");
    }
    if (declared != record_.traits.periodic) fault("periodic");
  }

  static bool close_by_shift(double a, double b, double size) {
    return std::abs(a - b) <= kShiftRounding * (1.0 + size);
  }

  /// An origin that moves by whole cells of any length, positions with it, changes no force.
  void look_at_origin(const void* description, const Arrangement& arrangement, std::uint64_t seed,
                      double time) {
    for (int axis = 0; axis < arrangement.dimension; ++axis) {
      ForceBench<double> bench(record_, description, arrangement, seed);
      bench.begin_step(time, 0.125);
      const std::vector<double> before = bench.evaluate();
      Origin origin;
      origin.unit[axis] = 1.7;
      origin.cells[axis] = 5;
      bench.force().rebase(origin);
      bench.begin_step(time, 0.125);
      for (std::size_t k = 0; k < bench.variables(); ++k) {
        if (bench.axis(k) == axis) bench.x(k) -= 5 * 1.7;
      }
      const std::vector<double> after = bench.evaluate();
      for (std::size_t k = 0; k < after.size(); ++k) {
        if (!close_by_shift(after[k], before[k], 10.0 * largest(before))) fault("origin");
      }
    }
  }

  void look_at_curvature(ForceBench<double>& bench, Random& random) {
    const double bound = bench.force().curvature_bound();
    if (bound < 0.0) return;
    saw_bound_ = true;
    constexpr int kPoints = 40;
    for (int point = 0; point < kPoints; ++point) {
      bench.disturb(random);
      DenseHessian hessian(bench);
      bench.force().hessian(bench.stage(), hessian);
      for (std::size_t i = 0; i < bench.count(); ++i) {
        const double norm = hessian.block_norm(i);
        if (norm > bound * (1.0 + kRounding)) fault("curvature bound");
        for (int a = 0; a < bench.axes(); ++a) {
          const std::size_t k = bench.variable(i, a);
          const double along = bench.force().curvature_bound_along(a);
          if (std::abs(hessian.value(k, k)) > along * (1.0 + kRounding)) fault("curvature bound");
        }
        if (bound > 0.0) tightest_ = std::max(tightest_, norm / bound);
      }
    }
  }

  /// Friction coefficients are what the force does to velocities.
  void look_at_friction(ForceBench<double>& bench, Random& random) {
    FrictionOfParticles friction(bench);
    bench.force().friction(friction);
    const std::size_t n = bench.variables();
    bench.disturb(random);
    std::vector<double> v0(n);
    for (std::size_t k = 0; k < n; ++k) v0[k] = bench.v(k);
    const std::vector<double> moving = bench.evaluate();
    for (std::size_t k = 0; k < n; ++k) bench.v(k) = 0.0;
    const std::vector<double> still = bench.evaluate();
    if (friction.given) {
      for (std::size_t k = 0; k < n; ++k) {
        const double coefficient = friction.coefficient[k / bench.axes()];
        if (coefficient < 0.0) fault("friction");
        const double drag = moving[k] - still[k];
        if (std::abs(drag + coefficient * v0[k]) > kRounding * (1.0 + largest(moving))) {
          fault("friction");
        }
      }
    }
  }

  /// An operator of its own, held against what it stands for: the force, and its own variables.
  void look_at_flow(ForceBench<double>& bench, Random& random) {
    Flow<double> flow;
    if (!bench.force().flow(flow)) return;
    bench.disturb(random);
    if (bench.variables() > 1) bench.hold(below(random, bench.variables()));
    const auto slopes = [&] {
      bench.evaluate();
      const Stage<double> stage = bench.stage();
      const FlowStage<double> at = bench.flow_stage();
      std::vector<double> all(bench.dofs());
      for (std::size_t i = 0; i < all.size(); ++i) all[i] = stage.force[i] * at.inverse_mass[i];
      for (const double rate : bench.own_rates()) all.push_back(rate);
      return all;
    };
    FlowCheck check(flow, bench.flow_stage(), bench.dofs(), bench.own_count(), slopes,
                    [&] { return bench.energy(); });
    for (const std::string& claim : check.broken(record_.traits.stochastic)) broken_.insert(claim);
  }

  /// What the ledger counts as lost is the power that the force takes out, -F.v, less what goes
  /// into its own variables; of linear friction c v^2. Forces that do not depend on velocities
  /// store energy, and lose none.
  /// An energy that changes with time at rest does work: heat is what that takes out.
  void look_at_changing_energy(ForceBench<double>& bench, Random& random, double time) {
    constexpr double kElapsed = 0.125;
    constexpr double kTimeDifference = 1e-4;  // its square, of the third derivative in time
    constexpr double kAllowed = 1e-6;
    bench.disturb(random);
    bench.begin_step(time, kElapsed);
    const std::optional<double> heat = bench.heat();
    if (!heat.has_value()) return;  // no particle, pair or angle that it acts on
    bench.begin_step(time, kElapsed + kTimeDifference);
    const double after = bench.energy();
    bench.begin_step(time, kElapsed - kTimeDifference);
    const double before = bench.energy();
    const double due = -(after - before) / (2.0 * kTimeDifference);
    if (std::abs(*heat - due) > kAllowed * (1.0 + std::abs(after) + std::abs(due))) fault("heat");
  }

  void look_at_heat(ForceBench<double>& bench, Random& random) {
    bench.disturb(random);
    const std::optional<double> heat = bench.heat();
    if (heat.has_value() != record_.traits.depends_on_velocity) fault("heat");
    if (!heat) return;
    const std::vector<double> force = bench.evaluate();
    FrictionOfParticles friction(bench);
    bench.force().friction(friction);
    double taken = -bench.stored_by_own();
    double by_friction = 0.0;
    double size = std::abs(taken);
    for (std::size_t k = 0; k < force.size(); ++k) {
      const double v = bench.v(k);
      taken -= force[k] * v;
      size += std::abs(force[k] * v);
      const std::size_t particle = k / bench.axes();
      if (particle < bench.count()) by_friction += friction.coefficient[particle] * v * v;
    }
    const double allowed = kRounding * size;
    if (std::abs(*heat - taken) > allowed) fault("heat");
    if (friction.given && std::abs(*heat - by_friction) > allowed) fault("heat");
    if (record_.traits.dissipative && *heat < 0.0) fault("heat");
  }

  /// The same bits on every set that this machine has: of forces, rates and heat.
  template <class Real>
  void look_at_instruction_sets(const void* description, const Arrangement& arrangement,
                                std::uint64_t seed, double time) {
    if (!record_.bind.in<Real>()) return;
    ForceBench<Real> plain(record_, description, arrangement, seed, InstructionSet::baseline);
    plain.begin_step(time, 0.125);
    for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512}) {
      if (!is_supported(set)) continue;
      ForceBench<Real> wide(record_, description, arrangement, seed, set);
      wide.begin_step(time, 0.125);
      for (const bool only_add : {false, true}) {
        const std::vector<Real> a = plain.evaluate(only_add);
        const std::vector<Real> b = wide.evaluate(only_add);
        if (std::memcmp(a.data(), b.data(), a.size() * sizeof(Real)) != 0) {
          fault("instruction sets");
        }
        for (std::size_t k = 0; k < plain.force().rate_count(); ++k) {
          if (plain.rate(k) != wide.rate(k)) fault("instruction sets");
        }
      }
      if (plain.heat() != wide.heat()) fault("instruction sets");
    }
  }

  const ForceRecord& record_;
  NumberTypeCheck number_types_;
  std::set<std::string> broken_;
  int examined_ = 0;
  bool saw_no_gradient_ = false;
  bool saw_net_force_ = false;
  bool saw_velocity_ = false;
  bool saw_time_ = false;
  bool saw_bound_ = false;
  double tightest_ = 0.0;
};

}  // namespace tomlin::test
