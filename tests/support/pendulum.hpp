#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/order.hpp"
#include "tests/support/scenes.hpp"

/// Energies of symplectic schemes: they swing with a power of the step and come back.
namespace tomlin::test {

/// An anharmonic oscillator without friction.
inline std::string pendulum(const std::string& integrator) {
  return tables(R"([[body]] | type = "point" | position = [0.3] | velocity = [0.1]
particle_mass = 1.0
[[force]] | type = "sinusoidal_substrate" | amplitude = 0.5 | period = 6.283185307179586
[[force]] | name = "driver" | type = "driving_spring" | stiffness = 1.0 | velocity = [0.0]
start = [0.0]
[run] | duration = 1e9 | integrator = )") +
         integrator + "\n";
}

inline double energy_of(Engine& engine) {
  Model& model = engine.model();
  const SystemView<double>& view = model.system().view;
  return model.kinetic_energy(view.position, view.velocity) +
         model.potential_energy(DoubleDouble(engine.time()), view.position, view.velocity,
                                view.integrals);
}

/// The largest deviation of the energy from `start` over so many steps, looked at often.
inline double swing(Engine& engine, double start, int looks, std::uint64_t every) {
  double largest = 0.0;
  for (int k = 0; k < looks; ++k) {
    engine.advance(every);
    largest = std::max(largest, std::abs(energy_of(engine) - start));
  }
  return largest;
}

/// Swings of the energy at the start of a run and after so many steps.
struct Swings {
  Swings(const std::string& integrator, std::uint64_t steps) {
    Engine engine(scene_of(pendulum(integrator)), {});
    start = energy_of(engine);
    early = swing(engine, start, 1000, 7);
    engine.advance(steps);
    late = swing(engine, start, 1000, 7);
  }
  double start, early, late;
};

/// The power of the step, from `longest` down in halves, with which the energy swings.
inline double power_of_swings(const std::string& scheme, double longest, double shortest) {
  std::vector<double> steps, swings;
  for (double h = longest; h > shortest; h *= 0.5) {
    Engine engine(scene_of(pendulum(held_to(scheme, h))), {});
    const double start = energy_of(engine);
    steps.push_back(h);
    swings.push_back(swing(engine, start, static_cast<int>(400.0 / h), 1));
  }
  return fitted_order(steps, swings);
}

}  // namespace tomlin::test
