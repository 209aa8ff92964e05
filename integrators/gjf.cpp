#include "integrators/gjf.hpp"

#include "integrators/composition.hpp"
#include "integrators/langevin_kernels.hpp"

TOMLIN_DECLARE_TABLES(GjfKernels, CompositionTable)

namespace tomlin {
namespace {

struct Gjf {
  static constexpr const char* name = "gjf";
  static constexpr unsigned drifts = 1;
  static constexpr double longest = 2.0;
};

}  // namespace

IntegratorRecord gjf_record() {
  IntegratorRecord record = composition_record<Gjf, kernels::GjfKernels>();
  record.summary =
      "scheme of Gronbech-Jensen and Farago for Langevin dynamics: exact drift and diffusion";
  record.equation =
      "kick h/2, drift h/2, v <- a v + b/m sqrt(2 c T h) z, drift h/2, kick h/2; a = (1 - h c/2m) "
      "b, b = "
      "1/(1 + h c/2m)";
  record.source =
      "N. Gronbech-Jensen and O. Farago, Mol. Phys. 111 (2013) 983, "
      "doi:10.1080/00268976.2012.760055";
  record.order = 2;
  record.splits_friction = true;
  record.takes_noise = true;
  record.half_step_velocities = true;
  record.example = R"(# A particle drifts over a corrugation in a thermal bath, with long steps.
[[body]]
type = "point"
position = [0.0]
particle_mass = 1.0

[[force]]
type = "constant_force"
force = [0.5]

[[force]]
type = "langevin"
coefficient = 0.5
temperature = 0.2

[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0

[run]
duration = 100.0
integrator = { type = "gjf", dt = 5e-2 }
)";
  return record;
}

}  // namespace tomlin
