#include "framework/model/friction_matrix.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "framework/core/elements/kernel_tables.hpp"
#include "framework/core/numbers/random.hpp"
#include "framework/core/numbers/sum.hpp"

TOMLIN_DECLARE_TABLES(FrictionKernels, FrictionTable)

namespace tomlin {
namespace {

/// Collects the friction coefficients of particles.
class CoefficientSink : public FrictionSink {
 public:
  explicit CoefficientSink(std::vector<std::vector<double>>& coefficients)
      : coefficients_(coefficients) {}
  void site(std::size_t body, std::size_t particle, double coefficient) override {
    coefficients_[body][particle] += coefficient;
  }

 private:
  std::vector<std::vector<double>>& coefficients_;
};

bool any_positive(const std::vector<double>& coefficients) {
  return std::any_of(coefficients.begin(), coefficients.end(), [](double c) { return c > 0.0; });
}

}  // namespace

template <class Real>
void FrictionMatrix<Real>::lay(const AssemblyPlan& plan, std::vector<AssembledBody<Real>>& bodies,
                               const std::vector<AssembledForce<Real>>& forces,
                               AlignedVector<Real>& inverse_mass, SystemView<Real>& view) {
  for (const auto& body : bodies) coefficients_.emplace_back(body.bound.slot.count, 0.0);
  collect(plan, forces);
  mobility_.assign(view.dofs, Real(0.0));
  heat_of_bodies_.assign(bodies.size(), Real(0.0));
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
    if (plan.inertial && !any_positive(coefficients_[body.bound.index])) continue;
    friction_.push_back(arguments);
  }
  if (!faults_.empty()) throw InputError(std::move(faults_));
  if (!plan.inertial) return;
  const auto& table = kernels::FrictionKernels.on<Real>(plan.set);
  for (const FrictionArguments<Real>& arguments : friction_) {
    const bool one = arguments.body.rigid;
    flows_.push_back({one ? table.flow_of_body : table.flow_of_particles,
                      one ? table.drag_of_body : table.drag_of_particles,
                      &arguments,
                      {}});
  }
  view.flows = flows_.data();
  view.flow_count = flows_.size();
  view.friction_rate = rate;
}

template <class Real>
void FrictionMatrix<Real>::collect(const AssemblyPlan& plan,
                                   const std::vector<AssembledForce<Real>>& forces) {
  CoefficientSink sink(coefficients_);
  for (const AssembledForce<Real>& force : forces) {
    if (!force.is_operator) continue;
    Flow<Real> flow;
    if (plan.inertial && force.bound->flow(flow)) {
      flow.key = {static_cast<std::uint64_t>(plan.scene->run.seed), stream_of(force.name)};
      flows_.push_back(flow);
    } else {
      force.bound->friction(sink);
    }
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
    constexpr double kNothing = 1e-12;
    if (!(about_pivot > kNothing * static_cast<double>(second.total()))) {
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
AlignedVector<Real>& FrictionMatrix<Real>::new_array(std::size_t length, Real value) {
  return arrays_.emplace_back(padded(length), value);
}

template <class Real>
void FrictionMatrix<Real>::miss(const AssemblyPlan& plan, const AssembledBody<Real>& body,
                                const std::string& coordinate) {
  const RunSettings& run = plan.scene->run;
  const auto place = run.places.find("dynamics");
  faults_.emplace_back(FaultCode::matrix_singular,
                       place == run.places.end() ? run.place : place->second, "run.dynamics",
                       fmt::format("\"{}\"", to_string(Dynamics::overdamped)),
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
template class FrictionMatrix<float>;
template class FrictionMatrix<Quad>;

}  // namespace tomlin
