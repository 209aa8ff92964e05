#include "forcefields/tersoff.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "framework/core/elements/bond_order.hpp"
#include "framework/core/records/fetched_numbers.hpp"
#include "framework/core/text/located_words.hpp"
#include "framework/core/text/number_file.hpp"
#include "framework/core/text/xyz_file.hpp"

TOMLIN_DECLARE_TABLES(Tersoff, BondOrderTable)

namespace tomlin {
namespace {

/// A published set, in the format of a file.
struct NamedSet {
  const char* name;
  const char* source;
  const char* entries;
};

constexpr std::array<NamedSet, 3> kNamedSets = {
    {{"lindsay_broido_2010", "carbon in graphene and nanotubes, Phys. Rev. B 81, 205441 (2010)",
      "C C C  3 1 0  38049 4.3484 -0.930  0.72751 1.5724e-7 2.2119 430.0  1.95 0.15  3.4879 "
      "1393.6"},
     {"tersoff_1989_carbon", "carbon, Phys. Rev. B 39, 5566 (1989)",
      "C C C  3 1 0  38049 4.3484 -0.57058  0.72751 1.5724e-7 2.2119 346.74  1.95 0.15  3.4879 "
      "1393.6"},
     {"tersoff_1989_silicon", "silicon, Phys. Rev. B 39, 5566 (1989)",
      "Si Si Si  3 1 0  100390 16.217 -0.59825  0.78734 1.1e-6 1.7322 471.18  2.85 0.15  2.4799 "
      "1830.8"}}};

std::vector<std::string> names_of_sets() {
  std::vector<std::string> names;
  names.reserve(kNamedSets.size());
  for (const NamedSet& set : kNamedSets) names.emplace_back(set.name);
  return names;
}

std::string list_of_sets() {
  std::string list;
  for (const NamedSet& set : kNamedSets) {
    list += fmt::format("{}\"{}\" ({})", list.empty() ? "" : "; ", set.name, set.source);
  }
  return list;
}

Complaint complaint(FaultCode code, const char* key, std::string why, std::string admissible = "") {
  return {.key = key, .why = std::move(why), .admissible = std::move(admissible), .code = code};
}

/// Returns the key that gives the numbers of a description.
const char* key_of(const TersoffDescription& d) {
  if (!d.parameters.empty()) return "parameters";
  return d.read_from.empty() ? "entries" : "file";
}

/// Reads the file, and what the entries are, wherever they are from.
std::vector<Complaint> prepare(TersoffDescription& d, const std::filesystem::path& folder) {
  const int given =
      (d.parameters.empty() ? 0 : 1) + (d.file.empty() ? 0 : 1) + (d.entries.empty() ? 0 : 1);
  constexpr const char* kOneOf = "one of parameters, file and entries";
  if (given == 0) return {complaint(FaultCode::scene_missing_key, "parameters", "missing", kOneOf)};
  if (given > 1) {
    return {complaint(FaultCode::scene_conflict, d.parameters.empty() ? "file" : "parameters",
                      "the numbers are given twice", kOneOf)};
  }
  std::string text = d.entries;
  std::string name = "entries";
  for (const NamedSet& set : kNamedSets) {
    if (d.parameters == set.name) text = set.entries;
  }
  if (!d.file.empty()) {
    FetchedText fetched = fetch_text(d.file, folder, "file");
    if (!fetched.complaints.empty()) return std::move(fetched.complaints);
    d.read_from = std::move(fetched.path);
    name = d.read_from.string();
    text = std::move(fetched.text);
    d.entries = text;
    d.file.clear();
  }
  std::vector<std::string> faults;
  d.known = parse_tersoff(text, name, faults);
  std::vector<Complaint> found;
  found.reserve(faults.size());
  for (std::string& fault : faults) {
    found.push_back(complaint(FaultCode::file_invalid, key_of(d), std::move(fault)));
  }
  return found;
}

/// Returns the entries also of a description that has not been prepared: a set by its name.
std::vector<TersoffEntry> entries_of(const TersoffDescription& d) {
  if (!d.known.empty()) return d.known;
  std::vector<std::string> faults;
  for (const NamedSet& set : kNamedSets) {
    if (d.parameters == set.name) return parse_tersoff(set.entries, set.name, faults);
  }
  return {};
}

const TersoffEntry* entry_for(const std::vector<TersoffEntry>& entries,
                              const std::array<std::string, 3>& species) {
  for (const TersoffEntry& entry : entries) {
    if (entry.species == species) return &entry;
  }
  return nullptr;
}

std::string names_of_species(const std::vector<TersoffEntry>& entries) {
  std::set<std::string> all;
  for (const TersoffEntry& entry : entries) all.insert(entry.species[0]);
  std::string text;
  for (const std::string& one : all) text += (text.empty() ? "" : ", ") + one;
  return text;
}

std::vector<Complaint> complaints(const TersoffDescription& d, const SceneOutline& scene) {
  const std::vector<TersoffEntry> known = entries_of(d);
  if (known.empty()) {
    return {complaint(FaultCode::scene_missing_key, key_of(d), "there are no numbers",
                      "one of parameters, file and entries")};
  }
  if (scene.dimension != 3) {
    return {complaint(FaultCode::component_unsuitable, key_of(d),
                      "the potential is one of three dimensions", "a scene in three dimensions")};
  }
  const std::vector<std::string>& species = scene.bodies.front().species;
  const auto of_species = [&](FaultCode code, std::string why, std::string admissible) {
    Complaint found = complaint(code, "species", std::move(why), std::move(admissible));
    found.body = 0;
    return found;
  };
  std::vector<Complaint> found;
  if (species.empty()) {
    const bool of_one = known.size() == 1;
    found.push_back(
        of_species(of_one ? FaultCode::component_no_species : FaultCode::component_unsuitable,
                   fmt::format("tersoff has the numbers of {}, and the body has no species",
                               names_of_species(known)),
                   fmt::format("write species = \"{}\" in the body", known.front().species[0])));
    if (!of_one) return found;
  }
  if (!d.parameters.empty() && scene.units == UnitSystem::reduced) {
    found.push_back(complaint(FaultCode::component_other_units, "parameters",
                              "the set is in eV and Angstrom, and the scene is in reduced units",
                              "write units = \"metal\" in [scene]"));
  }
  double longest = 0.0;
  const auto include = [&](const TersoffEntry& entry) {
    longest = std::max(longest, entry.numbers.r + entry.numbers.half_width);
  };
  if (species.empty()) include(known.front());
  for (const std::string& i : species) {
    for (const std::string& j : species) {
      for (const std::string& k : species) {
        const TersoffEntry* entry = entry_for(known, {i, j, k});
        if (entry == nullptr) {
          return {of_species(
              FaultCode::component_unsuitable,
              fmt::format("tersoff has no numbers for {} {} {}, species of the body", i, j, k),
              names_of_species(known))};
        }
        include(*entry);
      }
    }
  }
  for (Complaint& one : cutoff_complaints(key_of(d), longest, scene, &outer_list)) {
    found.push_back(std::move(one));
  }
  return found;
}

/// Decay of the repulsion.
double shortest_length(const TersoffDescription& d) {
  double largest = 0.0;
  for (const TersoffEntry& entry : entries_of(d))
    largest = std::max(largest, entry.numbers.lambda1);
  return largest > 0.0 ? 1.0 / largest : 0.0;
}

const std::filesystem::path& path_of(const TersoffDescription& d) { return d.read_from; }

/// Why there is no such potential; empty where there is.
std::string why_unsuitable(const TersoffEntry& entry) {
  const TersoffNumbers& p = entry.numbers;
  if (p.m != 1.0 && p.m != 3.0) return "m is neither 1 nor 3";
  if (!(p.d > 0.0)) return "d is not positive";
  if (entry.of_bond() && p.n == 0.0) return "n is not positive";
  if (!(p.n >= 0.0)) return "n is negative";
  if (!(p.beta >= 0.0)) return "beta is negative";
  if (!(p.gamma >= 0.0)) return "gamma is negative";
  if (!(p.half_width > 0.0)) return "D is not positive";
  if (!(p.r >= p.half_width)) return "R is less than D";
  if (!(p.lambda1 >= 0.0 && p.lambda2 >= 0.0)) return "lambda1 or lambda2 is negative";
  if (!(p.a >= 0.0 && p.b >= 0.0)) return "A or B is negative";
  return "";
}

}  // namespace

std::vector<TersoffEntry> parse_tersoff(std::string_view text, const std::string& name,
                                        std::vector<std::string>& faults) {
  constexpr std::array kNumbers = {
      &TersoffNumbers::m,       &TersoffNumbers::gamma, &TersoffNumbers::lambda3,
      &TersoffNumbers::c,       &TersoffNumbers::d,     &TersoffNumbers::cos_theta0,
      &TersoffNumbers::n,       &TersoffNumbers::beta,  &TersoffNumbers::lambda2,
      &TersoffNumbers::b,       &TersoffNumbers::r,     &TersoffNumbers::half_width,
      &TersoffNumbers::lambda1, &TersoffNumbers::a};
  constexpr std::size_t kWords = 3 + kNumbers.size();
  const std::vector<LocatedWord> words = words_of_lines(text);
  const auto refuse = [&](std::size_t line, const std::string& why) {
    faults.push_back(fmt::format("{}:{}: {}", name, line, why));
  };
  std::vector<TersoffEntry> entries;
  if (words.empty()) refuse(1, "there are no entries");
  for (std::size_t first = 0; first < words.size(); first += kWords) {
    const std::size_t line = words[first].line;
    if (words.size() - first < kWords) {
      refuse(line, fmt::format("an entry has {} words, three species and {} numbers; here are {}",
                               kWords, kNumbers.size(), words.size() - first));
      break;
    }
    TersoffEntry entry;
    for (std::size_t k = 0; k < 3; ++k) {
      const LocatedWord& species = words[first + k];
      if (!is_species_name(species.word)) {
        refuse(species.line, fmt::format("column {} is not a name of a species", species.column));
        return {};
      }
      entry.species[k] = std::string(species.word);
    }
    for (std::size_t k = 0; k < kNumbers.size(); ++k) {
      const LocatedWord& word = words[first + 3 + k];
      std::string why;
      entry.numbers.*kNumbers[k] = parse_number(word.word, why);
      if (why.empty()) continue;
      refuse(word.line, fmt::format("column {} {}", word.column, why));
      return {};
    }
    if (const std::string why = why_unsuitable(entry); !why.empty()) refuse(line, why);
    for (const TersoffEntry& before : entries) {
      if (before.species == entry.species) refuse(line, "the same three species once more");
    }
    entries.push_back(std::move(entry));
  }
  return entries;
}

std::vector<TersoffNumbers> numbers_of(const TersoffDescription& description,
                                       const std::vector<std::string>& species) {
  const std::vector<TersoffEntry> known = entries_of(description);
  if (known.empty()) return {};
  if (species.empty()) return {known.front().numbers};
  std::vector<TersoffNumbers> all;
  for (const std::string& i : species) {
    for (const std::string& j : species) {
      for (const std::string& k : species) {
        const TersoffEntry* entry = entry_for(known, {i, j, k});
        if (entry == nullptr) return {};
        all.push_back(entry->numbers);
      }
    }
  }
  return all;
}

ForceRecord tersoff_record() {
  using Description = TersoffDescription;
  ForceRecord record = record_of<Description>();
  record.name = "tersoff";
  record.summary = "covalent bonds whose strength depends on their surroundings, by Tersoff";
  record.equation =
      "V = 1/2 sum_ij f_C(r_ij) (A exp(-lambda1 r_ij) - b_ij B exp(-lambda2 r_ij)), b_ij = (1 + "
      "(beta zeta_ij)^n)^(-1/(2 n))";
  record.source =
      "J. Tersoff, Phys. Rev. B 39, 5566 (1989), doi:10.1103/PhysRevB.39.5566, eqs. (1) and (2); "
      "L. Lindsay and D. A. Broido, Phys. Rev. B 81, 205441 (2010), "
      "doi:10.1103/PhysRevB.81.205441";
  record.element = Element::surroundings;
  record.traits = {.conservative = true, .internal = true};
  record.complaints = of_description<&complaints>;
  record.bind = on_bond_orders<Tersoff, kernels::Tersoff>();
  record.prepare = of_description<&prepare>;
  record.read_from = of_description<&path_of>;
  record.length = of_description<&shortest_length>;
  record.parameters = {
      parameter("parameters", &Description::parameters, dimension::none,
                "name of a published set, in eV and Angstrom: " + list_of_sets())
          .one_of(names_of_sets())
          .or_absent(),
      parameter(
          "file", &Description::file, dimension::none,
          "in place of a name: a file in the format of LAMMPS, in the scene's units: three "
          "species and m, gamma, lambda3, c, d, cos(theta_0), n, beta, lambda2, B, R, D, "
          "lambda1, A, for each triple of the body's species; n, beta, lambda2, B, lambda1 and A "
          "count where the second and the third are the same")
          .or_absent(),
      parameter("entries", &Description::entries, dimension::none, "in place of a file: its text")
          .or_absent()};
  record.example = R"(# A triangle of carbon, released from a stretched state.
[scene]
units = "metal"

[[body]]
type = "particles"
positions = [[0.0, 0.0, 0.0], [1.6, 0.0, 0.0], [0.8, 1.3856406460551018, 0.0]]
species = "C"
particle_mass = 12.011

[[force]]
type = "tersoff"
parameters = "lindsay_broido_2010"

[run]
duration = 0.1
integrator = { type = "velocity_verlet", dt = 2e-4 }
)";
  return record;
}

}  // namespace tomlin
