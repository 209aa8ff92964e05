#include "morse.hpp"

#include "framework/core/elements/pair_force.hpp"
#include "framework/plugin/plugin.hpp"

TOMLIN_DECLARE_KERNELS(Morse)

namespace tomlin {
namespace {

std::uint64_t pairs(const void* description, const SceneOutline& scene) {
  const PairSelection& selection = static_cast<const MorseDescription*>(description)->pairs;
  const auto n = static_cast<std::uint64_t>(scene.bodies.front().count);
  if (selection.kind == PairSelection::Kind::all) return n * (n - 1) / 2;
  if (selection.kind == PairSelection::Kind::list) return selection.list.size();
  return n - 1 + (scene.bodies.front().closed && n > 2 ? 1 : 0);
}

template <class Real>
std::unique_ptr<BoundForce<Real>> bind(const void* description, const Binding<Real>& binding) {
  const auto& d = *static_cast<const MorseDescription*>(description);
  BoundPairs<Real> bound = pairs_of(d.pairs, binding);
  for (BoundPair<Real>& pair : bound.pairs) pair.datum = Real(d.rest_length);
  return for_dimension<Real>(binding.dimension, [&]<int D>() -> std::unique_ptr<BoundForce<Real>> {
    return std::make_unique<PairForce<Morse, Real, D>>(d, binding, kernels::Morse, std::move(bound),
                                                       kRankTranscendental);
  });
}

}  // namespace

ForceRecord morse_record() {
  constexpr Dimension kInverseLength{.mass = 0, .length = -1, .time = 0};
  ForceRecord record;
  record.name = "morse";
  record.summary = "bonds that break";
  record.equation = "V = depth * (1 - exp(-steepness * (r_ij - rest_length)))^2, each pair once";
  record.source = "P. M. Morse, Phys. Rev. 34 (1929) 57, doi:10.1103/PhysRev.34.57";
  record.element = Element::pair;
  record.traits = {.conservative = true, .internal = true};
  record.make_description = &make_description<MorseDescription>;
  record.parameters = {
      parameter("pairs", &MorseDescription::pairs, dimension::none, "which pairs are bonded"),
      parameter("depth", &MorseDescription::depth, dimension::energy, "what it takes to break one")
          .in(non_negative),
      parameter("steepness", &MorseDescription::steepness, kInverseLength, "1 / its width")
          .in(positive),
      parameter("rest_length", &MorseDescription::rest_length, dimension::length, "of each bond")
          .in(positive)};
  record.pairs = &pairs;
  record.bind = {&bind<double>, &bind<Quad>};
  record.example = R"(# Two particles, stretched and let go.
[[body]]
type = "chain"
count = 2
spacing = 1.3
particle_mass = 1.0

[[force]]
type = "morse"
pairs = "neighbours"
depth = 2.0
steepness = 1.5
rest_length = 1.0

[run]
duration = 5.0
integrator = { type = "rk4", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin

TOMLIN_PLUGIN(registry) { registry.add(tomlin::morse_record()); }
