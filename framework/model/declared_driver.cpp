#include "framework/model/declared_driver.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "framework/core/numbers/sum.hpp"

namespace tomlin {
namespace {

/// A force of a support is linear to this part of itself; formulas round some dozens of times.
constexpr double kLinearityTolerance = 1e-9;
/// Times at which the support is looked for, as parts of the run, after which a motion that is not
/// steady shows itself: no two of their differences have a ratio of small integers, so that no
/// period fits all.
constexpr double kTimes[] = {0.0,
                             0.00141421356237309505,
                             0.0271828182845904524,
                             0.193147180559945309,
                             0.414213562373095049,
                             0.577215664901532861,
                             0.732050807568877294,
                             1.0};

/// To fifteen digits: what a scene gives in fewer is found again.
double rounded(double x) {
  const std::string text = fmt::format("{:.14e}", x);
  double result = x;
  std::from_chars(text.data(), text.data() + text.size(), result);
  return result;
}

bool is_close(double a, double b, double scale) {
  return std::abs(a - b) <= kLinearityTolerance * scale;
}

}  // namespace

template <class Real>
DeclaredDriver<Real>::DeclaredDriver(BoundForce<Real>& force, const Traits& traits, Element element,
                                     const std::vector<std::size_t>& on, const AssemblyPlan& plan,
                                     const AssembledBodies<Real>& bodies)
    : force_(force),
      passes_(force.passes()),
      dimension_(plan.dimension()),
      stores_energy_(traits.conservative && traits.depends_on_time),
      first_origin_(plan.origin) {
  own_.assign(bodies.dofs + 2 * kGroup, Real(0.0));
  own_mapped_.assign(bodies.mapped_size + 2 * kGroup, Real(0.0));
  for (const Pass<Real>& pass : passes_) {
    for (const Region& region : pass.writes) {
      const bool known = std::any_of(regions_.begin(), regions_.end(), [&](const Region& one) {
        return one.body == region.body && one.centre == region.centre;
      });
      if (known) continue;
      regions_.push_back(region);
      list_parts(bodies, region);
    }
  }
  of_centre_ = element == Element::body || (!regions_.empty() && regions_.front().centre);
  const auto axes = static_cast<std::size_t>(dimension_);
  drive_.velocity.assign(axes, 0.0);
  drive_.start.assign(axes, 0.0);
  drive_.travel.assign(axes, 0.0);
  drive_.steady = false;
  if (!traits.depends_on_velocity) find_support(plan, bodies, on.front(), plan.scene->run.duration);
}

template <class Real>
void DeclaredDriver<Real>::list_parts(const AssembledBodies<Real>& bodies, const Region& region) {
  const BodySlot<Real>& slot = bodies.all[region.body].bound.slot;
  for (int d = 0; d < dimension_; ++d) {
    if (region.centre) {
      parts_.push_back({false, d, slot.centre + static_cast<std::size_t>(d), 1});
    } else {
      parts_.push_back(
          {slot.mapped, d, slot.offset + static_cast<std::size_t>(d) * slot.stride, slot.count});
    }
  }
}

/// The force alone, into arrays of its own.
template <class Real>
void DeclaredDriver<Real>::act(const Stage<Real>& stage) const {
  Stage<Real> alone = stage;
  alone.force = own_.data();
  alone.mapped_force = own_mapped_.data();
  for (const Part& part : parts_) {
    Real* const from = (part.mapped ? own_mapped_ : own_).data() + part.offset;
    std::fill_n(from, part.count, Real(0.0));
  }
  for (const Pass<Real>& pass : passes_) pass.add(pass.arguments, alone);
}

template <class Real>
Pass<Real> DeclaredDriver<Real>::pass() const {
  int rank = kRankCheap;
  for (const Pass<Real>& one : passes_) rank = std::max(rank, one.rank);
  return {nullptr, &DeclaredDriver::drive, this, regions_, rank};
}

template <class Real>
void DeclaredDriver<Real>::place_rates(std::ptrdiff_t first) {
  rate_ = first;
  if (!force_.heat(rate_ + dimension_, heat_) || !stores_energy_) heat_ = {};
}

template <class Real>
void DeclaredDriver<Real>::drive(const void* driver, const Stage<Real>& stage) {
  const auto& self = *static_cast<const DeclaredDriver*>(driver);
  self.act(stage);
  std::array<InterleavedSum<Real>, 3> total;
  for (const Part& part : self.parts_) {
    const Real* const own = (part.mapped ? self.own_mapped_ : self.own_).data() + part.offset;
    Real* const all = (part.mapped ? stage.mapped_force : stage.force) + part.offset;
    auto& sum = total[static_cast<std::size_t>(part.axis)];
    for (std::size_t i = 0; i < part.count; ++i) {
      all[i] = all[i] + own[i];
      sum.add(i, own[i]);
    }
  }
  for (int d = 0; d < self.dimension_; ++d) {
    stage.rates[self.rate_ + d] = total[static_cast<std::size_t>(d)].total();
  }
}

template <class Real>
void DeclaredDriver<Real>::write_power(const void* driver, const Stage<Real>& stage) {
  const auto& self = *static_cast<const DeclaredDriver*>(driver);
  Real& power = stage.rates[self.rate_ + self.dimension_];
  if (self.heat_.run != nullptr) {
    self.heat_.run(self.heat_.arguments, stage);
    power = -power;
    return;
  }
  InterleavedSum<Real> sum;
  for (const Part& part : self.parts_) {
    const Real* const own = (part.mapped ? self.own_mapped_ : self.own_).data() + part.offset;
    const Real* const v = (part.mapped ? stage.mapped_velocity : stage.velocity) + part.offset;
    for (std::size_t i = 0; i < part.count; ++i) sum.add(i, own[i] * v[i]);
  }
  power = sum.total();
}

/// Forces on the body, moved as a whole along an axis, at several times.
template <class Real>
void DeclaredDriver<Real>::find_support(const AssemblyPlan& plan,
                                        const AssembledBodies<Real>& bodies, std::size_t body,
                                        double duration) {
  const AssembledBody<Real>& on = bodies.all[body];
  const BodySlot<Real>& slot = on.bound.slot;
  AlignedVector<Real> position(bodies.dofs + 2 * kGroup, Real(0.0));
  AlignedVector<Real> mapped(bodies.mapped_size + 2 * kGroup, Real(0.0));
  AlignedVector<Real> velocity(position.size(), Real(0.0));
  AlignedVector<Real> mapped_velocity(mapped.size(), Real(0.0));
  Stage<Real> stage;
  stage.position = position.data();
  stage.velocity = velocity.data();
  stage.mapped_position = mapped.data();
  stage.mapped_velocity = mapped_velocity.data();
  // Point of action of the force: the centre of mass, or the mean of equal shares.
  Total middle{};
  for (int d = 0; d < dimension_; ++d) {
    InterleavedSum<double> mean;
    for (std::size_t i = 0; i < slot.count; ++i) mean.add(i, on.bound.start[i][d]);
    middle[d] =
        of_centre_ ? on.bound.start_centre[d] : mean.total() / static_cast<double>(slot.count);
  }
  const auto force_at = [&](double time, int moved, double by) {
    for (int d = 0; d < dimension_; ++d) {
      const double shift = d == moved ? by : 0.0;
      AlignedVector<Real>& target = slot.mapped ? mapped : position;
      for (std::size_t i = 0; i < slot.count; ++i) {
        target[slot.offset + static_cast<std::size_t>(d) * slot.stride + i] =
            Real(on.bound.start[i][d] + shift);
      }
      if (slot.rigid) {
        position[slot.centre + static_cast<std::size_t>(d)] =
            Real(on.bound.start_centre[d] + shift);
      }
    }
    force_.begin_step(DoubleDouble(time));
    act(stage);
    Total total{};
    for (const Part& part : parts_) {
      InterleavedSum<double> sum;
      const Real* const own = (part.mapped ? own_mapped_ : own_).data() + part.offset;
      for (std::size_t i = 0; i < part.count; ++i) sum.add(i, static_cast<double>(own[i]));
      total[static_cast<std::size_t>(part.axis)] = sum.total();
    }
    return total;
  };

  const double reach =
      std::max({1.0, plan.origin.unit[0], plan.origin.unit[1], plan.origin.unit[2]});
  Drive found = drive_;
  found.stiffness.assign(static_cast<std::size_t>(dimension_), 0.0);
  found.steady = true;
  std::array<Total, std::size(kTimes)> support{};
  for (int axis = 0; axis < dimension_; ++axis) {
    for (std::size_t n = 0; n < std::size(kTimes); ++n) {
      const double time = kTimes[n] * duration;
      const Total here = force_at(time, axis, 0.0);
      double stiffness = 0.0;
      for (const double by : {reach, -0.7 * reach, 0.3 * reach}) {
        const Total there = force_at(time, axis, by);
        for (int d = 0; d < dimension_; ++d) {
          const double size = std::max(std::abs(here[d]), std::abs(there[d]));
          const double change = there[d] - here[d];
          if (d != axis && !is_close(change, 0.0, size)) return;
          if (d != axis) continue;
          const double slope = -change / by;
          if (by == reach) stiffness = std::abs(change) <= kLinearityTolerance * size ? 0.0 : slope;
          if (!is_close(slope * by, stiffness * by, size)) return;
        }
      }
      if (n == 0) found.stiffness[axis] = rounded(stiffness);
      if (stiffness < 0.0 || !is_close(stiffness, found.stiffness[axis], stiffness)) return;
      if (stiffness == 0.0 && here[axis] != 0.0) return;  // a force, and no spring
      support[n][axis] = middle[axis] + (stiffness > 0.0 ? here[axis] / stiffness : 0.0);
    }
  }
  for (int axis = 0; axis < dimension_; ++axis) {
    const double way = support[std::size(kTimes) - 1][axis] - support[0][axis];
    double scale = std::abs(middle[axis]);
    for (const Total& at : support) scale = std::max(scale, std::abs(at[axis]));
    for (std::size_t n = 0; n < std::size(kTimes); ++n) {
      if (!is_close(support[n][axis], support[0][axis] + kTimes[n] * way, scale)) return;
    }
    found.start[axis] = support[0][axis];
    found.velocity[axis] = std::abs(way) <= 1e-14 * scale ? 0.0 : rounded(way / duration);
  }
  drive_ = std::move(found);
}

template <class Real>
void DeclaredDriver<Real>::begin_step(const DoubleDouble& time, const Origin& origin) {
  if (!drive_.steady) return;
  for (int d = 0; d < dimension_; ++d) {
    const auto cells = static_cast<double>(origin.cells[d] - first_origin_.cells[d]);
    const DoubleDouble shift = DoubleDouble(cells) * origin.unit[d];
    drive_.travel[d] = static_cast<double>(time * drive_.velocity[d] - shift);
  }
}

template class DeclaredDriver<double>;
template class DeclaredDriver<Quad>;

}  // namespace tomlin
