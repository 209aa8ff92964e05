#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "framework/core/bound_force.hpp"
#include "framework/core/force.hpp"
#include "framework/core/sum.hpp"
#include "tests/support/order.hpp"

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
// The flow is compared with a rk4 march of the force: global order 4.
inline constexpr Window kFourthOrder{3.7, 4.3};
// A bound that is never half reached is no estimate.
inline constexpr double kTightness = 0.5;

using Random = std::mt19937_64;

inline double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

inline std::size_t below(Random& random, std::size_t n) {
  return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
}

/// What the force is put on.
struct Arrangement {
  int dimension = 1;
  std::size_t count = 1;
  bool closed = false;  ///< a ring, or else a chain (or a point)
  bool rigid = false;
};

/// A force bound to a body of the test's own, with arrays that can be poked.
class ForceBench {
 public:
  ForceBench(const ForceRecord& record, const void* description, const Arrangement& arrangement,
             std::uint64_t seed, InstructionSet set = InstructionSet::baseline)
      : record_(record), arrangement_(arrangement) {
    Random random(seed);
    lay_out_body(random);
    Binding<double> binding;
    binding.dimension = arrangement.dimension;
    binding.set = set;
    binding.bodies = {&body_};
    force_ = record.bind(description, binding);
    force_->place_own(0);
    own_.assign(padded(force_->own_count()) + kGroup, 0.0);
    force_->start_own(own_.data());
    first_rate_ = own_.size();
    force_->place_rates(static_cast<std::ptrdiff_t>(first_rate_));
    rates_.assign(own_.size() + force_->rate_count() + kGroup, 0.0);
    for (const Pass<double>& pass : force_->passes()) {
      for (const Region& region : pass.writes) on_centre_ = on_centre_ || region.centre;
    }
    disturb(random);
  }

  BoundForce<double>& force() { return *force_; }
  const BoundBody<double>& body() const { return body_; }
  int axes() const { return arrangement_.dimension; }
  std::size_t count() const { return arrangement_.count; }
  std::size_t variables() const { return at_.size(); }
  bool on_centre() const { return on_centre_; }

  double& x(std::size_t variable) { return *at_[variable].position; }
  double& v(std::size_t variable) { return *at_[variable].velocity; }
  double f(std::size_t variable) const { return *at_[variable].force; }
  double mass(std::size_t variable) const { return at_[variable].mass; }
  int axis(std::size_t variable) const { return at_[variable].axis; }
  /// Variables are the particles' coordinates, then a rigid body's centre.
  std::size_t variable(std::size_t particle, int axis) const {
    return particle * arrangement_.dimension + axis;
  }
  std::size_t centre(int axis) const { return count() * arrangement_.dimension + axis; }

  /// New random positions and velocities.
  void disturb(Random& random) {
    for (std::size_t k = 0; k < at_.size(); ++k) {
      x(k) = at_[k].start + uniform(random, -0.2, 0.2);
      v(k) = uniform(random, -1.0, 1.0);
    }
  }

  void begin_step(double time, double elapsed) {
    force_->begin_step(DoubleDouble(time));
    elapsed_ = elapsed;
  }

  Stage<double> stage() {
    return {position_.data(),
            velocity_.data(),
            force_numbers_.data(),
            mapped_position_.data(),
            mapped_velocity_.data(),
            mapped_force_.data(),
            own_.data(),
            rates_.data(),
            elapsed_};
  }

  /// The forces at the present state, by the passes as an engine runs them.
  const std::vector<double>& evaluate(bool only_add = false, double background = 0.0) {
    std::fill(force_numbers_.begin(), force_numbers_.end(), background);
    std::fill(mapped_force_.begin(), mapped_force_.end(), background);
    bool fresh = true;
    for (const Pass<double>& pass : force_->passes()) {
      const bool set = fresh && pass.set && !only_add && pass.writes.size() == 1;
      (set ? pass.set : pass.add)(pass.arguments, stage());
      fresh = false;
    }
    forces_.resize(at_.size());
    for (std::size_t k = 0; k < at_.size(); ++k) {
      // What a pass does not write it does not act on: the other half of a rigid body.
      const bool centre = k >= count() * arrangement_.dimension;
      forces_[k] = arrangement_.rigid && centre != on_centre_ ? 0.0 : f(k);
    }
    return forces_;
  }

  /// Largest number among the padding of the body, which sums over groups would pick up.
  double padding() const {
    double largest = 0.0;
    const BodySlot<double>& slot = body_.slot;
    if (on_centre_) return 0.0;
    const double* from = (slot.mapped ? mapped_force_ : force_numbers_).data() + slot.offset;
    for (int d = 0; d < arrangement_.dimension; ++d) {
      for (std::size_t i = slot.count; i < padded(slot.count); ++i) {
        largest = std::max(largest, std::abs(from[d * slot.stride + i]));
      }
    }
    return largest;
  }

  double energy() { return force_->energy(stage()); }
  double rate(std::size_t k) const { return rates_[first_rate_ + k]; }
  const double* inverse_mass() const { return inverse_mass_.data(); }
  double* velocities() { return velocity_.data(); }

 private:
  struct Variable {
    double* position;
    double* velocity;
    double* force;
    double start;
    double mass;
    int axis;
  };

  void lay_out_body(Random& random) {
    const int axes_count = arrangement_.dimension;
    const std::size_t n = arrangement_.count;
    BodySlot<double>& slot = body_.slot;
    body_.name = "body";
    body_.closed = arrangement_.closed;
    body_.coordinates = arrangement_.rigid ? "rigid" : "particles";
    slot.count = n;
    slot.stride = padded(n) + kGroup;
    // Neither body nor centre stands first: an index that forgets the offset is seen.
    slot.offset = kGroup;
    slot.mapped = slot.rigid = arrangement_.rigid;
    slot.centre = 2 * kGroup;
    const std::size_t length = slot.offset + axes_count * slot.stride + 4 * kGroup;
    for (auto* array : {&position_, &velocity_, &force_numbers_, &mapped_position_,
                        &mapped_velocity_, &mapped_force_, &inverse_mass_}) {
      array->assign(length, 0.0);
    }

    // A line or a circle with neighbours about one apart.
    const double radius = static_cast<double>(n) / 6.0 + 0.3;
    double total = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      std::vector<double> start(axes_count, 0.0);
      if (arrangement_.closed && axes_count > 1) {
        const double angle = 6.283185307179586 * static_cast<double>(i) / static_cast<double>(n);
        start[0] = radius * std::cos(angle);
        start[1] = radius * std::sin(angle);
      } else {
        start[0] = static_cast<double>(i);
      }
      for (double& component : start) component += uniform(random, -0.1, 0.1);
      body_.start.push_back(start);
      body_.mass.push_back(uniform(random, 0.5, 2.0));
      total += body_.mass.back();
    }
    share_.assign(padded(n), 0.0);
    for (std::size_t i = 0; i < n; ++i) share_[i] = body_.mass[i] / total;
    slot.share = share_.data();
    body_.start_centre.assign(axes_count, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
      for (int d = 0; d < axes_count; ++d) body_.start_centre[d] += share_[i] * body_.start[i][d];
    }

    double* const x = (slot.mapped ? mapped_position_ : position_).data();
    double* const v = (slot.mapped ? mapped_velocity_ : velocity_).data();
    double* const f = (slot.mapped ? mapped_force_ : force_numbers_).data();
    for (std::size_t i = 0; i < n; ++i) {
      for (int d = 0; d < axes_count; ++d) {
        const std::size_t k = slot.offset + d * slot.stride + i;
        at_.push_back({x + k, v + k, f + k, body_.start[i][d], body_.mass[i], d});
        if (!slot.mapped) inverse_mass_[k] = 1.0 / body_.mass[i];
      }
    }
    if (!arrangement_.rigid) return;
    for (int d = 0; d < axes_count; ++d) {
      const std::size_t k = slot.centre + d;
      at_.push_back({position_.data() + k, velocity_.data() + k, force_numbers_.data() + k,
                     body_.start_centre[d], total, d});
    }
  }

  const ForceRecord& record_;
  Arrangement arrangement_;
  BoundBody<double> body_;
  std::unique_ptr<BoundForce<double>> force_;
  std::vector<Variable> at_;
  std::vector<double> forces_;
  AlignedVector<double> position_, velocity_, force_numbers_;
  AlignedVector<double> mapped_position_, mapped_velocity_, mapped_force_;
  AlignedVector<double> inverse_mass_, share_, own_, rates_;
  std::size_t first_rate_ = 0;
  double elapsed_ = 0.0;
  bool on_centre_ = false;
};

// ---- parameters ---------------------------------------------------------------------------------

inline double random_number(const Interval& interval, Random& random) {
  const bool from_zero = interval.low == 0.0;
  if (from_zero && !interval.low_open && below(random, 3) == 0) return 0.0;
  const double low = from_zero ? 0.3 : std::max(interval.low, -2.0);
  return uniform(random, low, std::min(interval.high, from_zero ? 3.0 : 2.0));
}

inline ParameterValue random_value(const Parameter& row, const Arrangement& arrangement,
                                   Random& random) {
  const std::size_t n = arrangement.count;
  const auto sometimes = [&] { return below(random, 2) == 0; };
  if (std::holds_alternative<double>(row.prototype)) return random_number(row.interval, random);
  if (std::holds_alternative<SpaceVector>(row.prototype)) {
    SpaceVector vector;
    if (row.optional && sometimes()) return vector;
    for (int d = 0; d < arrangement.dimension; ++d) {
      vector.components.push_back(uniform(random, -2.0, 2.0));
    }
    return vector;
  }
  if (std::holds_alternative<PairSelection>(row.prototype)) {
    PairSelection pairs;
    const std::size_t kind = below(random, 3);
    if (kind == 0 || n < 2) {
      pairs.kind = PairSelection::Kind::all;
    } else if (kind == 2) {
      pairs.kind = PairSelection::Kind::list;
      for (std::int64_t i = 0; i < static_cast<std::int64_t>(n); ++i) {
        for (std::int64_t j = i + 1; j < static_cast<std::int64_t>(n); ++j) {
          if (below(random, 3) == 0) {
            // Either way round: a pair is a pair.
            pairs.list.push_back(sometimes() ? std::array{i, j} : std::array{j, i});
          }
        }
      }
      if (pairs.list.empty()) pairs.list.push_back({0, 1});
    }
    return pairs;
  }
  if (std::holds_alternative<Attachment>(row.prototype)) {
    Attachment attachment;
    const std::size_t kind = below(random, 3);
    if (kind == 1) attachment.kind = Attachment::Kind::each_particle;
    if (kind == 2) {
      attachment.kind = Attachment::Kind::particle;
      attachment.particle = static_cast<std::int64_t>(below(random, n));
    }
    return attachment;
  }
  if (std::holds_alternative<WordOrNumbers>(row.prototype)) {
    WordOrNumbers value;
    const std::size_t kind = below(random, 3);
    if (kind == 0 && !row.choices.empty()) {
      value.word = row.choices[below(random, row.choices.size())];
      return value;
    }
    const std::size_t lengths[] = {1, n - 1, n, n * (n - 1) / 2};
    const std::size_t length = kind == 1 ? 1 : lengths[below(random, 4)];
    for (std::size_t k = 0; k < std::max<std::size_t>(length, 1); ++k) {
      value.numbers.push_back(uniform(random, 0.3, 2.0));
    }
    return value;
  }
  if (std::holds_alternative<std::string>(row.prototype) && !row.choices.empty()) {
    return row.choices[below(random, row.choices.size())];
  }
  return row.standard.value_or(row.prototype);
}

/// Random parameters within the record's rows that its own checks accept; null when no draw does.
inline std::shared_ptr<void> random_description(const ForceRecord& record,
                                                const Arrangement& arrangement, Random& random) {
  SceneOutline outline;
  outline.dimension = arrangement.dimension;
  outline.bodies.push_back(
      {"body", static_cast<std::int64_t>(arrangement.count), arrangement.closed});
  constexpr int kDraws = 200;
  for (int draw = 0; draw < kDraws; ++draw) {
    auto description = record.make_description();
    for (const Parameter& row : record.parameters) {
      row.assign(description.get(), random_value(row, arrangement, random));
    }
    if (record.complaints(description.get(), outline).empty()) return description;
  }
  return nullptr;
}

// ---- second derivatives and friction

/// The Hessian in the bench's variables.
class DenseHessian : public HessianSink {
 public:
  explicit DenseHessian(const ForceBench& bench)
      : bench_(bench), n_(bench.variables()), value_(n_ * n_, 0.0) {}

  void site(std::size_t, std::size_t particle, int a, int b, double value) override {
    at(bench_.variable(particle, a), bench_.variable(particle, b)) += value;
  }
  void pair(std::size_t, std::size_t i, std::size_t, std::size_t j, int a, int b,
            double value) override {
    at(bench_.variable(i, a), bench_.variable(i, b)) += value;
    at(bench_.variable(j, a), bench_.variable(j, b)) += value;
    at(bench_.variable(i, a), bench_.variable(j, b)) -= value;
    at(bench_.variable(j, a), bench_.variable(i, b)) -= value;
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

  const ForceBench& bench_;
  std::size_t n_;
  std::vector<double> value_;
};

class FrictionOfParticles : public FrictionSink {
 public:
  explicit FrictionOfParticles(std::size_t count) : coefficient(count, 0.0) {}
  void site(std::size_t, std::size_t particle, double value) override {
    coefficient[particle] += value;
    given = true;
  }
  std::vector<double> coefficient;
  bool given = false;
};

// ---- the checker --------------------------------------------------------------------------------

/// Holds a force against its claims on as many arrangements as it is shown; what a claim denies
/// (a force "not internal", say) must have been seen at least once.
class ClaimCheck {
 public:
  explicit ClaimCheck(const ForceRecord& record) : record_(record) {}

  /// Everything about one set of parameters on one arrangement.
  void examine(const void* description, const Arrangement& arrangement, std::uint64_t seed) {
    Random random(seed);
    ForceBench bench(record_, description, arrangement, seed);
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
    if (!arrangement.rigid) look_at_friction(bench, random);
    look_at_instruction_sets(description, arrangement, seed, time);
  }

  /// Draw parameters and examine them on points, chains and rings in 1, 2 and 3 dimensions, free
  /// and rigid.
  void examine_everywhere(std::uint64_t seed, std::size_t most = 9) {
    Random random(seed);
    for (int dimension = 1; dimension <= 3; ++dimension) {
      for (std::size_t count = 1; count <= most; ++count) {
        for (const bool closed : {false, true}) {
          for (const bool rigid : {false, true}) {
            if (closed && (dimension == 1 || count < 3)) continue;
            const Arrangement arrangement{dimension, count, closed, rigid};
            const auto description = random_description(record_, arrangement, random);
            if (!description) continue;
            ++examined_;
            examine(description.get(), arrangement, random());
          }
        }
      }
    }
  }

  int examined() const { return examined_; }

  /// The claims that do not hold, each once.
  std::vector<std::string> broken() const {
    std::set<std::string> all = broken_;
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
  void look_at_gradient(ForceBench& bench, Random& random) {
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
    if (!curvature) fault("hessian");
  }

  /// `set` and `add` do the same to their region; the padding stays zero; twice is the same.
  void look_at_passes(ForceBench& bench, Random& random) {
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
  void look_at_sums(ForceBench& bench, Random& random) {
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
      if (std::abs(total[d]) <= allowed && std::abs(torque[d]) <= allowed) continue;
      saw_net_force_ = true;
      if (record_.traits.internal) fault("internal");
    }
  }

  void look_at_velocities(ForceBench& bench, Random& random) {
    bench.disturb(random);
    const std::vector<double> before = bench.evaluate();
    const std::size_t n = bench.variables();
    double power = 0.0;
    for (std::size_t k = 0; k < n; ++k) power += bench.v(k) * before[k];
    if (record_.traits.dissipative && power > 0.0) fault("dissipative");
    for (std::size_t k = 0; k < n; ++k) bench.v(k) = uniform(random, -1.0, 1.0);
    if (bench.evaluate() == before) return;
    saw_velocity_ = true;
    if (!record_.traits.depends_on_velocity) fault("velocity");
  }

  /// Time enters by the start of the step plus what has elapsed, however the two are divided.
  void look_at_time(ForceBench& bench, Random& random, double time) {
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
  void look_at_driver(ForceBench& bench, double time) {
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
      ForceBench bench(record_, description, arrangement, seed);
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
      ForceBench bench(record_, description, arrangement, seed);
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

  void look_at_curvature(ForceBench& bench, Random& random) {
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

  /// Friction coefficients are what the force does to velocities; the flow is what becomes of them.
  void look_at_friction(ForceBench& bench, Random& random) {
    FrictionOfParticles friction(bench.count());
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
    if (!bench.force().has_flow()) return;

    const auto set_velocities = [&](const std::vector<double>& v) {
      for (std::size_t k = 0; k < n; ++k) bench.v(k) = v[k];
    };
    const auto flowed = [&](const std::vector<double>& v, double h) {
      set_velocities(v);
      bench.force().flow(bench.stage(), bench.inverse_mass(), bench.velocities(), h);
      std::vector<double> result(n);
      for (std::size_t k = 0; k < n; ++k) result[k] = bench.v(k);
      return result;
    };
    const auto differ = [&](const std::vector<double>& a, const std::vector<double>& b) {
      double most = 0.0;
      for (std::size_t k = 0; k < n; ++k) most = std::max(most, std::abs(a[k] - b[k]));
      return most;
    };
    constexpr double kTime = 1.0;
    const std::vector<double> whole = flowed(v0, kTime);
    if (flowed(v0, 0.0) != v0) fault("flow");
    if (differ(flowed(flowed(v0, 0.3 * kTime), 0.7 * kTime), whole) > kRounding) fault("flow");
    if (friction.given) {
      for (std::size_t k = 0; k < n; ++k) {
        const double rate = friction.coefficient[k / bench.axes()] / bench.mass(k);
        if (std::abs(whole[k] - v0[k] * std::exp(-rate * kTime)) > kRounding) fault("flow");
      }
    }
    // The force itself, marched by rk4: the error must fall as its order says.
    const auto acceleration = [&](const std::vector<double>& v) {
      set_velocities(v);
      std::vector<double> a = bench.evaluate();
      for (std::size_t k = 0; k < n; ++k) a[k] = (a[k] - still[k]) / bench.mass(k);
      return a;
    };
    const auto plus = [&](const std::vector<double>& a, double s, const std::vector<double>& b) {
      std::vector<double> sum(n);
      for (std::size_t k = 0; k < n; ++k) sum[k] = a[k] + s * b[k];
      return sum;
    };
    std::vector<double> step, error;
    for (const int steps : {20, 40, 80}) {
      const double h = kTime / steps;
      std::vector<double> v = v0;
      for (int s = 0; s < steps; ++s) {
        const auto k1 = acceleration(v);
        const auto k2 = acceleration(plus(v, 0.5 * h, k1));
        const auto k3 = acceleration(plus(v, 0.5 * h, k2));
        const auto k4 = acceleration(plus(v, h, k3));
        v = plus(v, h / 6.0, plus(plus(k1, 2.0, k2), 1.0, plus(k4, 2.0, k3)));
      }
      step.push_back(h);
      error.push_back(differ(v, whole));
    }
    constexpr double kAccumulated = 100.0 * kRounding;
    if (*std::max_element(error.begin(), error.end()) <= kAccumulated) return;
    const double order = fitted_order(step, error, kAccumulated);
    if (!std::isnan(order) && !kFourthOrder.holds(order)) fault("flow");
    if (std::isnan(order) && error.back() > 100.0 * kAccumulated) fault("flow");
  }

  /// The same bits on every set that this machine has.
  void look_at_instruction_sets(const void* description, const Arrangement& arrangement,
                                std::uint64_t seed, double time) {
    ForceBench plain(record_, description, arrangement, seed, InstructionSet::baseline);
    plain.begin_step(time, 0.125);
    for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512}) {
      if (!is_supported(set)) continue;
      ForceBench wide(record_, description, arrangement, seed, set);
      wide.begin_step(time, 0.125);
      for (const bool only_add : {false, true}) {
        const std::vector<double> a = plain.evaluate(only_add);
        const std::vector<double> b = wide.evaluate(only_add);
        if (std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) != 0) {
          fault("instruction sets");
        }
        for (std::size_t k = 0; k < plain.force().rate_count(); ++k) {
          if (plain.rate(k) != wide.rate(k)) fault("instruction sets");
        }
      }
    }
  }

  const ForceRecord& record_;
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
