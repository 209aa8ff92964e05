#include "framework/model/friction_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "framework/core/numbers/constants.hpp"
#include "framework/core/numbers/random.hpp"
#include "framework/core/numbers/sum.hpp"
#include "framework/model/friction_tables.hpp"

namespace tomlin {
namespace {

/// Collects the friction coefficients of particles, and those times temperatures.
class CoefficientSink : public FrictionSink {
 public:
  CoefficientSink(std::vector<std::vector<double>>& coefficients,
                  std::vector<std::vector<double>>& warmth)
      : coefficients_(coefficients), warmth_(warmth) {}
  void site(std::size_t body, std::size_t particle, double coefficient) override {
    coefficients_[body][particle] += coefficient;
  }
  void bath(std::size_t body, std::size_t particle, double coefficient,
            double temperature) override {
    if (!(coefficient > 0.0)) return;
    warmth_[body].resize(coefficients_[body].size(), 0.0);
    warmth_[body][particle] += coefficient * temperature;
  }

 private:
  std::vector<std::vector<double>>& coefficients_;
  std::vector<std::vector<double>>& warmth_;
};

template <class Real>
RandomKey key_of(const AssemblyPlan& plan, const AssembledForce<Real>& force) {
  const RunSettings& run = plan.scene->run;
  return {static_cast<std::uint64_t>(run.seed),
          stream_of(force.name, static_cast<std::uint64_t>(run.stream))};
}

/// Friction is centred on the centre of mass but for rounding in the number type.
template <class Real>
bool is_centred(const FrictionArguments<Real>& arguments) {
  constexpr double kRounding = 1e-12;
  const double scale = std::sqrt(static_cast<double>(arguments.second * arguments.total)) / kTau;
  return std::all_of(std::begin(arguments.moment), std::end(arguments.moment), [&](Real moment) {
    return std::abs(static_cast<double>(moment)) <= kRounding * scale;
  });
}

/// Friction of a splitting scheme that does not act at all times, by flows of its own.
template <class Real>
bool is_friction_at_times(const AssembledForce<Real>& force) {
  Flow<Real> unused;
  return force.switched != nullptr && force.is_operator && !force.exact_flow->flow(unused);
}

bool any_positive(const std::vector<double>& coefficients) {
  return std::any_of(coefficients.begin(), coefficients.end(), [](double c) { return c > 0.0; });
}

}  // namespace

template <class Real>
void FrictionMatrix<Real>::lay(const AssemblyPlan& plan, std::vector<AssembledBody<Real>>& bodies,
                               const std::vector<AssembledForce<Real>>& forces,
                               AlignedVector<Real>& inverse_mass, SystemView<Real>& view) {
  mobility_.assign(view.dofs, Real(0.0));
  heat_of_bodies_.assign(bodies.size(), Real(0.0));
  begin(bodies);
  collect(plan, forces);
  lay_bodies(plan, bodies, inverse_mass);
  std::vector<ForceSwitch<Real>*> switched(friction_.size(), nullptr);
  for (const AssembledForce<Real>& force : forces) {
    if (!is_friction_at_times(force)) continue;
    begin(bodies);
    collect(force);
    lay_bodies(plan, bodies, inverse_mass);
    switched.resize(friction_.size(), force.switched.get());
  }
  if (!faults_.empty()) throw InputError(std::move(faults_));
  if (!plan.inertial) {
    lay_noise(plan, view);
    return;
  }
  const auto& table = kernels::FrictionKernels.on<Real>(plan.set);
  view.flows_overlap = view.own_count > 0;
  for (std::size_t k = 0; k < friction_.size(); ++k) {
    const FrictionArguments<Real>& arguments = friction_[k];
    const bool one = arguments.body.rigid;
    const Flow<Real> flow = {one ? table.flow_of_body : table.flow_of_particles,
                             one ? table.drag_of_body : table.drag_of_particles, &arguments,
                             arguments.key};
    flows_.push_back(switched[k] == nullptr ? flow : switched[k]->gated(flow));
    view.flows_overlap = view.flows_overlap || switched[k] != nullptr;
  }
  view.flows = flows_.data();
  view.flow_count = flows_.size();
  view.friction_rate = rate;
}

/// Nothing has been collected.
template <class Real>
void FrictionMatrix<Real>::begin(const std::vector<AssembledBody<Real>>& bodies) {
  coefficients_.clear();
  for (const auto& body : bodies) coefficients_.emplace_back(body.bound.slot.count, 0.0);
  warmth_.assign(bodies.size(), {});
  thermostats_.assign(bodies.size(), nullptr);
}

template <class Real>
void FrictionMatrix<Real>::lay_bodies(const AssemblyPlan& plan,
                                      std::vector<AssembledBody<Real>>& bodies,
                                      AlignedVector<Real>& inverse_mass) {
  for (AssembledBody<Real>& body : bodies) {
    const BodySlot<Real>& slot = body.bound.slot;
    if (slot.mapped && !slot.rigid) continue;
    FrictionArguments<Real> arguments;
    arguments.body = slot;
    arguments.axes = plan.dimension();
    if (slot.rigid) {
      assign_rigid(plan, body, inverse_mass.data(), arguments);
    } else {
      assign_particles(plan, body, inverse_mass.data(), arguments);
    }
    if (!warmth_[body.bound.index].empty()) assign_noise(plan, body, arguments);
    if (plan.inertial && !any_positive(coefficients_[body.bound.index])) continue;
    friction_.push_back(arguments);
  }
}

template <class Real>
void FrictionMatrix<Real>::collect(const AssemblyPlan& plan,
                                   const std::vector<AssembledForce<Real>>& forces) {
  for (const AssembledForce<Real>& force : forces) {
    if (!force.is_operator || is_friction_at_times(force)) continue;
    Flow<Real> flow;
    if (plan.inertial && force.flow(flow)) {
      flow.key = key_of(plan, force);
      flows_.push_back(flow);
      continue;
    }
    collect(force);
  }
}

template <class Real>
void FrictionMatrix<Real>::collect(const AssembledForce<Real>& force) {
  CoefficientSink sink(coefficients_, warmth_);
  force.friction->friction(sink);
  for (const std::size_t b : force.bodies) {
    if (force.traits.stochastic) thermostats_[b] = &force;
  }
}

template <class Real>
void FrictionMatrix<Real>::assign_rigid(const AssemblyPlan& plan, AssembledBody<Real>& body,
                                        Real* inverse_mass, FrictionArguments<Real>& arguments) {
  const int dimension = plan.dimension();
  const BodySlot<Real>& slot = body.bound.slot;
  const std::vector<double>& coefficient = coefficients_[body.bound.index];
  InterleavedSum<Real> total;
  InterleavedSum<Real> moment[2];
  InterleavedSum<Real> second;
  for (std::size_t i = 0; i < slot.count; ++i) {
    const Real c(coefficient[i]);
    total.add(i, c);
    if (dimension != 2) continue;
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
  arguments.rotates = dimension == 2 && inverse_mass[slot.centre + kRotation] != Real(0.0);
  for (int d = 0; d < dimension; ++d) arguments.free[d] = !body.held[d];
  if (plan.inertial) return;

  const bool any = any_positive(coefficient);
  for (int d = 0; d < dimension; ++d) {
    if (arguments.free[d] && !any) miss(plan, body, kAxisNames[d]);
  }
  for (std::size_t k = 0; k < 3; ++k) inverse_mass[slot.centre + k] = Real(1.0);
  const auto total_friction = static_cast<double>(arguments.total);
  for (int d = 0; d < dimension; ++d) {
    body.response[d] = arguments.free[d] ? 1.0 / total_friction : 0.0;
  }
  if (arguments.rotates) {
    auto about_pivot = static_cast<double>(second.total());
    for (int d = 0; d < 2; ++d) {
      if (!arguments.free[1 - d]) continue;
      const auto moment_of_friction = static_cast<double>(arguments.moment[d]);
      body.pivot[d] = moment_of_friction / total_friction;
      about_pivot -= moment_of_friction * body.pivot[d];
    }
    // Friction at a single point lets the body turn freely about it.
    constexpr double kLeastRotationRatio = 1e-12;
    if (!(about_pivot > kLeastRotationRatio * static_cast<double>(second.total()))) {
      miss(plan, body, "the rotation");
    }
    body.response_of_rotation = 1.0 / about_pivot;
  }
  if (plan.ledger) arguments.heat_of_body = &heat_of_bodies_[body.bound.index];
}

template <class Real>
void FrictionMatrix<Real>::assign_particles(const AssemblyPlan& plan,
                                            const AssembledBody<Real>& body, Real* inverse_mass,
                                            FrictionArguments<Real>& arguments) {
  const BodySlot<Real>& slot = body.bound.slot;
  const std::vector<double>& coefficient = coefficients_[body.bound.index];
  arguments.length = slot.stride * plan.dimension();
  AlignedVector<Real>& array = new_array(arguments.length, Real(0.0));
  for (int d = 0; d < plan.dimension(); ++d) {
    for (std::size_t i = 0; i < slot.count; ++i) {
      const std::size_t at = d * slot.stride + i;
      if (body.held[d]) continue;
      array[at] = Real(coefficient[i]);
      if (plan.inertial) continue;
      if (!(coefficient[i] > 0.0) && faults_.size() < 5) {
        miss(plan, body, fmt::format("{} of particle {}", kAxisNames[d], i));
      }
      inverse_mass[slot.offset + at] = Real(1.0) / Real(coefficient[i]);
      mobility_[slot.offset + at] = inverse_mass[slot.offset + at];
    }
  }
  arguments.coefficient = array.data();
  arguments.inverse_mass = inverse_mass + slot.offset;
  arguments.keep = new_array(arguments.length, Real(0.0)).data();
  arguments.loss = new_array(arguments.length, Real(0.0)).data();
  arguments.known_h = new_array(kGroup, Real(-1.0)).data();
}

template <class Real>
void FrictionMatrix<Real>::assign_noise(const AssemblyPlan& plan, const AssembledBody<Real>& body,
                                        FrictionArguments<Real>& arguments) {
  const BodySlot<Real>& slot = body.bound.slot;
  const std::vector<double>& coefficient = coefficients_[body.bound.index];
  const std::vector<double>& warmth = warmth_[body.bound.index];
  const AssembledForce<Real>& thermostat = *thermostats_[body.bound.index];
  arguments.key = key_of(plan, thermostat);
  if (slot.rigid) {
    double total = 0.0;
    double friction = 0.0;
    for (std::size_t i = 0; i < slot.count; ++i) {
      total += warmth[i];
      friction += coefficient[i];
    }
    const double temperature = total / friction;
    constexpr double kTemperatureTolerance = 1e-9;  // the temperatures of a bath, but for rounding
    for (std::size_t i = 0; i < slot.count; ++i) {
      if (std::abs(warmth[i] - temperature * coefficient[i]) <= kTemperatureTolerance * total)
        continue;
      refuse_noise(thermostat, "the temperature of its friction differs between particles",
                   "one temperature on a rigid body, or coordinates = \"particles\"");
      break;
    }
    arguments.bath = Real(temperature);
    if (!plan.inertial && arguments.rotates && !is_centred(arguments)) {
      refuse_noise(thermostat,
                   "its friction is not centred on the centre of mass: without inertia the noise "
                   "would depend on the rotation",
                   "equal coefficients for equal masses, or dynamics = \"inertial\"");
    }
    arguments.normals = new_array(kGroup, Real(0.0)).data();
    return;
  }
  AlignedVector<Real>& temperature = new_array(arguments.length, Real(0.0));
  for (std::size_t at = 0; at < arguments.length; ++at) {
    const std::size_t i = at % slot.stride;
    if (i < slot.count && arguments.coefficient[at] > Real(0.0)) {
      temperature[at] = Real(warmth[i]) / Real(coefficient[i]);
    }
  }
  arguments.temperature = temperature.data();
  arguments.spread = new_array(arguments.length, Real(0.0)).data();
  arguments.normals = new_array(arguments.length, Real(0.0)).data();
  if (slot.count > 1) return;
  arguments.together = arguments.axes == 1 ? 2 * kGroup : kGroup;
  arguments.drawn = new_array(kNoiseParts * kMostDrawn, Real(0.0)).data();
  constexpr std::uint64_t kNone = ~std::uint64_t{0};
  arguments.drawn_for = drawn_for_.emplace_back(kNoiseParts, kNone).data();
}

/// Without inertia: schemes displace coordinates by noise themselves.
template <class Real>
void FrictionMatrix<Real>::lay_noise(const AssemblyPlan& plan, SystemView<Real>& view) {
  const auto& table = kernels::FrictionKernels.on<Real>(plan.set);
  AlignedVector<Real>& scale = new_array(view.dofs, Real(0.0));
  AlignedVector<Real>& friction = new_array(view.dofs, Real(0.0));
  const auto place = [&](std::size_t at, const Real& coefficient, const Real& temperature) {
    friction[at] = coefficient;
    if (temperature > Real(0.0)) scale[at] = sqrt(Real(2.0) * temperature / coefficient);
  };
  for (const FrictionArguments<Real>& arguments : friction_) {
    const BodySlot<Real>& slot = arguments.body;
    if (slot.rigid) {
      for (std::size_t d = 0; d < static_cast<std::size_t>(plan.dimension()); ++d) {
        if (arguments.free[d]) place(slot.centre + d, arguments.total, arguments.bath);
      }
      if (arguments.rotates) place(slot.centre + kRotation, arguments.second, arguments.bath);
    } else {
      for (std::size_t at = 0; at < arguments.length; ++at) {
        if (!(arguments.coefficient[at] > Real(0.0))) continue;
        place(slot.offset + at, arguments.coefficient[at],
              arguments.temperature == nullptr ? Real(0.0) : arguments.temperature[at]);
      }
    }
    if (arguments.normals != nullptr) noises_.push_back({table.fill, &arguments, arguments.key});
  }
  if (noises_.empty()) return;
  view.friction_rate = rate;
  view.noises = noises_.data();
  view.noise_count = noises_.size();
  view.noise_scale = scale.data();
  view.friction = friction.data();
}

template <class Real>
void FrictionMatrix<Real>::refuse_noise(const AssembledForce<Real>& thermostat,
                                        const std::string& why, const std::string& admissible) {
  Complaint complaint{"temperature", why, admissible};
  complaint.code = FaultCode::component_unsuitable;
  faults_.push_back(fault_of(*thermostat.given, complaint));
}

template <class Real>
AlignedVector<Real>& FrictionMatrix<Real>::new_array(std::size_t length, Real value) {
  return arrays_.emplace_back(padded(length), value);
}

template <class Real>
void FrictionMatrix<Real>::miss(const AssemblyPlan& plan, const AssembledBody<Real>& body,
                                const std::string& coordinate) {
  faults_.emplace_back(FaultCode::matrix_singular, plan.scene->run.location_of("dynamics"),
                       "run.dynamics", fmt::format("\"{}\"", to_string(Dynamics::overdamped)),
                       fmt::format("no friction on {} of body \"{}\": the friction matrix is not "
                                   "positive definite",
                                   coordinate, body.bound.name),
                       "a damper with a positive coefficient on every coordinate that moves");
}

template <class Real>
void FrictionMatrix<Real>::add_mobility(const AssemblyPlan& plan,
                                        std::vector<Operation<Real>>& operations) {
  const auto& table = kernels::FrictionKernels.on<Real>(plan.set);
  for (const FrictionArguments<Real>& arguments : friction_) {
    if (arguments.body.rigid) operations.push_back({table.mobility, &arguments});
  }
  if (!plan.ledger) return;
  drift_heat_ = {mobility_.size(), mobility_.data(), heat_of_bodies_.data(), heat_of_bodies_.size(),
                 rate};
  operations.push_back({table.drift_heat, &drift_heat_});
}

template class FrictionMatrix<double>;
template class FrictionMatrix<Quad>;

}  // namespace tomlin
