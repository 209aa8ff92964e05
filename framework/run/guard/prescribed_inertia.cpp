#include "framework/run/guard/prescribed_inertia.hpp"

#include <algorithm>
#include <cmath>

#include "framework/run/window/window.hpp"
#include "framework/scene/motion_slope.hpp"

namespace tomlin {
namespace {

bool has_inertia(const Model& model) {
  return model.system().view.inertial && model.scene().run.dynamics == Dynamics::inertial;
}

double kinetic_energy_of(const Model::Body& body, double time) {
  double square = 0.0;
  for (const TimeFunction& function : body.motion->velocity) {
    const double v = function(time);
    square = std::fma(v, v, square);
  }
  double energy = 0.5 * body.total_mass * square;
  if (body.rotates()) {
    const double spin = body.motion->angular_velocity(time);
    energy += 0.5 * body.inertia * spin * spin;
  }
  return energy;
}

}  // namespace

double prescribed_kinetic_energy(const Model& model, double time) {
  double energy = 0.0;
  if (!has_inertia(model)) return energy;
  for (const Model::Body& body : model.bodies()) {
    if (body.prescribed()) energy += kinetic_energy_of(body, time);
  }
  return energy;
}

bool is_accelerated(const Model& model, const Model::Driver& driver) {
  return has_inertia(model) &&
         std::any_of(model.bodies().begin(), model.bodies().end(), [&](const Model::Body& body) {
           return body.prescribed() && body.bound.name == driver.name && accelerates(*body.motion);
         });
}

std::vector<double> inertia_lacking(const Model& model, const Model::Driver& driver,
                                    const double* from_integrals, const double* to_integrals,
                                    double from, double to) {
  const int axes = model.dimension();
  std::vector<double> lacking(axes + 1, 0.0);
  if (!has_inertia(model)) return lacking;
  for (const Model::Body& body : model.bodies()) {
    if (!body.prescribed() || body.bound.name != driver.name || !accelerates(*body.motion))
      continue;
    const std::ptrdiff_t apart = driver.first_rate + axes + 1;
    for (int d = 0; d < axes; ++d) {
      const TimeFunction& velocity = body.motion->velocity[d];
      lacking[d] = body.total_mass * (velocity(to) - velocity(from));
    }
    lacking[axes] = kinetic_energy_of(body, to) - kinetic_energy_of(body, from);
    for (int k = 0; k <= axes; ++k) {
      lacking[k] -= to_integrals[apart + k] - from_integrals[apart + k];
    }
  }
  return lacking;
}

std::vector<double> inertia_lacking_in(const Model& model, const Model::Driver& driver,
                                       const MeasureWindow& window) {
  const MeasureWindow::Edge& from = window.from();
  const MeasureWindow::Edge& to = window.to();
  return inertia_lacking(model, driver, from.integrals, to.integrals, from.time, to.time);
}

}  // namespace tomlin
