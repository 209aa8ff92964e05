#include "forcefields/nose_hoover_chain.hpp"

#include <algorithm>
#include <memory>
#include <vector>

#include "framework/core/elements/kernel_tables.hpp"
#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/force.hpp"

TOMLIN_DECLARE_TABLES(NoseHooverChain, NoseHooverTable)

namespace tomlin {
namespace {

template <class Real>
class BoundNoseHooverChain : public BoundForce<Real> {
 public:
  BoundNoseHooverChain(const NoseHooverChainDescription& d, const Binding<Real>& binding)
      : table_(kernels::NoseHooverChain.on<Real>(binding.set)),
        body_(binding.bodies.front()->index) {
    const BoundBody<Real>& body = *binding.bodies.front();
    const auto axes = static_cast<std::size_t>(binding.dimension);
    arguments_.body = body.slot;
    arguments_.length = axes * body.slot.stride;
    arguments_.links = static_cast<std::size_t>(d.links);
    mass_.assign(arguments_.length, Real(0.0));
    double freedom = 0.0;
    for (std::size_t axis = 0; axis < axes; ++axis) {
      if (body.held[axis]) continue;
      for (std::size_t i = 0; i < body.slot.count; ++i) {
        mass_[axis * body.slot.stride + i] = Real(body.mass[i]);
      }
      freedom += static_cast<double>(body.slot.count);
    }
    arguments_.mass = mass_.data();
    arguments_.freedom = Real(freedom);
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
  const NoseHooverTable<Real>& table_;
  std::size_t body_;
  AlignedVector<Real> mass_;
  AlignedVector<Real> series_;
  NoseHooverArguments<Real> arguments_;
  NoseHooverArguments<Real> heat_;
};

template <class Real>
std::unique_ptr<BoundForce<Real>> bind_chain(const NoseHooverChainDescription& d,
                                             const Binding<Real>& binding) {
  const BoundBody<Real>& body = *binding.bodies.front();
  if (body.slot.mapped) {
    Complaint complaint{"temperature",
                        "it scales the velocities of particles, and those of the body \"" +
                            body.name + "\" move as one",
                        "coordinates = \"particles\", or the force langevin"};
    complaint.code = FaultCode::component_unsuitable;
    throw BindError(std::move(complaint));
  }
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
  record.traits = {.depends_on_velocity = true, .thermostat = true};
  record.parameters = {
      parameter("temperature", &Description::temperature, dimension::energy,
                "Boltzmann's constant times the temperature of the body, an energy")
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
  record.bind = {of_description<&bind_chain<double>>, of_description<&bind_chain<float>>,
                 of_description<&bind_chain<Quad>>};
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
