#include "integrators/euler_maruyama.hpp"

#include "integrators/brownian.hpp"

namespace tomlin {
namespace {

template <class Real>
std::unique_ptr<Integrator<Real>> bind(const void*, System<Real>& system) {
  return std::make_unique<Brownian<Real>>("euler_maruyama", BrownianNoise::of_the_step, system);
}

}  // namespace

IntegratorRecord euler_maruyama_record() {
  IntegratorRecord record = brownian_record(
      "euler_maruyama", IntegratorFactories{&bind<double>, &bind<float>, &bind<Quad>});
  record.summary = "scheme of Euler and Maruyama for noise without inertia, of first order";
  record.equation = "x <- x + h F/c + sqrt(2 T h/c) z";
  record.source =
      "G. Maruyama, Rend. Circ. Mat. Palermo 4 (1955) 48, doi:10.1007/BF02846028; P. E. Kloeden "
      "and E. "
      "Platen, Numerical Solution of Stochastic Differential Equations (1992), "
      "doi:10.1007/978-3-662-12616-5, section 9.1";
  record.order = 1;
  record.example = R"(# A particle without inertia drifts over a corrugation in a thermal bath.
[[body]]
type = "point"
position = [0.0]
particle_mass = 1.0

[[force]]
type = "constant_force"
force = [0.5]

[[force]]
type = "langevin"
coefficient = 1.0
temperature = 0.2

[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0

[run]
dynamics = "overdamped"
duration = 100.0
integrator = { type = "euler_maruyama", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
