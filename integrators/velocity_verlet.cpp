#include "integrators/velocity_verlet.hpp"

#include "integrators/composition.hpp"
#include "integrators/velocity_verlet_kernels.hpp"

TOMLIN_DECLARE_TABLES(VelocityVerletKernels, CompositionTable)

namespace tomlin {
namespace {

struct VelocityVerlet {
  static constexpr const char* name = "velocity_verlet";
  static constexpr unsigned drifts = 1;
  static constexpr double longest = 2.0;
};

}  // namespace

IntegratorRecord velocity_verlet_record() {
  IntegratorRecord record = composition_record<VelocityVerlet, kernels::VelocityVerletKernels>();
  record.summary = "velocity Verlet scheme of second order with the exact flow of friction";
  record.equation = "friction h/2, kick h/2, drift h, kick h/2, friction h/2";
  record.source =
      "W. C. Swope, H. C. Andersen, P. H. Berens and K. R. Wilson, J. Chem. Phys. 76 (1982) "
      "637, doi:10.1063/1.442716; R. I. McLachlan and G. R. W. Quispel, Acta Numerica 11 "
      "(2002) 341, doi:10.1017/S0962492902000053, friction by splitting";
  record.order = 2;
  record.splits_friction = true;
  record.takes_noise = true;
  record.drag_error = &verlet_drag_error;
  record.example = R"(# A chain of three, stretched and let go.
[[body]]
type = "chain"
count = 3
spacing = 1.1
particle_mass = 1.0

[[force]]
type = "harmonic_bonds"
pairs = "neighbours"
stiffness = 4.0
rest_lengths = 1.0

[[force]]
type = "viscous_damping"
coefficient = 0.1

[run]
duration = 10.0
integrator = { type = "velocity_verlet", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
