#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "framework/core/numbers/number_types.hpp"
#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/force.hpp"

/// A force bound to bodies of the test's own, in any number type, with arrays that can be poked.
namespace tomlin::test {

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
  bool prescribed = false;  ///< particles in the mapped arrays, no centre among the coordinates
  bool boxed = false;       ///< a periodic box along x joins the ends of the chain
  std::size_t second = 0;   ///< particles of a second body; 0: there is none

  bool mapped() const { return rigid || prescribed; }
  std::size_t particles() const { return count + second; }
  /// Neighbours stand about one apart, those through the box's side too.
  /// Odd: no two particles are half a box apart, where the nearest image changes.
  double box_length() const {
    return boxed ? static_cast<double>(count + (count % 2 == 0 ? 1 : 0)) : 0.0;
  }
};

/// Arrangements with this many particles: points, chains and rings in 1, 2 and 3 dimensions, free,
/// rigid and prescribed, closed by a box, and beside a second body where the force takes two.
inline std::vector<Arrangement> arrangements_of(const ForceRecord& record, std::size_t count) {
  std::vector<Arrangement> all;
  for (int dimension = 1; dimension <= 3; ++dimension) {
    for (const bool closed : {false, true}) {
      if (closed && (dimension == 1 || count < 3)) continue;
      if (record.fewest_bodies == 1) {
        all.push_back({.dimension = dimension, .count = count, .closed = closed});
        all.push_back({.dimension = dimension, .count = count, .closed = closed, .rigid = true});
      }
      if (record.most_bodies > 1) {
        // Of another length, and once the longer of the two.
        const std::size_t second = closed ? count + 2 : (count + 1) / 2;
        all.push_back({.dimension = dimension, .count = count, .closed = closed, .second = second});
      }
    }
    if (record.fewest_bodies > 1) continue;
    all.push_back({.dimension = dimension, .count = count, .prescribed = true});
    if (count > 1) all.push_back({.dimension = dimension, .count = count, .boxed = true});
  }
  return all;
}

/// Small changes of everything that binding is told, to see how much the force makes of them.
struct Shake {
  double size = 0.0;  ///< relative, of each number
  std::uint64_t seed = 0;
};

template <class Real>
class ForceBench {
 public:
  ForceBench(const ForceRecord& record, const void* description, const Arrangement& arrangement,
             std::uint64_t seed, InstructionSet set = InstructionSet::baseline,
             const Shake& shake = {})
      : arrangement_(arrangement) {
    Random random(seed);
    lay_out_bodies(random, shake);
    Binding<Real> binding;
    binding.dimension = arrangement.dimension;
    binding.set = set;
    binding.box[0] = arrangement.box_length();
    // Every axis may move, as if another force declared a period there.
    binding.origin.unit = {1.0, 1.0, 1.0};
    for (const BoundBody<Real>& body : bodies_) binding.bodies.push_back(&body);
    force_ = record.bind.in<Real>()(description, binding);
    force_->place_own(0);
    own_.assign(padded(force_->own_count()) + kGroup, Real(0.0));
    force_->start_own(own_.data());
    first_rate_ = own_.size();
    heat_rate_ = first_rate_ + force_->rate_count();
    force_->place_rates(static_cast<std::ptrdiff_t>(first_rate_));
    rates_.assign(heat_rate_ + 1 + kGroup, Real(0.0));
    has_heat_ = force_->heat(static_cast<std::ptrdiff_t>(heat_rate_), heat_);
    for (const Pass<Real>& pass : force_->passes()) {
      for (const Region& region : pass.writes) on_centre_ = on_centre_ || region.centre;
    }
    disturb(random);
  }
  ForceBench(const ForceBench&) = delete;
  ForceBench& operator=(const ForceBench&) = delete;

  BoundForce<Real>& force() { return *force_; }
  const Arrangement& arrangement() const { return arrangement_; }
  int axes() const { return arrangement_.dimension; }
  /// Particles of all bodies, those of the second after those of the first.
  std::size_t count() const { return arrangement_.particles(); }
  std::size_t particle(std::size_t body, std::size_t index) const {
    return body == 0 ? index : arrangement_.count + index;
  }
  std::size_t variables() const { return at_.size(); }
  bool on_centre() const { return on_centre_; }

  Real& x(std::size_t variable) { return *at_[variable].position; }
  Real& v(std::size_t variable) { return *at_[variable].velocity; }
  Real f(std::size_t variable) const { return *at_[variable].force; }
  double mass(std::size_t variable) const { return at_[variable].mass; }
  int axis(std::size_t variable) const { return at_[variable].axis; }
  /// Variables are the particles' coordinates, then the centres of rigid bodies.
  std::size_t variable(std::size_t particle, int axis) const {
    return particle * arrangement_.dimension + axis;
  }
  std::size_t centre(int axis) const { return count() * arrangement_.dimension + axis; }

  /// New random positions and velocities.
  void disturb(Random& random) {
    for (std::size_t k = 0; k < at_.size(); ++k) {
      x(k) = Real(at_[k].start + uniform(random, -0.2, 0.2));
      v(k) = Real(uniform(random, -1.0, 1.0));
    }
    for (std::size_t k = 0; k < own_count(); ++k) own(k) = Real(uniform(random, -0.3, 0.3));
  }

  void begin_step(double time, double elapsed) {
    force_->begin_step(DoubleDouble(time));
    elapsed_ = elapsed;
  }

  Stage<Real> stage() {
    return {position_.data(),
            velocity_.data(),
            force_numbers_.data(),
            mapped_position_.data(),
            mapped_velocity_.data(),
            mapped_force_.data(),
            own_.data(),
            rates_.data(),
            Real(elapsed_)};
  }

  /// The forces at the present state, by the passes as an engine runs them.
  const std::vector<Real>& evaluate(bool only_add = false, double background = 0.0) {
    std::fill(force_numbers_.begin(), force_numbers_.end(), Real(background));
    std::fill(mapped_force_.begin(), mapped_force_.end(), Real(background));
    bool fresh = true;
    for (const Pass<Real>& pass : force_->passes()) {
      const bool set = fresh && pass.set && !only_add && pass.writes.size() == 1;
      (set ? pass.set : pass.add)(pass.arguments, stage());
      fresh = false;
    }
    forces_.resize(at_.size());
    for (std::size_t k = 0; k < at_.size(); ++k) {
      // What a pass does not write it does not act on: the other half of a rigid body.
      const bool centre = k >= count() * arrangement_.dimension;
      forces_[k] = arrangement_.rigid && centre != on_centre_ ? Real(0.0) : f(k);
    }
    return forces_;
  }

  /// Largest number among the padding of the bodies, which sums over groups would pick up.
  double padding() const {
    double largest = 0.0;
    if (on_centre_) return 0.0;
    for (const BoundBody<Real>& body : bodies_) {
      const BodySlot<Real>& slot = body.slot;
      const Real* from = (slot.mapped ? mapped_force_ : force_numbers_).data() + slot.offset;
      for (int d = 0; d < arrangement_.dimension; ++d) {
        for (std::size_t i = slot.count; i < padded(slot.count); ++i) {
          largest = std::max(largest, std::abs(static_cast<double>(from[d * slot.stride + i])));
        }
      }
    }
    return largest;
  }

  /// Variables of the force's own, and what the last evaluation says of their change.
  std::size_t own_count() const { return force_->own_count(); }
  Real& own(std::size_t k) { return own_[k]; }
  std::vector<Real> own_rates() const {
    return std::vector<Real>(rates_.begin(), rates_.begin() + own_count());
  }
  /// What goes into the stored energy by way of them. Such energies are quadratic: the central
  /// difference is exact but for rounding.
  Real stored_by_own() {
    if (own_count() == 0) return Real(0.0);
    constexpr double kHalf = 0.0625;
    const std::vector<Real> rates = own_rates();
    const AlignedVector<Real> before = own_;
    const auto energy_after = [&](double h) {
      for (std::size_t k = 0; k < rates.size(); ++k) own_[k] = before[k] + Real(h) * rates[k];
      return energy();
    };
    const Real gained = energy_after(kHalf) - energy_after(-kHalf);
    own_ = before;
    return gained / Real(2.0 * kHalf);
  }

  Real energy() { return force_->energy(stage()); }
  Real rate(std::size_t k) const { return rates_[first_rate_ + k]; }
  /// What a flow acts on; rests and a key there are none.
  FlowStage<Real> flow_stage() {
    FlowStage<Real> at;
    at.position = position_.data();
    at.inverse_mass = inverse_mass_.data();
    at.velocity = velocity_.data();
    at.own = own_.data();
    return at;
  }
  std::size_t dofs() const { return velocity_.size(); }
  /// A variable of a free particle does not move from now on.
  void hold(std::size_t variable) {
    v(variable) = Real(0.0);
    inverse_mass_[static_cast<std::size_t>(&v(variable) - velocity_.data())] = Real(0.0);
  }

  /// The power that the force takes out of the particles, by its own kernel; none without one.
  std::optional<Real> heat() {
    if (!has_heat_) return std::nullopt;
    heat_.run(heat_.arguments, stage());
    return rates_[heat_rate_];
  }

 private:
  struct Variable {
    Real* position;
    Real* velocity;
    Real* force;
    double start;
    double mass;
    int axis;
  };

  void lay_out_bodies(Random& random, const Shake& shake) {
    std::vector<std::size_t> counts = {arrangement_.count};
    if (arrangement_.second > 0) counts.push_back(arrangement_.second);
    // Neither a body nor a centre stands first: an index that forgets the offset is seen.
    std::size_t end = kGroup;
    for (const std::size_t n : counts) {
      BoundBody<Real>& body = bodies_.emplace_back();
      body.index = bodies_.size() - 1;
      body.slot.count = n;
      body.slot.stride = padded(n) + kGroup;
      body.slot.offset = end;
      end += arrangement_.dimension * body.slot.stride + kGroup;
      body.slot.centre = end;
      end += 2 * kGroup;
    }
    for (auto* array : {&position_, &velocity_, &force_numbers_, &mapped_position_,
                        &mapped_velocity_, &mapped_force_, &inverse_mass_}) {
      array->assign(end + kGroup, Real(0.0));
    }
    shares_.resize(counts.size());
    Random shaking(shake.seed);
    for (BoundBody<Real>& body : bodies_) place(body, random, shake.size, shaking);
    for (BoundBody<Real>& body : bodies_) list_particles(body);
    if (!arrangement_.rigid) return;
    for (BoundBody<Real>& body : bodies_) list_centre(body);
  }

  /// Where the particles start: on a line or a circle with neighbours about one apart. A second
  /// body stands at some distance, so that no two particles meet.
  void place(BoundBody<Real>& body, Random& random, double shake, Random& shaking) {
    const int axes_count = arrangement_.dimension;
    BodySlot<Real>& slot = body.slot;
    const std::size_t n = slot.count;
    body.name = body.index == 0 ? "body" : "other";
    body.closed = arrangement_.closed;
    body.coordinates = arrangement_.rigid        ? Coordinates::rigid
                       : arrangement_.prescribed ? Coordinates::prescribed
                                                 : Coordinates::particles;
    if (arrangement_.boxed) body.open_along = 0;
    slot.mapped = arrangement_.mapped();
    slot.rigid = arrangement_.rigid;

    const auto shaken = [&](double number) {
      return shake > 0.0 ? number * (1.0 + shake * uniform(shaking, -1.0, 1.0)) : number;
    };
    const double radius = static_cast<double>(n) / 6.0 + 0.3;
    const double aside =
        body.index == 0 ? 0.0 : static_cast<double>(arrangement_.particles()) + 1.0;
    for (std::size_t i = 0; i < n; ++i) {
      std::vector<double> start(axes_count, 0.0);
      if (arrangement_.closed && axes_count > 1) {
        const double angle = 6.283185307179586 * static_cast<double>(i) / static_cast<double>(n);
        start[0] = radius * std::cos(angle);
        start[1] = radius * std::sin(angle);
      } else {
        start[0] = static_cast<double>(i);
      }
      start[0] += aside;
      for (double& component : start) component = shaken(component + uniform(random, -0.1, 0.1));
      body.start.push_back(start);
      body.mass.push_back(shaken(uniform(random, 0.5, 2.0)));
    }
    double total = 0.0;
    for (const double mass : body.mass) total += mass;
    AlignedVector<Real>& share = shares_[body.index];
    share.assign(padded(n), Real(0.0));
    for (std::size_t i = 0; i < n; ++i) share[i] = Real(body.mass[i]) / Real(total);
    slot.share = share.data();
    body.start_centre.assign(axes_count, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
      for (int d = 0; d < axes_count; ++d) {
        body.start_centre[d] += body.mass[i] / total * body.start[i][d];
      }
    }
  }

  void list_particles(const BoundBody<Real>& body) {
    const BodySlot<Real>& slot = body.slot;
    Real* const position = (slot.mapped ? mapped_position_ : position_).data();
    Real* const velocity = (slot.mapped ? mapped_velocity_ : velocity_).data();
    Real* const force = (slot.mapped ? mapped_force_ : force_numbers_).data();
    for (std::size_t i = 0; i < slot.count; ++i) {
      for (int d = 0; d < arrangement_.dimension; ++d) {
        const std::size_t k = slot.offset + d * slot.stride + i;
        at_.push_back({position + k, velocity + k, force + k, body.start[i][d], body.mass[i], d});
        if (!slot.mapped) inverse_mass_[k] = Real(1.0 / body.mass[i]);
      }
    }
  }

  void list_centre(const BoundBody<Real>& body) {
    double total = 0.0;
    for (const double mass : body.mass) total += mass;
    for (int d = 0; d < arrangement_.dimension; ++d) {
      const std::size_t k = body.slot.centre + d;
      at_.push_back({position_.data() + k, velocity_.data() + k, force_numbers_.data() + k,
                     body.start_centre[d], total, d});
    }
  }

  Arrangement arrangement_;
  std::vector<BoundBody<Real>> bodies_;
  std::vector<AlignedVector<Real>> shares_;
  std::unique_ptr<BoundForce<Real>> force_;
  std::vector<Variable> at_;
  std::vector<Real> forces_;
  AlignedVector<Real> position_, velocity_, force_numbers_;
  AlignedVector<Real> mapped_position_, mapped_velocity_, mapped_force_;
  AlignedVector<Real> inverse_mass_, own_, rates_;
  Operation<Real> heat_;
  std::size_t first_rate_ = 0;
  std::size_t heat_rate_ = 0;
  double elapsed_ = 0.0;
  bool on_centre_ = false;
  bool has_heat_ = false;
};

}  // namespace tomlin::test
