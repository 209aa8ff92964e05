#include "framework/model/assembly.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "framework/core/kernel_tables.hpp"
#include "framework/core/random.hpp"
#include "framework/core/sum.hpp"
#include "framework/core/tolerance.hpp"
#include "framework/model/plugin_code.hpp"
#include "framework/scene/motion_slope.hpp"
#include "framework/scene/natural_units.hpp"

TOMLIN_DECLARE_TABLES(RigidKernels, RigidTable)
TOMLIN_DECLARE_TABLES(FrictionKernels, FrictionTable)

namespace tomlin {
namespace {

/// No limit on a move, though still a finite one: infinity would let an infinite move pass.
template <class Real>
Real unbounded() {
  return Real(sizeof(Real) < sizeof(double) ? std::numeric_limits<float>::max()
                                            : std::numeric_limits<double>::max());
}

/// Distance from one axis of a body's particles to the next, kept off multiples of a page so that
/// the axes do not compete for the same cache lines.
std::size_t stride_for(std::size_t count) {
  const std::size_t length = padded(count);
  return length % 512 == 0 ? length + 3 * kGroup : length;
}

/// Places so far away that they cannot be counted in periods come out as no numbers.
bool placed_finitely(const std::vector<std::vector<double>>& start) {
  for (const auto& particle : start) {
    for (const double x : particle) {
      if (!std::isfinite(x)) return false;
    }
  }
  return true;
}

double per_particle(const PerParticle& given, std::size_t i) {
  return given.values.size() == 1 ? given.values.front() : given.values[i];
}

bool names(const std::vector<std::string>& words, const char* word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// Writes zeros where no force acts.
struct ZeroArguments {
  bool mapped = false;
  std::size_t offset = 0;
  std::size_t length = 0;
};

template <class Real>
void zero_kernel(const void* arguments, const Stage<Real>& stage) {
  const auto& a = *static_cast<const ZeroArguments*>(arguments);
  Real* f = (a.mapped ? stage.mapped_force : stage.force) + a.offset;
  for (std::size_t i = 0; i < a.length; ++i) f[i] = Real(0.0);
}

/// What accelerates a prescribed body, besides what the forces on it take: m dv/dt and the power of
/// that and of I domega/dt. Added to the body's force and power, and kept apart behind them, since
/// their integrals are known from the velocities at both ends, jumps of the velocity included.
struct InertiaArguments {
  const Motion* motion = nullptr;
  const DoubleDouble* anchor = nullptr;  ///< of the stages' time
  double mass = 0.0;
  double inertia = 0.0;
  std::ptrdiff_t rate = kNoRate;  ///< of the body's force
};

template <class Real>
void inertia_kernel(const void* arguments, const Stage<Real>& stage) {
  const auto& a = *static_cast<const InertiaArguments*>(arguments);
  const double now = static_cast<double>(*a.anchor) + static_cast<double>(stage.elapsed);
  // Where a velocity jumps or its slope has no bound there is no force to speak of.
  const auto slope = [now](const TimeFunction& function) {
    const double value = slope_of(function, now);
    return std::isfinite(value) ? value : 0.0;
  };
  const auto axes = static_cast<std::ptrdiff_t>(a.motion->velocity.size());
  Real* total = stage.rates + a.rate;
  Real* apart = total + axes + 1;
  const TimeFunction& spin = a.motion->angular_velocity;
  double power = 0.0;
  if (!spin.is_constant()) power = a.inertia * slope(spin) * spin(now);
  for (std::ptrdiff_t d = 0; d < axes; ++d) {
    const TimeFunction& velocity = a.motion->velocity[d];
    const double force = velocity.is_constant() ? 0.0 : a.mass * slope(velocity);
    if (force != 0.0) power = std::fma(force, velocity(now), power);
    apart[d] = Real(force);
    total[d] = total[d] + apart[d];
  }
  apart[axes] = Real(power);
  total[axes] = total[axes] + apart[axes];
}

/// Collects the friction coefficients of particles.
class CoefficientSink : public FrictionSink {
 public:
  explicit CoefficientSink(std::size_t bodies) : coefficients(bodies) {}
  void site(std::size_t body, std::size_t particle, double coefficient) override {
    coefficients[body][particle] += coefficient;
  }
  std::vector<std::vector<double>> coefficients;
};

/// Errors are held against the scene's own length and time: see framework/core/tolerance.hpp.
template <class Real>
AlignedVector<Real> tolerance_scales_of(const Assembly<Real>& assembly) {
  const NaturalUnits units = natural_units(assembly.scene());
  const SystemView<Real>& view = assembly.system().view;
  const Real per_length = Real(1.0 / units.length);
  const Real time = Real(units.time);
  AlignedVector<Real> scales(size_of_tolerance_scales(view), per_length);
  Real* velocity = scales.data() + view.dofs;
  Real* in_units = velocity + view.dofs;
  Real* own = in_units + view.dofs;
  std::fill(velocity, in_units, per_length * time);
  std::fill(in_units, own, Real(1.0));
  std::fill(own, own + view.own, per_length * time);
  for (const auto& body : assembly.bodies()) {
    if (!body.bound.slot.rigid || assembly.dimension() != 2) continue;
    const std::size_t at = body.bound.slot.centre + kRotation;
    scales[at] = tau<Real>();
    in_units[at] = tau<Real>() * Real(units.length);
    velocity[at] = tau<Real>() * time;
  }
  for (const auto& steered : assembly.steered()) {
    for (int k = 0; k < 4; ++k) {
      if (steered.own[k] >= 0) own[steered.own[k]] = k < 3 ? per_length : tau<Real>();
    }
  }
  own[view.own] = Real(units.length);
  own[view.own + 1] = time;
  return scales;
}

}  // namespace

template <class Real>
Assembly<Real>::Assembly(const AssemblyPlan& plan) : plan_(plan), origin_(plan.origin) {
  size_bodies();
  place_bodies();
  lay_coordinates();
  bind_forces();
  lay_rates();
  tolerance_scale_ = tolerance_scales_of(*this);
  system_.view.tolerance_scale = tolerance_scale_.data();
  bound_moves();
  if (!plan_.inertial || plan_.splits_friction) lay_friction();
  order_operations();
}

/// First the sizes, since views point into arrays that must not move afterwards.
template <class Real>
void Assembly<Real>::size_bodies() {
  std::vector<Fault> faults;
  for (std::size_t b = 0; b < scene().bodies.size(); ++b) {
    const SceneBody& from = scene().bodies[b];
    const BodyDescription& common = from.record->common(from.description.get());
    const BodyGeometry& geometry = plan_.geometry[b];
    const std::size_t count = geometry.relative.size();
    Body body;
    body.rolling_radius = geometry.rolling_radius;
    body.bound.name = from.name;
    body.bound.index = b;
    body.bound.coordinates = common.coordinates;
    const BodyEnds ends = from.record->ends(from.description.get(), dimension());
    body.bound.closed = ends.closed;
    body.bound.open_along = ends.open_along;
    if (from.motion) body.motion = &*from.motion;
    static constexpr const char* kAxes[] = {"x", "y", "z"};
    for (int d = 0; d < dimension(); ++d) body.held[d] = names(from.hold, kAxes[d]);
    body.rotation_held = names(from.hold, "rotation");
    BodySlot<Real>& slot = body.bound.slot;
    slot.count = count;
    slot.stride = stride_for(count);
    slot.mapped = common.coordinates != "particles";
    slot.rigid = common.coordinates == "rigid";
    const std::size_t block = slot.stride * dimension();
    if (slot.mapped) {
      slot.offset = mapped_size_;
      mapped_size_ += block + 2 * kGroup;
    } else {
      slot.offset = dofs_;
      dofs_ += padded(block);
    }
    if (slot.rigid) {
      if (dimension() == 3 && !body.rotation_held && count > 1) {
        faults.push_back({from.place_of("coordinates"), "body." + from.name + ".coordinates",
                          "\"rigid\"", "rotations in space are not in this version",
                          "hold = [\"rotation\"] beside it, or \"particles\"", ""});
      }
      slot.centre = dofs_;
      dofs_ += kGroup;
    }

    // Positions relative to the origin, to the last digit however far away the body is.
    body.bound.start.assign(count, std::vector<double>(dimension(), 0.0));
    for (int d = 0; d < dimension(); ++d) {
      const double anchor = relative_to(origin_, d, geometry.anchor[d]);
      for (std::size_t i = 0; i < count; ++i) {
        body.bound.start[i][d] = anchor + geometry.relative[i][d];
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      body.bound.mass.push_back(per_particle(common.particle_mass, i));
    }
    InterleavedSum<double> mass;
    for (std::size_t i = 0; i < count; ++i) mass.add(i, body.bound.mass[i]);
    body.total_mass = mass.total();
    if (!std::isfinite(body.total_mass)) {
      faults.push_back({from.place_of("particle_mass"), "body." + from.name + ".particle_mass", "",
                        "the body's total mass overflows", "smaller masses", ""});
    }
    if (!placed_finitely(body.bound.start)) {
      faults.push_back({from.place, "body." + from.name, "",
                        "further from the origin than can be counted in periods",
                        "a place nearer the origin", ""});
    }
    bodies_.push_back(std::move(body));
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

template <class Real>
void Assembly<Real>::place_bodies() {
  for (Body& body : bodies_) {
    const std::size_t count = body.bound.slot.count;
    const BodyGeometry& geometry = plan_.geometry[body.bound.index];
    std::vector<double> share(count);
    for (std::size_t i = 0; i < count; ++i) share[i] = body.bound.mass[i] / body.total_mass;
    share_.emplace_back(padded(count), Real(0.0));
    for (std::size_t i = 0; i < count; ++i) {
      share_.back()[i] = Real(body.bound.mass[i]) / Real(body.total_mass);
    }
    body.bound.slot.share = share_.back().data();

    std::vector<double> middle(dimension());
    for (int d = 0; d < dimension(); ++d) {
      InterleavedSum<double> mean;
      for (std::size_t i = 0; i < count; ++i) mean.add(i, share[i] * geometry.relative[i][d]);
      middle[d] = mean.total();
      body.bound.start_centre.push_back(relative_to(origin_, d, geometry.anchor[d]) + middle[d]);
    }
    InterleavedSum<double> inertia;
    body.arms.assign(count, std::vector<double>(dimension()));
    for (std::size_t i = 0; i < count; ++i) {
      double square = 0.0;
      for (int d = 0; d < dimension(); ++d) {
        body.arms[i][d] = geometry.relative[i][d] - middle[d];
        square = std::fma(body.arms[i][d], body.arms[i][d], square);
      }
      inertia.add(i, body.bound.mass[i] * square);
    }
    body.inertia = inertia.total();
  }
}

/// Masses and limits of every coordinate; what is held has no inverse mass.
template <class Real>
void Assembly<Real>::lay_coordinates() {
  inverse_mass_.assign(dofs_, Real(0.0));
  largest_move_.assign(dofs_, unbounded<Real>());
  force_.assign(dofs_ + 2 * kGroup, Real(0.0));
  mapped_position_.assign(mapped_size_ + 2 * kGroup, Real(0.0));
  mapped_velocity_.assign(mapped_size_ + 2 * kGroup, Real(0.0));
  mapped_force_.assign(mapped_size_ + 2 * kGroup, Real(0.0));
  SystemView<Real>& view = system_.view;
  for (Body& body : bodies_) {
    const BodySlot<Real>& slot = body.bound.slot;
    if (slot.rigid || body.prescribed()) {
      arms_.emplace_back(dimension() * slot.stride, Real(0.0));
      reference_.emplace_back(dimension() * slot.stride, Real(0.0));
      for (std::size_t i = 0; i < slot.count; ++i) {
        for (int d = 0; d < dimension(); ++d) {
          reference_.back()[d * slot.stride + i] = Real(body.arms[i][d]);
        }
      }
      RigidArguments<Real> arguments;
      arguments.body = slot;
      arguments.reference = reference_.back().data();
      arguments.arm = arms_.back().data();
      rigid_.push_back(arguments);
      rigid_body_.push_back(body.bound.index);
    }
    if (slot.rigid) {
      for (int d = 0; d < dimension(); ++d) {
        if (origin_.unit[d] > 0.0) largest_move_[slot.centre + d] = Real(origin_.unit[d]);
        if (body.held[d]) continue;
        inverse_mass_[slot.centre + d] = Real(1.0) / Real(body.total_mass);
        body.response[d] = 1.0 / body.total_mass;
        ++view.coordinates;
      }
      if (dimension() != 2) continue;
      largest_move_[slot.centre + kRotation] = Real(0.5);
      // A body without extent (one particle) has no rotation to speak of: it stays put.
      if (!(body.inertia > 0.0) || body.rotation_held) continue;
      inverse_mass_[slot.centre + kRotation] =
          Real(1.0) / (tau<Real>() * tau<Real>() * Real(body.inertia));
      body.response_of_rotation = 1.0 / body.inertia;
      ++view.coordinates;
    } else if (!slot.mapped) {
      for (int d = 0; d < dimension(); ++d) {
        if (!body.held[d]) view.coordinates += slot.count;
        for (std::size_t i = 0; i < slot.count; ++i) {
          const std::size_t at = slot.offset + d * slot.stride + i;
          if (!body.held[d]) inverse_mass_[at] = Real(1.0) / Real(body.bound.mass[i]);
          if (origin_.unit[d] > 0.0) largest_move_[at] = Real(origin_.unit[d]);
        }
      }
    }
  }
  view.dofs = dofs_;
  view.inertial = plan_.inertial;
  view.inverse_mass = inverse_mass_.data();
  view.largest_move = largest_move_.data();
  view.force = force_.data();
  view.mapped_position = mapped_position_.data();
  view.mapped_velocity = mapped_velocity_.data();
  view.mapped_force = mapped_force_.data();
  system_.set = plan_.set;
}

/// Friction of bodies that move by forces; what is prescribed or fixed is dragged along as ever.
template <class Real>
bool Assembly<Real>::takes_as_operator(const Force& force) const {
  if (plan_.quasistatic) return force.bound->is_friction();
  if (plan_.inertial && !plan_.splits_friction) return false;
  if (!force.bound->is_friction()) return false;
  return std::none_of(force.bodies.begin(), force.bodies.end(), [&](std::size_t b) {
    return bodies_[b].bound.slot.mapped && !bodies_[b].bound.slot.rigid;
  });
}

namespace {

/// A complaint about a force of the scene, at the key that it is about.
Fault fault_of(const SceneForce& force, const Complaint& complaint) {
  Fault fault;
  fault.place = force.place_of(complaint.key);
  if (complaint.column && fault.place.line > 0 && force.places.contains(complaint.key)) {
    fault.place.column += static_cast<int>(*complaint.column) + 1;  // behind the quotation mark
  }
  fault.key = "force." + force.name + "." + complaint.key;
  fault.why = complaint.why;
  fault.admissible = complaint.admissible;
  fault.nearest = complaint.nearest;
  return fault;
}

}  // namespace

template <class Real>
void Assembly<Real>::bind_forces() {
  std::vector<Fault> faults;
  for (const SceneForce& from : scene().forces) {
    const auto all_of = [&](auto&& holds) {
      return std::all_of(from.bodies.begin(), from.bodies.end(),
                         [&](std::size_t b) { return holds(bodies_[b]); });
    };
    const bool one_body = from.bodies.size() == 1;
    const Traits traits = bound_by(from, "force", [&] { return from.traits(); });
    if (traits.internal && one_body &&
        all_of([](const Body& body) { return body.bound.slot.rigid || body.prescribed(); })) {
      left_out_.push_back({from.name, "internal to a rigid body, where it does nothing"});
      continue;
    }
    const bool nothing_moves =
        all_of([](const Body& body) { return body.bound.coordinates == "fixed"; });
    if (nothing_moves && !traits.does_work) {
      left_out_.push_back({from.name, "acts only on what is fixed"});
      continue;
    }
    Binding<Real> binding;
    binding.dimension = dimension();
    binding.set = plan_.set;
    binding.origin = origin_;
    binding.box = plan_.box;
    for (const std::size_t b : from.bodies) binding.bodies.push_back(&bodies_[b].bound);
    const auto factory = from.record->bind.template in<Real>();
    if (factory == nullptr) {
      const auto place = scene().run.places.find("number_type");
      faults.push_back(
          {place == scene().run.places.end() ? scene().run.place : place->second, "run.number_type",
           "\"" + scene().run.number_type + "\"",
           "not available with the force \"" + from.name + "\", of type " + from.record->name,
           "\"double\"", ""});
      continue;
    }
    Force force;
    force.name = from.name;
    force.record = from.record;
    force.traits = traits;
    force.bodies = from.bodies;
    try {
      force.bound = bound_by(from, "force",
                             [&] { return something(factory(from.description.get(), binding)); });
    } catch (const BindError& error) {
      faults.push_back(fault_of(from, error.complaint));
      continue;
    }
    const std::string& library = from.record->library;
    if (!library.empty()) {
      force.bound = guarded(std::move(force.bound), "force " + from.name, library);
    }
    force.is_operator = takes_as_operator(force);
    if (force.bound->depends_on_time()) timed_.push_back(force.bound.get());
    forces_.push_back(std::move(force));
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

/// Own variables come first among the integrals: stages read them back.
template <class Real>
void Assembly<Real>::lay_rates() {
  std::size_t own = 0;
  for (Body& body : bodies_) {
    if (!body.prescribed()) continue;
    body.steering = steering_.size();
    Steering steering;
    steering.motion = body.motion;
    steering.axes = dimension();
    steering.planar = dimension() == 2;
    Steered steered;
    steered.body = body.bound.index;
    for (int d = 0; d < dimension(); ++d) steering.start[d] = Real(body.bound.start_centre[d]);
    for (int k = 0; k < 4; ++k) {
      if (k >= dimension() && k < 3) continue;
      if (k == 3 && !steering.planar) continue;
      const TimeFunction& function = steering.function(k);
      if (function.is_constant()) {
        steering.speed[k] = Real(function.constant) / (k < 3 ? Real(1.0) : tau<Real>());
      } else {
        steered.own[k] = steering.own[k] = static_cast<std::ptrdiff_t>(own++);
      }
    }
    steering_.push_back(steering);
    steered_.push_back(steered);
  }
  for (Force& force : forces_) {
    if (force.bound->own_count() == 0) continue;
    force.bound->place_own(own);
    own += force.bound->own_count();
  }
  own_count_ = own;
  std::size_t rates = padded(own);
  for (Force& force : forces_) {
    if (force.bound->rate_count() == 0) continue;
    force.first_rate = static_cast<std::ptrdiff_t>(rates);
    force.bound->place_rates(force.first_rate);
    rates += force.bound->rate_count();
    if (force.traits.does_work) {
      drivers_.push_back({force.name, force.first_rate, force.bound->drive()});
    }
  }
  for (std::size_t k = 0; k < rigid_.size(); ++k) {
    const Body& body = bodies_[rigid_body_[k]];
    if (!body.prescribed()) continue;
    RigidArguments<Real>& arguments = rigid_[k];
    Steering& steering = steering_[body.steering];
    arguments.coordinates = steering.coordinates;
    arguments.speeds = steering.speeds;
    arguments.velocities = true;
    arguments.rate = static_cast<std::ptrdiff_t>(rates);
    rates += dimension() + 1;
    if (plan_.inertial && !plan_.quasistatic && accelerates(*body.motion)) rates += dimension() + 1;
    Drive drive;
    drive.start = body.bound.start_centre;
    drive.travel.assign(dimension(), 0.0);
    for (const TimeFunction& function : body.motion->velocity) {
      drive.steady = drive.steady && function.is_constant();
      drive.velocity.push_back(function.constant);
    }
    prescribed_drives_.push_back(std::move(drive));
    drivers_.push_back({body.bound.name, arguments.rate, &prescribed_drives_.back()});
  }
  if (plan_.ledger) {
    for (Force& force : forces_) {
      Operation<Real> unused;
      if (force.is_operator || !force.bound->heat(0, unused)) continue;
      force.heat_rate = static_cast<std::ptrdiff_t>(rates++);
    }
    if (!plan_.inertial || plan_.splits_friction) {
      friction_rate_ = static_cast<std::ptrdiff_t>(rates++);
    }
  }
  SystemView<Real>& view = system_.view;
  view.own = padded(own);
  view.own_count = own;
  view.rates = padded(rates);
  view.used_rates = rates;
}

/// A bond may not turn over in one step: half the shortest bond of a body bounds its particles.
template <class Real>
void Assembly<Real>::bound_moves() {
  for (const Force& force : forces_) {
    const double shortest = force.bound->shortest_bond();
    if (!(shortest > 0.0)) continue;
    for (const std::size_t b : force.bodies) {
      const BodySlot<Real>& slot = bodies_[b].bound.slot;
      if (slot.mapped) continue;
      for (std::size_t i = 0; i < slot.stride * dimension(); ++i) {
        Real& limit = largest_move_[slot.offset + i];
        limit = std::min(limit, Real(0.5 * shortest));
      }
    }
  }
}

/// Friction as a matrix: what dynamics without inertia divides forces by, and what splitting
/// schemes take as an operator.
template <class Real>
void Assembly<Real>::lay_friction() {
  CoefficientSink sink(bodies_.size());
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    sink.coefficients[b].assign(bodies_[b].bound.slot.count, 0.0);
  }
  for (const Force& force : forces_) {
    if (force.is_operator) force.bound->friction(sink);
  }
  std::vector<Fault> faults;
  const auto missing = [&](const Body& body, const std::string& coordinate) {
    const auto place = scene().run.places.find("dynamics");
    faults.push_back({place == scene().run.places.end() ? scene().run.place : place->second,
                      "run.dynamics", "\"overdamped\"",
                      fmt::format("no friction on {} of body \"{}\": the friction matrix is not "
                                  "positive definite",
                                  coordinate, body.bound.name),
                      "a damper with a positive coefficient on every coordinate that moves", ""});
  };
  static constexpr const char* kAxes[] = {"x", "y", "z"};
  mobility_.assign(dofs_, Real(0.0));
  heat_of_bodies_.assign(bodies_.size(), Real(0.0));
  for (Body& body : bodies_) {
    const BodySlot<Real>& slot = body.bound.slot;
    if (slot.mapped && !slot.rigid) continue;
    const std::vector<double>& coefficient = sink.coefficients[body.bound.index];
    FrictionArguments<Real> arguments;
    arguments.body = slot;
    arguments.axes = dimension();
    bool any = false;
    for (const double c : coefficient) any = any || c > 0.0;
    if (slot.rigid) {
      InterleavedSum<Real> total;
      InterleavedSum<Real> moment[2];
      InterleavedSum<Real> second;
      for (std::size_t i = 0; i < slot.count; ++i) {
        const Real c(coefficient[i]);
        total.add(i, c);
        if (dimension() != 2) continue;
        for (int d = 0; d < 2; ++d) moment[d].add(i, c * Real(body.arms[i][d]));
        const Real x(body.arms[i][0]);
        const Real y(body.arms[i][1]);
        second.add(i, c * (x * x + y * y));
      }
      arguments.total = total.total();
      for (int d = 0; d < 2; ++d) {
        arguments.moment[d] = moment[d].total();
        // Equal shares of friction and mass are centred alike but for rounding.
        const double size = static_cast<double>(abs(arguments.moment[d]));
        const double scale = static_cast<double>(sqrt(second.total() * arguments.total));
        constexpr double kRounding = 1e-6;
        if (size <= kRounding * kRounding * scale) arguments.moment[d] = Real(0.0);
      }
      arguments.second = tau<Real>() * tau<Real>() * second.total();
      arguments.mass = Real(body.total_mass);
      arguments.inertia = tau<Real>() * tau<Real>() * Real(body.inertia);
      arguments.rotates = dimension() == 2 && inverse_mass_[slot.centre + kRotation] != Real(0.0);
      for (int d = 0; d < dimension(); ++d) arguments.free[d] = !body.held[d];
      if (!plan_.inertial) {
        for (int d = 0; d < dimension(); ++d) {
          if (arguments.free[d] && !any) missing(body, kAxes[d]);
        }
        for (std::size_t k = 0; k < 3; ++k) inverse_mass_[slot.centre + k] = Real(1.0);
        for (int d = 0; d < dimension(); ++d) {
          body.response[d] = arguments.free[d] ? 1.0 / static_cast<double>(arguments.total) : 0.0;
        }
        if (arguments.rotates) {
          const auto total_friction = static_cast<double>(arguments.total);
          auto about_pivot = static_cast<double>(second.total());
          for (int d = 0; d < 2; ++d) {
            if (!arguments.free[1 - d]) continue;
            const auto moment_of_friction = static_cast<double>(arguments.moment[d]);
            body.pivot[d] = moment_of_friction / total_friction;
            about_pivot -= moment_of_friction * body.pivot[d];
          }
          // Friction at a single point lets the body turn freely about it.
          constexpr double kNothing = 1e-12;
          if (!(about_pivot > kNothing * static_cast<double>(second.total()))) {
            missing(body, "the rotation");
          }
          body.response_of_rotation = 1.0 / about_pivot;
        }
        if (plan_.ledger) arguments.heat_of_body = &heat_of_bodies_[body.bound.index];
      }
    } else {
      arguments.length = slot.stride * dimension();
      friction_arrays_.emplace_back(padded(arguments.length), Real(0.0));
      AlignedVector<Real>& array = friction_arrays_.back();
      for (int d = 0; d < dimension(); ++d) {
        for (std::size_t i = 0; i < slot.count; ++i) {
          const std::size_t at = d * slot.stride + i;
          if (body.held[d]) continue;
          array[at] = Real(coefficient[i]);
          if (plan_.inertial) continue;
          if (!(coefficient[i] > 0.0) && faults.size() < 5) {
            missing(body, fmt::format("{} of particle {}", kAxes[d], i));
          }
          inverse_mass_[slot.offset + at] = Real(1.0) / Real(coefficient[i]);
          mobility_[slot.offset + at] = inverse_mass_[slot.offset + at];
        }
      }
      arguments.coefficient = array.data();
      arguments.inverse_mass = inverse_mass_.data() + slot.offset;
      friction_arrays_.emplace_back(padded(arguments.length), Real(0.0));
      arguments.keep = friction_arrays_.back().data();
      friction_arrays_.emplace_back(padded(arguments.length), Real(0.0));
      arguments.loss = friction_arrays_.back().data();
      friction_arrays_.emplace_back(kGroup, Real(-1.0));
      arguments.known_h = friction_arrays_.back().data();
    }
    if (plan_.inertial && !any) continue;
    friction_.push_back(arguments);
  }
  if (!faults.empty()) throw InputError(std::move(faults));
  if (!plan_.inertial) return;
  const auto& table = kernels::FrictionKernels.on<Real>(plan_.set);
  for (const FrictionArguments<Real>& arguments : friction_) {
    const bool one = arguments.body.rigid;
    friction_operators_.push_back({one ? table.flow_of_body : table.flow_of_particles,
                                   one ? table.drag_of_body : table.drag_of_particles, &arguments});
  }
  system_.view.friction = friction_operators_.data();
  system_.view.friction_count = friction_operators_.size();
  system_.view.friction_rate = friction_rate_;
}

/// One evaluation, in order: bodies that move as one place their particles; forces on rigid
/// centres; forces on particles, cheap ones first; rigid bodies gather; the ledger. The first force
/// on each region sets, the rest add.
template <class Real>
void Assembly<Real>::order_operations() {
  const RigidTable<Real>& rigid = kernels::RigidKernels.on<Real>(plan_.set);
  const int axis = dimension() - 1;
  for (std::size_t k = 0; k < rigid_.size(); ++k) {
    if (!scene().observers.empty()) rigid_[k].velocities = true;
    for (const Force& force : forces_) {
      const bool acts = std::count(force.bodies.begin(), force.bodies.end(), rigid_body_[k]) > 0;
      const bool reads = force.traits.depends_on_velocity || force.heat_rate != kNoRate;
      if (acts && reads && !force.is_operator) {
        rigid_[k].velocities = true;
      }
    }
  }

  std::vector<Pass<Real>> passes;
  for (Force& force : forces_) {
    if (force.is_operator) continue;
    for (Pass<Real>& pass : force.bound->passes()) passes.push_back(std::move(pass));
  }
  std::stable_sort(passes.begin(), passes.end(),
                   [](const auto& a, const auto& b) { return a.rank < b.rank; });
  if (plan_.backwards) std::reverse(passes.begin(), passes.end());

  std::vector<bool> particles_set(bodies_.size(), false);
  std::vector<bool> centre_set(bodies_.size(), false);
  const auto mark = [&](const Region& region) -> std::vector<bool>::reference {
    return region.centre ? centre_set[region.body] : particles_set[region.body];
  };
  const auto zero = [&](std::size_t b, bool centre) {
    const BodySlot<Real>& slot = bodies_[b].bound.slot;
    auto arguments = std::make_shared<ZeroArguments>();
    if (centre) {
      *arguments = {false, slot.centre, kGroup};
    } else {
      *arguments = {slot.mapped, slot.offset, slot.stride * dimension()};
    }
    operations_.push_back({&zero_kernel<Real>, arguments.get()});
    zeros_.push_back(std::move(arguments));
  };
  const auto emit = [&](const Pass<Real>& pass) {
    const bool fresh = std::none_of(pass.writes.begin(), pass.writes.end(),
                                    [&](const Region& region) { return mark(region); });
    if (fresh && pass.set && pass.writes.size() == 1) {
      operations_.push_back({pass.set, pass.arguments});
    } else {
      for (const Region& region : pass.writes) {
        if (!mark(region)) zero(region.body, region.centre);
        mark(region) = true;
      }
      operations_.push_back({pass.add, pass.arguments});
    }
    for (const Region& region : pass.writes) mark(region) = true;
  };

  for (const Steering& steering : steering_) operations_.push_back({&Assembly::steer, &steering});
  for (const auto& arguments : rigid_) operations_.push_back({rigid.place[axis], &arguments});
  for (const auto& pass : passes) {
    if (pass.writes.front().centre) emit(pass);
  }
  for (const auto& pass : passes) {
    if (!pass.writes.front().centre) emit(pass);
  }
  for (std::size_t k = 0; k < rigid_.size(); ++k) {
    const std::size_t b = rigid_body_[k];
    if (bodies_[b].prescribed()) {
      if (!particles_set[b]) zero(b, false);
      operations_.push_back({rigid.react[axis], &rigid_[k]});
      const Body& body = bodies_[b];
      if (!plan_.inertial || plan_.quasistatic || !accelerates(*body.motion)) continue;
      auto arguments = std::make_shared<InertiaArguments>();
      *arguments = {body.motion, &steering_[body.steering].anchor, body.total_mass, body.inertia,
                    rigid_[k].rate};
      operations_.push_back({&inertia_kernel<Real>, arguments.get()});
      zeros_.push_back(std::move(arguments));
      continue;
    }
    if (!particles_set[b]) continue;
    const auto& gather = centre_set[b] ? rigid.gather_add : rigid.gather_set;
    operations_.push_back({gather[axis], &rigid_[k]});
    centre_set[b] = true;
  }
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const BodySlot<Real>& slot = bodies_[b].bound.slot;
    if (slot.rigid && !centre_set[b]) zero(b, true);
    if (!slot.mapped && !particles_set[b]) zero(b, false);
    if (slot.rigid) list_written(b, true);
    if (!slot.mapped || particles_set[b]) list_written(b, false);
  }
#ifndef NDEBUG
  operations_.insert(operations_.begin(), Operation<Real>{&Assembly::spoil, &written_});
#endif
  drifted_.heats.clear();
  for (Force& force : forces_) {
    Operation<Real> heat;
    if (force.heat_rate != kNoRate && force.bound->heat(force.heat_rate, heat)) {
      (plan_.inertial ? operations_ : drifted_.heats).push_back(heat);
    }
  }
  if (!plan_.inertial) {
    const auto& friction = kernels::FrictionKernels.on<Real>(plan_.set);
    for (const FrictionArguments<Real>& arguments : friction_) {
      if (arguments.body.rigid) operations_.push_back({friction.mobility, &arguments});
    }
    if (plan_.ledger) {
      drift_heat_ = {dofs_, mobility_.data(), heat_of_bodies_.data(), heat_of_bodies_.size(),
                     friction_rate_};
      operations_.push_back({friction.drift_heat, &drift_heat_});
    }
    if (!drifted_.heats.empty()) {
      drifted_.velocity.assign(dofs_ + 2 * kGroup, Real(0.0));
      drifted_.mobility = system_.view.inverse_mass;
      drifted_.dofs = dofs_;
      drifted_.places.clear();
      for (const auto& arguments : rigid_) {
        drifted_.places.push_back({rigid.place[axis], &arguments});
      }
      operations_.push_back({&Assembly::heat_of_drift, &drifted_});
    }
  }
  add_point_forces(passes);
  system_.view.operations = operations_.data();
  system_.view.operation_count = operations_.size();
}

/// All that kernels which set have to set, filled with NaN before evaluations in builds with
/// assertions. Padding stays zero: a kernel that takes particles one by one never writes it.
template <class Real>
void Assembly<Real>::list_written(std::size_t body, bool centre) {
  const BodySlot<Real>& slot = bodies_[body].bound.slot;
  if (centre) {
    written_.push_back({false, slot.centre, dimension() == 1 ? 1U : 3U});
    return;
  }
  for (int d = 0; d < dimension(); ++d) {
    written_.push_back({slot.mapped, slot.offset + d * slot.stride, slot.count});
  }
}

template <class Real>
void Assembly<Real>::spoil(const void* written, const Stage<Real>& stage) {
  for (const Written& part : *static_cast<const std::vector<Written>*>(written)) {
    Real* const from = (part.mapped ? stage.mapped_force : stage.force) + part.offset;
    std::fill_n(from, part.length, Real(std::numeric_limits<double>::quiet_NaN()));
  }
}

template <class Real>
void Assembly<Real>::spoil_forces() {
  Stage<Real> stage;
  stage.force = force_.data();
  stage.mapped_force = mapped_force_.data();
  spoil(&written_, stage);
}

/// Without inertia velocities are known when all forces are: only then, what these do.
template <class Real>
void Assembly<Real>::heat_of_drift(const void* arguments, const Stage<Real>& stage) {
  const auto& drifted = *static_cast<const Drifted*>(arguments);
  for (std::size_t i = 0; i < drifted.dofs; ++i) {
    drifted.velocity[i] = stage.force[i] * drifted.mobility[i];
  }
  Stage<Real> moving = stage;
  moving.velocity = drifted.velocity.data();
  for (const Operation<Real>& place : drifted.places) place.run(place.arguments, moving);
  for (const Operation<Real>& heat : drifted.heats) heat.run(heat.arguments, moving);
}

/// A single particle on a line has kernels that pass numbers in registers.
template <class Real>
void Assembly<Real>::add_point_forces(const std::vector<Pass<Real>>& passes) {
  const SystemView<Real>& view = system_.view;
  if (dimension() != 1 || bodies_.size() != 1 || dofs_ != kGroup || own_count_ != 0 ||
      view.used_rates > kGroup || bodies_.front().bound.slot.mapped || !plan_.inertial ||
      plan_.ledger) {
    return;
  }
  for (const Pass<Real>& pass : passes) {
    for (const Force& force : forces_) {
      for (const Pass<Real>& own : force.bound->passes()) {
        if (own.arguments != pass.arguments) continue;
        PointForce<Real> point;
        if (!force.bound->point(point)) {
          point_forces_.clear();
          return;
        }
        point_forces_.push_back(point);
      }
    }
  }
  system_.view.point_forces = point_forces_.data();
  system_.view.point_force_count = point_forces_.size();
}

template <class Real>
void Assembly<Real>::steer(const void* arguments, const Stage<Real>& stage) {
  // The scratch in it belongs to this evaluation.
  auto& a = *const_cast<Steering*>(static_cast<const Steering*>(arguments));
  const double now = static_cast<double>(a.anchor) + static_cast<double>(stage.elapsed);
  const auto follow = [&](int k, Real& way, Real& speed) {
    if (a.own[k] < 0) {
      speed = a.speed[k];
      way = fma(speed, stage.elapsed, a.travel[k]);
      return;
    }
    speed = Real(a.function(k)(now)) / (k < 3 ? Real(1.0) : tau<Real>());
    stage.rates[a.own[k]] = speed;
    way = stage.own[a.own[k]];
  };
  for (int d = 0; d < a.axes; ++d) {
    Real way;
    follow(d, way, a.speeds[d]);
    a.coordinates[d] = a.start[d] + way;
  }
  if (a.planar) follow(3, a.coordinates[kRotation], a.speeds[kRotation]);
}

template <class Real>
void Assembly<Real>::declare_controls(StateLayout& layout) const {
  for (const Force& force : forces_) {
    const std::size_t count = force.bound->control_count();
    if (count > 0) layout.add_reals("control." + force.name, count);
  }
}

template <class Real>
void Assembly<Real>::attach_controls(RunState& state) {
  for (const Force& force : forces_) {
    if (force.bound->control_count() == 0) continue;
    force.bound->attach_control(state.reals("control." + force.name));
  }
}

template <class Real>
void Assembly<Real>::start_controls() {
  for (const Force& force : forces_) force.bound->start_control();
}

template <class Real>
void Assembly<Real>::start(Real* position, Real* velocity, Real* integrals,
                           const Perturbation* noise) {
  const auto is_perturbed = [&](std::size_t b) {
    return noise != nullptr &&
           std::find(noise->bodies.begin(), noise->bodies.end(), b) != noise->bodies.end();
  };
  const auto jitter = [&](std::size_t b, std::uint64_t kind, std::uint64_t k) {
    return Real(noise->size * uniform_symmetric({noise->seed, noise->stream}, {b, kind, k, 0}));
  };
  enum : std::uint64_t { kCoordinate, kShape };
  std::size_t next_rigid = 0;
  for (const Body& body : bodies_) {
    const BodySlot<Real>& slot = body.bound.slot;
    const std::size_t b = body.bound.index;
    const bool perturbed = is_perturbed(b);
    const SceneBody& from = scene().bodies[b];
    const PerParticleVector& given = from.record->common(from.description.get()).velocity;
    const auto speed = [&](std::size_t i, int d) {
      if (given.values.empty() || body.held[d]) return 0.0;
      return given.values[given.values.size() == 1 ? 0 : i].components[d];
    };
    if (slot.rigid || body.prescribed()) {
      // A rigid body's shape is disturbed too: noise on its coordinates alone dies out wherever it
      // is stable for a while, and an unstable symmetry later on would see none of it.
      AlignedVector<Real>& reference = reference_[next_rigid++];
      for (std::size_t i = 0; i < slot.count; ++i) {
        for (int d = 0; d < dimension(); ++d) {
          Real& arm = reference[d * slot.stride + i];
          arm = Real(body.arms[i][d]);
          if (perturbed && slot.rigid) arm = arm + jitter(b, kShape, i * dimension() + d);
        }
      }
    }
    if (slot.rigid) {
      // The velocity field's momentum and angular momentum, which is all that a rigid body keeps.
      for (int d = 0; d < dimension(); ++d) {
        InterleavedSum<Real> mean;
        for (std::size_t i = 0; i < slot.count; ++i) {
          mean.add(i, slot.share[i] * Real(speed(i, d)));
        }
        position[slot.centre + d] = Real(body.bound.start_centre[d]);
        velocity[slot.centre + d] = mean.total();
        if (perturbed && !body.held[d]) {
          position[slot.centre + d] = position[slot.centre + d] + jitter(b, kCoordinate, d);
        }
      }
      if (dimension() != 2) continue;
      const bool turns = inverse_mass_[slot.centre + kRotation] != Real(0.0);
      InterleavedSum<double> spin;
      for (std::size_t i = 0; i < slot.count; ++i) {
        spin.add(i, body.bound.mass[i] *
                        (body.arms[i][0] * speed(i, 1) - body.arms[i][1] * speed(i, 0)));
      }
      position[slot.centre + kRotation] = Real(0.0);
      velocity[slot.centre + kRotation] =
          body.inertia > 0.0 && !body.rotation_held
              ? Real(spin.total()) / (tau<Real>() * Real(body.inertia))
              : Real(0.0);
      if (perturbed && turns) {
        position[slot.centre + kRotation] = jitter(b, kCoordinate, kRotation) / tau<Real>();
      }
    } else if (!slot.mapped) {
      for (std::size_t i = 0; i < slot.count; ++i) {
        for (int d = 0; d < dimension(); ++d) {
          const std::size_t at = slot.offset + d * slot.stride + i;
          position[at] = Real(body.bound.start[i][d]);
          velocity[at] = Real(speed(i, d));
          if (perturbed && !body.held[d]) {
            position[at] = position[at] + jitter(b, kCoordinate, i * dimension() + d);
          }
        }
      }
    }
  }
  for (std::size_t k = 0; k < system_.view.rates; ++k) integrals[k] = Real(0.0);
  for (Force& force : forces_) {
    if (force.bound->own_count() > 0) force.bound->start_own(integrals);
  }
}

template <class Real>
void Assembly<Real>::begin_step(const DoubleDouble& time) {
  for (BoundForce<Real>* force : timed_) force->begin_step(time);
  std::size_t k = 0;
  for (Steering& steering : steering_) {
    steering.anchor = time;
    Drive& drive = prescribed_drives_[k++];
    for (int d = 0; d < 4; ++d) {
      if ((d < 3 && d >= steering.axes) || (d == 3 && !steering.planar)) continue;
      if (steering.own[d] >= 0) continue;
      const double constant = steering.function(d).constant;
      if (d == 3) {
        steering.travel[d] = from_double_double<Real>(time * constant) / tau<Real>();
        continue;
      }
      const double moved = static_cast<double>(origin_.cells[d] - plan_.origin.cells[d]);
      const DoubleDouble travel = time * constant - DoubleDouble(moved) * origin_.unit[d];
      steering.travel[d] = from_double_double<Real>(travel);
      drive.travel[d] = static_cast<double>(travel);
    }
  }
}

template <class Real>
void Assembly<Real>::rebase(const Origin& origin) {
  origin_ = origin;
  for (Force& force : forces_) force.bound->rebase(origin_);
  place_fixed();
}

template <class Real>
void Assembly<Real>::place_fixed() {
  for (const Body& body : bodies_) {
    const BodySlot<Real>& slot = body.bound.slot;
    if (!slot.mapped || slot.rigid || body.prescribed()) continue;
    const BodyGeometry& geometry = plan_.geometry[body.bound.index];
    for (int d = 0; d < dimension(); ++d) {
      const double anchor = relative_to(origin_, d, geometry.anchor[d]);
      for (std::size_t i = 0; i < slot.count; ++i) {
        mapped_position_[slot.offset + d * slot.stride + i] =
            Real(anchor + geometry.relative[i][d]);
      }
    }
  }
}

template <class Real>
double Assembly<Real>::travel_of(const Body& body, int axis) const {
  const Steering& steering = steering_[body.steering];
  if (steering.own[axis] >= 0) {
    return static_cast<double>(system_.view.integrals[steering.own[axis]]);
  }
  return static_cast<double>(steering.travel[axis]);
}

template <class Real>
double Assembly<Real>::turns_of(const Body& body) const {
  const Steering& steering = steering_[body.steering];
  return steering.planar ? static_cast<double>(steering.coordinates[kRotation]) : 0.0;
}

template <class Real>
double Assembly<Real>::speed_of(const Body& body, int axis) const {
  return static_cast<double>(steering_[body.steering].speeds[axis]);
}

template class Assembly<double>;
template class Assembly<float>;
template class Assembly<Quad>;

}  // namespace tomlin
