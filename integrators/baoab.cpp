#include "integrators/baoab.hpp"

#include "integrators/composition.hpp"
#include "integrators/langevin_kernels.hpp"

TOMLIN_DECLARE_TABLES(BaoabKernels, CompositionTable)

namespace tomlin {
namespace {

struct Baoab {
  static constexpr const char* name = "baoab";
  static constexpr unsigned drifts = 1;
  static constexpr double longest = 2.0;
};

}  // namespace

IntegratorRecord baoab_record() {
  IntegratorRecord record = composition_record<Baoab, kernels::BaoabKernels>();
  record.summary =
      "BAOAB splitting of Langevin dynamics: friction and noise exact, in the middle of a Verlet "
      "step";
  record.equation = "kick h/2, drift h/2, friction and noise h, drift h/2, kick h/2";
  record.source =
      "B. Leimkuhler and C. Matthews, Appl. Math. Res. Express 2013, 34, doi:10.1093/amrx/abs010";
  record.order = 2;
  record.splits_friction = true;
  record.takes_noise = true;
  record.half_step_velocities = true;
  record.drag_error = &verlet_drag_error;
  record.example = R"(# A particle drifts over a corrugation in a thermal bath.
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
integrator = { type = "baoab", dt = 5e-2 }
)";
  return record;
}

}  // namespace tomlin
