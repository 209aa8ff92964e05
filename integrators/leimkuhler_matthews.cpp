#include "integrators/leimkuhler_matthews.hpp"

#include "integrators/brownian.hpp"

namespace tomlin {
namespace {

template <class Real>
std::unique_ptr<Integrator<Real>> bind(const void*, System<Real>& system) {
  return std::make_unique<Brownian<Real>>("leimkuhler_matthews", BrownianNoise::averaged, system);
}

}  // namespace

IntegratorRecord leimkuhler_matthews_record() {
  IntegratorRecord record = brownian_record(
      "leimkuhler_matthews", IntegratorFactories{&bind<double>, &bind<float>, &bind<Quad>});
  record.summary =
      "scheme of Leimkuhler and Matthews for noise without inertia, averages at rest of second "
      "order";
  record.equation = "x_n+1 = x_n + h F_n/c + sqrt(2 T h/c) (z_n + z_n+1)/2";
  record.source =
      "B. Leimkuhler and C. Matthews, Appl. Math. Res. Express 2013, 34, doi:10.1093/amrx/abs010; "
      "B. "
      "Leimkuhler, C. Matthews and M. V. Tretyakov, Proc. R. Soc. A 470 (2014) 20140120, "
      "doi:10.1098/rspa.2014.0120";
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
integrator = { type = "leimkuhler_matthews", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
