#include "forcefields/nose_hoover_chain.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include "framework/core/elements/kernel_tables.hpp"
#include "framework/core/numbers/sum.hpp"
#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/force.hpp"

TOMLIN_DECLARE_TABLES(NoseHooverChain, NoseHooverTable)

namespace tomlin {
namespace {

template <class Real>
class BoundNoseHooverChain : public BoundForce<Real>,
                             public InternalVariables<Real>,
                             public ExactFlow<Real> {
 public:
  BoundNoseHooverChain(const NoseHooverChainDescription& d, const Binding<Real>& binding)
      : table_(kernels::NoseHooverChain.on<Real>(binding.set)),
        body_(binding.bodies.front()->index) {
    const BoundBody<Real>& body = *binding.bodies.front();
    const auto axes = static_cast<std::size_t>(binding.dimension);
    arguments_.body = body.slot;
    arguments_.links = static_cast<std::size_t>(d.links);
    particle_mass_.assign(axes * body.slot.stride, Real(0.0));
    for (std::size_t axis = 0; axis < axes; ++axis) {
      std::transform(body.mass.begin(), body.mass.end(),
                     particle_mass_.begin() + static_cast<std::ptrdiff_t>(axis * body.slot.stride),
                     [](double mass) { return Real(mass); });
    }
    arguments_.first = body.slot.offset;
    arguments_.length = arguments_.particle_length = particle_mass_.size();
    arguments_.mass = arguments_.particle_mass = particle_mass_.data();
    if (body.slot.rigid) take_as_one(body, axes);
    arguments_.freedom = Real(body.freedom);
    arguments_.temperature = Real(d.temperature);
    arguments_.frequency = tau<Real>() / Real(d.period);
    series_.assign((arguments_.links + 2) * (NoseHooverChain::kTerms<Real> + 1), Real(0.0));
    arguments_.series = series_.data();
  }

  std::vector<Pass<Real>> passes() override {
    return {{table_.set, table_.add, &arguments_, {{body_, false}}, kRankPairs}};
  }

  std::size_t own_count() const override { return 2 * arguments_.links; }
  void place_own(std::size_t first) override { arguments_.own = first; }
  void start_own(Real* own) const override {
    std::fill_n(own + arguments_.own, own_count(), Real(0.0));
  }

  bool heat(std::ptrdiff_t rate, Operation<Real>& operation) override {
    heat_ = arguments_;
    heat_.heat_rate = rate;
    operation = {table_.heat, &heat_};
    return true;
  }

  bool flow(Flow<Real>& flow) override {
    flow = {table_.flow, table_.drag, &arguments_, {}};
    return true;
  }

 private:
  /// Centre and rotation, which in the plane is the third coordinate, in turns.
  void take_as_one(const BoundBody<Real>& body, std::size_t axes) {
    InterleavedSum<double> total;
    InterleavedSum<double> inertia;
    for (std::size_t i = 0; i < body.slot.count; ++i) {
      double square = 0.0;
      for (std::size_t axis = 0; axis < axes; ++axis) {
        const double arm = body.start[i][axis] - body.start_centre[axis];
        square = std::fma(arm, arm, square);
      }
      total.add(i, body.mass[i]);
      inertia.add(i, body.mass[i] * square);
    }
    mass_of_body_.assign(kGroup, Real(0.0));
    std::fill_n(mass_of_body_.begin(), axes, Real(total.total()));
    if (axes == 2) mass_of_body_[2] = tau<Real>() * tau<Real>() * Real(inertia.total());
    arguments_.first = body.slot.centre;
    arguments_.length = kGroup;
    arguments_.mass = mass_of_body_.data();
  }

  const NoseHooverTable<Real>& table_;
  std::size_t body_;
  AlignedVector<Real> particle_mass_;
  AlignedVector<Real> mass_of_body_;
  AlignedVector<Real> series_;
  NoseHooverArguments<Real> arguments_;
  NoseHooverArguments<Real> heat_;
};

template <class Real>
std::unique_ptr<BoundForce<Real>> bind_chain(const NoseHooverChainDescription& d,
                                             const Binding<Real>& binding) {
  return std::make_unique<BoundNoseHooverChain<Real>>(d, binding);
}

}  // namespace

ForceRecord nose_hoover_chain_record() {
  using Description = NoseHooverChainDescription;
  ForceRecord record = record_of<Description>();
  record.name = "nose_hoover_chain";
  record.summary = "deterministic thermostat: a Nose-Hoover chain on the velocities of a body";
  record.equation =
      "dv/dt = -zeta_1 v; Q_1 dzeta_1/dt = sum m v^2 - N T - Q_1 zeta_1 zeta_2; Q_k dzeta_k/dt = "
      "Q_(k-1) zeta_(k-1)^2 - T - Q_k zeta_k zeta_(k+1); T temperature, N free coordinates, Q_1 = "
      "N T (period/2 pi)^2, Q_k = T (period/2 pi)^2";
  record.source =
      "G. J. Martyna, M. L. Klein and M. Tuckerman, J. Chem. Phys. 97 (1992) 2635, "
      "doi:10.1063/1.463940; G. J. Martyna, M. E. Tuckerman, D. J. Tobias and M. L. Klein, Mol. "
      "Phys. 87 (1996) 1117, doi:10.1080/00268979600100761";
  record.traits.depends_on_velocity = true;
  record.thermostat = true;
  record.parameters = {
      parameter(
          "temperature", &Description::temperature, dimension::temperature,
          "of the body; in reduced units an energy: Boltzmann's constant times the temperature")
          .in(positive),
      parameter("period", &Description::period, dimension::time,
                "of the exchange of energy with the first link, 2 pi sqrt(Q_1/(N T)): about that "
                "of the vibrations that carry the energy, and some tens of steps at least")
          .in(positive),
      parameter("links", &Description::links, dimension::none,
                "of the chain; one is the thermostat of Nose and Hoover, which fails on small or "
                "stiff systems")
          .in({.low = 1.0, .high = 100.0, .low_open = false, .high_open = false})
          .by_default(std::int64_t{3})};
  record.bind = {of_description<&bind_chain<double>>, of_description<&bind_chain<Quad>>};
  record.example = R"(# A chain over a corrugation is dragged, and kept at a temperature.
[[body]]
type = "chain"
count = 10
spacing = 1.0
particle_mass = 1.0
velocity = [0.3]

[[force]]
type = "harmonic_bonds"
pairs = "neighbours"
stiffness = 2.0

[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.618

[[force]]
type = "driving_spring"
stiffness = 0.5
velocity = [0.02]

[[force]]
type = "nose_hoover_chain"
temperature = 0.05
period = 3.0

[run]
duration = 100.0
integrator = { type = "velocity_verlet", dt = 5e-2 }
)";
  return record;
}

}  // namespace tomlin
