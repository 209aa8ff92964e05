#include "integrators/blanes_moan.hpp"

#include "integrators/blanes_moan_kernels.hpp"
#include "integrators/composition.hpp"

TOMLIN_DECLARE_TABLES(BlanesMoanKernels, CompositionTable)

namespace tomlin {
namespace {

struct BlanesMoan {
  static constexpr const char* name = "blanes_moan";
  static constexpr unsigned drifts = BlanesMoanScheme::drifts;
  /// Limit of h omega: beyond it half the trace of an oscillator's step matrix leaves [-1, 1].
  static constexpr double longest = 3.163;
};

}  // namespace

IntegratorRecord blanes_moan_record() {
  IntegratorRecord record = composition_record<BlanesMoan, kernels::BlanesMoanKernels>();
  record.summary = "symplectic scheme of fourth order for scenes without friction";
  record.equation = "kick b_1 h, drift a_1 h, kick b_2 h, ..., drift a_6 h, kick b_7 h";
  record.source =
      "S. Blanes and P. C. Moan, J. Comput. Appl. Math. 142 (2002) 313, "
      "doi:10.1016/S0377-0427(01)00492-7, table 3, SRKN^b_6";
  record.order = 4;
  record.conservative_only = true;
  record.example = R"(# A particle that swings in a trough of the corrugation, for ever.
[[body]]
type = "point"
position = [0.3]
particle_mass = 1.0

[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0

[run]
duration = 100.0
ledger = true
integrator = { type = "blanes_moan", dt = 0.2 }
)";
  return record;
}

}  // namespace tomlin
