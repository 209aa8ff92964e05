#include "forcefields/harmonic_bonds.hpp"

#include <fmt/format.h>

#include "framework/core/force.hpp"
#include "framework/core/pair_force.hpp"

TOMLIN_DECLARE_KERNELS(HarmonicBonds)

namespace tomlin {
namespace {

using Description = HarmonicBondsDescription;

std::uint64_t pairs(const void* description, const SceneOutline& scene) {
  return count_pairs(static_cast<const Description*>(description)->pairs, scene);
}

std::vector<Complaint> complaints(const void* description, const SceneOutline& scene) {
  const auto& d = *static_cast<const Description*>(description);
  std::vector<Complaint> found;
  const std::size_t given = d.rest_lengths.numbers.size();
  const std::uint64_t due = pairs(description, scene);
  if (given > 1 && given != due) {
    found.push_back({"rest_lengths", fmt::format("{} lengths for {} pairs", given, due),
                     "\"initial\", one length for all pairs, or one each"});
  }
  for (const double length : d.rest_lengths.numbers) {
    if (length < 0.0) {
      found.push_back({"rest_lengths", "a length is negative", ">= 0"});
      break;
    }
  }
  return found;
}

/// Rest lengths in the pairs' order. The distances at the start are taken as the kernels take
/// them, so that no bond starts with a force of rounding.
template <class Real, int D>
void set_rest_lengths(const WordOrNumbers& rest, const Binding<Real>& binding,
                      std::vector<BoundPair<Real>>& pairs) {
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (rest.numbers.empty()) {
      pairs[k].datum = distance(separation_at_start<Real, D>(binding, pairs[k]));
    } else {
      pairs[k].datum = Real(rest.numbers[rest.numbers.size() == 1 ? 0 : k]);
      // On a line the kernels take either side for granted. In one place there is none: no number,
      // so that the first step fails.
      const bool coincide =
          D == 1 && separation_at_start<Real, D>(binding, pairs[k])[0] == Real(0.0);
      if (coincide && pairs[k].datum != Real(0.0)) pairs[k].datum = Real(__builtin_nan(""));
    }
  }
}

template <class Real>
std::unique_ptr<BoundForce<Real>> bind(const void* description, const Binding<Real>& binding) {
  const auto& d = *static_cast<const Description*>(description);
  BoundPairs<Real> bound = pairs_of(d.pairs, binding);
  return for_dimension<Real>(binding.dimension, [&]<int D>() -> std::unique_ptr<BoundForce<Real>> {
    set_rest_lengths<Real, D>(d.rest_lengths, binding, bound.pairs);
    return std::make_unique<PairForce<HarmonicBonds, Real, D>>(d, binding, kernels::HarmonicBonds,
                                                               std::move(bound), kRankPairs);
  });
}

}  // namespace

ForceRecord harmonic_bonds_record() {
  ForceRecord record;
  record.name = "harmonic_bonds";
  record.summary = "linear springs between the particles of a body, or of two";
  record.equation = "V = stiffness/2 * (r_ij - r0_ij)^2, each pair once";
  record.source =
      "A. Sircar and P. K. Patra, A simple generalization of Prandtl-Tomlinson model to study"
      " nanoscale rolling friction, J. Appl. Phys. 127 (2020), doi:10.48550/arXiv.1912.00232,"
      " eq. (3)";
  record.element = Element::pair;
  record.traits = {.conservative = true, .internal = true};
  record.most_bodies = 2;
  record.make_description = &make_description<Description>;
  record.parameters = {
      parameter("pairs", &Description::pairs, dimension::none,
                "which pairs are bonded: \"all\", \"neighbours\" or a list of index pairs; between "
                "two bodies \"all\" is each particle of the first with each of the second, and "
                "the first index of a pair is in the first body"),
      parameter("stiffness", &Description::stiffness, dimension::stiffness, "of each bond")
          .in(non_negative),
      parameter("rest_lengths", &Description::rest_lengths, dimension::length,
                "\"initial\", one length for all pairs, or one each")
          .one_of({"initial"})
          .by_default(WordOrNumbers{.word = "initial", .numbers = {}})};
  record.complaints = &complaints;
  record.pairs = &pairs;
  record.bind = {&bind<double>, &bind<float>, &bind<Quad>};
  record.example = R"(# Three particles on a line, stretched and let go.
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

[run]
duration = 10.0
integrator = { type = "rk4", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
