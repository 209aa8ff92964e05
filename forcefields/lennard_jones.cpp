#include "forcefields/lennard_jones.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "framework/core/elements/cutoff_pairs.hpp"
#include "framework/core/text/located_words.hpp"
#include "framework/core/text/number_file.hpp"
#include "framework/core/text/xyz_file.hpp"

TOMLIN_DECLARE_TABLES(LennardJones, CutoffPairTable)
TOMLIN_DECLARE_TABLES(LennardJonesSmooth, CutoffPairTable)

namespace tomlin {
namespace {

template <class Real>
std::unique_ptr<BoundForce<Real>> bind(const LennardJonesDescription& d,
                                       const Binding<Real>& binding) {
  return d.at_cutoff == AtCutoff::smooth
             ? bind_within_cutoff<LennardJonesSmooth, kernels::LennardJonesSmooth, kRankPairs>(
                   d, binding)
             : bind_within_cutoff<LennardJones, kernels::LennardJones, kRankPairs>(d, binding);
}

/// An energy that jumps is none whose gradient the force is.
Traits traits_of_potential(const LennardJonesDescription& d) {
  return {.conservative = d.at_cutoff != AtCutoff::cut, .internal = true};
}

Complaint complaint_of(FaultCode code, const char* key, std::string why, std::string admissible) {
  return {.key = key, .why = std::move(why), .admissible = std::move(admissible), .code = code};
}

/// Either one pair of numbers, or entries.
std::vector<Complaint> complaints(const LennardJonesDescription& d, const SceneOutline& scene) {
  const bool epsilon = !std::isnan(d.epsilon);
  const bool sigma = !std::isnan(d.sigma);
  if (d.entries.empty()) {
    if (!epsilon || !sigma) {
      return {complaint_of(FaultCode::scene_missing_key, epsilon ? "sigma" : "epsilon", "missing",
                           "epsilon and sigma, or entries")};
    }
    if (d.mixing != Mixing::none) {
      return {complaint_of(FaultCode::scene_conflict, "mixing", "there are no entries to mix",
                           "entries, or no mixing")};
    }
    return cutoff_complaints("cutoff", d.cutoff, scene);
  }
  if (epsilon || sigma) {
    return {complaint_of(FaultCode::scene_conflict, epsilon ? "epsilon" : "sigma",
                         "the numbers are given twice", "epsilon and sigma, or entries")};
  }
  std::vector<std::string> faults;
  const std::vector<LennardJonesEntry> known = parse_lennard_jones(d.entries, faults);
  std::vector<Complaint> found;
  found.reserve(faults.size());
  for (std::string& fault : faults) {
    found.push_back(complaint_of(FaultCode::file_invalid, "entries", std::move(fault), ""));
  }
  if (!found.empty()) return found;
  for (const SceneOutline::Body* body : {&scene.bodies.front(), &scene.bodies.back()}) {
    if (!body->species.empty()) continue;
    return {
        complaint_of(FaultCode::component_unsuitable, "entries",
                     "there are numbers of species, and the body \"" + body->name + "\" has none",
                     "species in the body, or epsilon and sigma")};
  }
  for (const std::string& one : scene.bodies.front().species) {
    for (const std::string& other : scene.bodies.back().species) {
      if (lennard_jones_of(known, d.mixing, one, other)) continue;
      return {complaint_of(FaultCode::component_unsuitable, "entries",
                           fmt::format("there are no numbers for {} {}", one, other),
                           "an entry for each pair of the bodies' species, or mixing = "
                           "\"lorentz_berthelot\" and one for each pair of like species")};
    }
  }
  return cutoff_complaints("cutoff", d.cutoff, scene);
}

/// Returns the shortest sigma of entries; 0 without them, as the key sigma is a length itself.
double length_of_entries(const LennardJonesDescription& d) {
  return d.entries.empty() ? 0.0 : shortest_sigma(d);
}

}  // namespace

std::vector<LennardJonesEntry> parse_lennard_jones(std::string_view text,
                                                   std::vector<std::string>& faults) {
  constexpr std::size_t kWords = 4;
  const std::vector<LocatedWord> words = words_of_lines(text);
  const auto refuse = [&](std::size_t line, const std::string& why) {
    faults.push_back(fmt::format("entries:{}: {}", line, why));
  };
  if (words.empty()) refuse(1, "there are no entries");
  std::vector<LennardJonesEntry> entries;
  for (std::size_t first = 0; first < words.size(); first += kWords) {
    const std::size_t line = words[first].line;
    if (words.size() - first < kWords) {
      refuse(line, fmt::format("an entry has two species, epsilon and sigma; here are {} words",
                               words.size() - first));
      break;
    }
    LennardJonesEntry entry;
    for (std::size_t k = 0; k < 2; ++k) {
      const LocatedWord& species = words[first + k];
      if (!is_species_name(species.word)) {
        refuse(species.line, fmt::format("column {} is not a name of a species", species.column));
        return {};
      }
      entry.species[k] = std::string(species.word);
    }
    double* const numbers[] = {&entry.epsilon, &entry.sigma};
    for (std::size_t k = 0; k < 2; ++k) {
      const LocatedWord& number = words[first + 2 + k];
      std::string why;
      *numbers[k] = parse_number(number.word, why);
      if (why.empty() && !(k == 0 ? entry.epsilon >= 0.0 : entry.sigma > 0.0)) {
        why = k == 0 ? "is a negative epsilon" : "is no positive sigma";
      }
      if (why.empty()) continue;
      refuse(number.line, fmt::format("column {} {}", number.column, why));
      return {};
    }
    if (lennard_jones_of(entries, Mixing::none, entry.species[0], entry.species[1])) {
      refuse(line, "the same two species once more");
    }
    entries.push_back(std::move(entry));
  }
  return entries;
}

std::optional<LennardJonesEntry> lennard_jones_of(const std::vector<LennardJonesEntry>& known,
                                                  Mixing mixing, const std::string& one,
                                                  const std::string& other) {
  for (const LennardJonesEntry& entry : known) {
    const auto& [i, j] = entry.species;
    if ((i == one && j == other) || (i == other && j == one)) return entry;
  }
  if (mixing == Mixing::none || one == other) return std::nullopt;
  const auto first = lennard_jones_of(known, Mixing::none, one, one);
  const auto second = lennard_jones_of(known, Mixing::none, other, other);
  if (!first || !second) return std::nullopt;
  return LennardJonesEntry{{one, other},
                           std::sqrt(first->epsilon * second->epsilon),
                           0.5 * (first->sigma + second->sigma)};
}

std::vector<LennardJonesEntry> lennard_jones_of_all(const LennardJonesDescription& description,
                                                    const std::vector<std::string>& one,
                                                    const std::vector<std::string>& other) {
  if (description.entries.empty()) return {};
  std::vector<std::string> faults;
  const std::vector<LennardJonesEntry> known = parse_lennard_jones(description.entries, faults);
  std::vector<LennardJonesEntry> all;
  for (const std::string& i : one) {
    for (const std::string& j : other) {
      const auto pair = lennard_jones_of(known, description.mixing, i, j);
      if (pair) all.push_back(*pair);
    }
  }
  return all;
}

double shortest_sigma(const LennardJonesDescription& description) {
  if (description.entries.empty()) return description.epsilon > 0.0 ? description.sigma : 0.0;
  std::vector<std::string> faults;
  double shortest = 0.0;
  for (const LennardJonesEntry& entry : parse_lennard_jones(description.entries, faults)) {
    if (!(entry.epsilon > 0.0)) continue;
    shortest = shortest > 0.0 ? std::min(shortest, entry.sigma) : entry.sigma;
  }
  return shortest;
}

ForceRecord lennard_jones_record() {
  using Description = LennardJonesDescription;
  ForceRecord record = record_of<Description>();
  record.name = "lennard_jones";
  record.summary =
      "attraction and repulsion of all pairs within a cutoff, in a body or between two";
  record.equation =
      "V = 4 * epsilon * ((sigma/r)^12 - (sigma/r)^6) for r < cutoff, less what at_cutoff says";
  record.source =
      "J. E. Jones, Proc. R. Soc. Lond. A 106, 463 (1924), doi:10.1098/rspa.1924.0082; the shifted "
      "force: S. Toxvaerd and J. C. Dyre, J. Chem. Phys. 134, 081102 (2011), doi:10.1063/1.3558787";
  record.element = Element::pair;
  record.traits = {.conservative = true, .internal = true};
  record.traits_of = of_description<&traits_of_potential>;
  record.most_bodies = 2;
  record.complaints = of_description<&complaints>;
  record.length = of_description<&length_of_entries>;
  record.bind = {of_description<&bind<double>>, of_description<&bind<Quad>>};
  record.parameters = {
      parameter("epsilon", &Description::epsilon, dimension::energy, "depth of the well")
          .in(non_negative)
          .or_absent(),
      parameter("sigma", &Description::sigma, dimension::length,
                "where the energy passes zero; the well is at 2^(1/6) times this")
          .in(positive)
          .or_absent(),
      parameter("entries", &Description::entries, dimension::none,
                "in place of epsilon and sigma, for particles of several species: a text with two "
                "species, epsilon and sigma, in the scene's units, for each pair of species")
          .or_absent(),
      parameter("mixing", &Description::mixing, dimension::none,
                "what pairs of species without an entry have: \"none\": each has one; "
                "\"lorentz_berthelot\": the mean sigma and the geometric mean epsilon of the pairs "
                "of like species")
          .by_default(Mixing::none),
      parameter("cutoff", &Description::cutoff, dimension::length,
                "pairs further apart than this do not interact; half a periodic box allows for "
                "1.15 times this")
          .in(positive),
      parameter("at_cutoff", &Description::at_cutoff, dimension::none,
                "\"cut\": energy and force end abruptly; \"shift\": a constant makes the energy "
                "zero there; \"smooth\": a linear term makes the force zero there, too")
          .by_default(AtCutoff::smooth)};
  record.example = R"(# Seven particles in a plane, drawn together.
[[body]]
type = "flake"
shape = "hexagon"
size = 2
lattice = "hexagonal"
lattice_constant = 1.2
centre = [0.0, 0.0]
particle_mass = 1.0

[[force]]
type = "lennard_jones"
epsilon = 1.0
sigma = 1.0
cutoff = 3.0

[run]
duration = 2.0
integrator = { type = "velocity_verlet", dt = 1e-3 }
)";
  return record;
}

}  // namespace tomlin
