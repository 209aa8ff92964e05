#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "forcefields/constant_force.hpp"
#include "forcefields/driving_spring.hpp"
#include "forcefields/harmonic_bonds.hpp"
#include "forcefields/lennard_jones.hpp"
#include "forcefields/morse_bonds.hpp"
#include "forcefields/sinusoidal_substrate.hpp"
#include "forcefields/tersoff.hpp"
#include "forcefields/viscous_damping.hpp"
#include "framework/core/elements/bonds.hpp"
#include "framework/core/text/axis_names.hpp"
#include "framework/lammps/lammps_terms.hpp"

/// Forces in terms of LAMMPS. Its own conventions: a bond's K is half a stiffness; `fix
/// addforce` with atom-style variables adds any force that is a formula of the coordinates, and its
/// energy.
namespace tomlin {
namespace {

template <class Description>
const Description& given(const SceneForce& force) {
  return *static_cast<const Description*>(force.description.get());
}

void refuse(const SceneForce& force, const std::string& key, const std::string& value,
            const std::string& why, const std::string& admissible, LammpsTerms& terms) {
  terms.faults.emplace_back(FaultCode::component_unsuitable, force.location_of(key),
                            "force." + force.name + "." + key, value, why, admissible);
}

/// "force2": of fixes and variables.
std::string id_of(const SceneForce& force, const LammpsTerms& terms) {
  const auto& forces = terms.model.scene().forces;
  return fmt::format("force{}", &force - forces.data() + 1);
}

std::string title_of(const SceneForce& force) {
  const std::string& type = force.record->name;
  return lammps_comment(force.name == type ? type : force.name + " (" + type + ")");
}

std::string n(double number) { return lammps_number(number); }

/// A number within a formula.
std::string in_formula(double number) { return number < 0.0 ? "(" + n(number) + ")" : n(number); }

// ---- between pairs

void add_lennard_jones(const SceneForce& force, LammpsTerms& terms) {
  const auto& d = given<LennardJonesDescription>(force);
  const auto& [low, high] = std::minmax(force.bodies.front(), force.bodies.back());
  LammpsPairs pairs;
  pairs.style = d.at_cutoff == AtCutoff::smooth ? "lj/smooth/linear" : "lj/cut";
  pairs.arguments = n(d.cutoff);
  if (d.at_cutoff == AtCutoff::shift) pairs.modify = "shift yes";
  const auto coefficients = [&d](double epsilon, double sigma) {
    return fmt::format("{} {} {}", n(epsilon), n(sigma), n(d.cutoff));
  };
  const LammpsAtoms::Body& one = terms.atoms.bodies[low];
  const LammpsAtoms::Body& other = terms.atoms.bodies[high];
  if (d.entries.empty()) {
    pairs.coefficients.push_back(
        {one.range() + " " + other.range(), coefficients(d.epsilon, d.sigma)});
  } else {
    // A line for each pair of types, of which LAMMPS wants the lower number first.
    for (std::size_t i = 0; i < one.types.size(); ++i) {
      for (std::size_t j = low == high ? i : 0; j < other.types.size(); ++j) {
        const auto pair =
            lennard_jones_of_all(d, {one.types[i].species}, {other.types[j].species}).at(0);
        pairs.coefficients.push_back(
            {fmt::format("{} {}", one.first_type + i, other.first_type + j),
             coefficients(pair.epsilon, pair.sigma)});
      }
    }
  }
  pairs.cutoff = d.cutoff;
  pairs.bodies = {low, high};
  pairs.comment = fmt::format("{}, at the cutoff: {}", title_of(force), to_string(d.at_cutoff));
  terms.pairs.push_back(std::move(pairs));
}

/// A species as a file of LAMMPS names it, where NULL stands for none.
std::string element_of(const std::string& species) { return species == "NULL" ? "NULL_" : species; }

std::string tersoff_file(const SceneForce& force, bool has_species) {
  const auto& d = given<TersoffDescription>(force);
  std::string text =
      "# " + title_of(force) + (d.parameters.empty() ? "" : ", " + lammps_comment(d.parameters)) +
      "\n# three species, m, gamma, lambda3, c, d, cos theta0, n, beta, lambda2, B, R, D, lambda1, "
      "A\n";
  for (const TersoffEntry& entry : d.known) {
    for (std::size_t k = 0; k < 3; ++k) {
      text += element_of(entry.species[has_species ? k : 0]) + " ";
    }
    const TersoffNumbers& p = entry.numbers;
    const std::array numbers = {p.m,    p.gamma,   p.lambda3, p.c, p.d,          p.cos_theta0, p.n,
                                p.beta, p.lambda2, p.b,       p.r, p.half_width, p.lambda1,    p.a};
    text += fmt::format("{}\n", fmt::join(numbers, " "));
  }
  return text;
}

/// LAMMPS takes the repulsion of two species from one of their two entries, which depends on the
/// numbers of the atoms; here each has half of it. Returns the species where they differ.
std::optional<std::string> unlike_repulsion(const TersoffDescription& d) {
  for (const TersoffEntry& one : d.known) {
    for (const TersoffEntry& other : d.known) {
      const auto& [i, j, k] = one.species;
      const TersoffNumbers& p = one.numbers;
      const TersoffNumbers& q = other.numbers;
      if (j != k || other.species != std::array{j, i, i}) continue;
      if (p.a == q.a && p.lambda1 == q.lambda1 && p.r == q.r && p.half_width == q.half_width) {
        continue;
      }
      return fmt::format("{} {} {} and {} {} {}", i, j, k, j, i, i);
    }
  }
  return std::nullopt;
}

/// Particles without species have the one entry that there is.
void add_tersoff(const SceneForce& force, LammpsTerms& terms) {
  const auto& d = given<TersoffDescription>(force);
  if (const auto unlike = unlike_repulsion(d)) {
    refuse(force, d.read_from.empty() ? "entries" : "file", "",
           "A, lambda1, R or D of " + *unlike +
               " differ, and LAMMPS takes the repulsion from one "
               "of the two",
           "the same numbers in both entries", terms);
    return;
  }
  const std::size_t body = force.bodies.front();
  const bool has_species = !terms.atoms.bodies[body].types.front().species.empty();
  LammpsPairs pairs;
  pairs.style = "tersoff";
  std::string file_and_elements = id_of(force, terms) + ".tersoff";
  terms.files.push_back({file_and_elements, tersoff_file(force, has_species)});
  for (std::size_t b = 0; b < terms.atoms.bodies.size(); ++b) {
    for (const LammpsAtoms::Type& type : terms.atoms.bodies[b].types) {
      const std::string& species = has_species ? type.species : d.known.front().species[0];
      file_and_elements += " " + (b == body ? element_of(species) : "NULL");
    }
  }
  pairs.coefficients.push_back({"* *", std::move(file_and_elements)});
  for (const TersoffEntry& entry : d.known) {
    pairs.cutoff = std::max(pairs.cutoff, entry.numbers.r + entry.numbers.half_width);
  }
  pairs.bodies = {body, body};
  pairs.comment = title_of(force);
  terms.pairs.push_back(std::move(pairs));
}

// ---- bonds

std::vector<BoundPair<double>> bonded_pairs_of(const PairSelection& selection,
                                               const WordOrNumbers& rest, const SceneForce& force,
                                               const Model& model) {
  Binding<double> binding;
  binding.dimension = model.dimension();
  binding.box = model.plan().box;
  for (const std::size_t b : force.bodies) binding.bodies.push_back(&model.bodies()[b].bound);
  auto pairs = pairs_of(selection, binding, PairImages::kept).pairs;
  if (model.dimension() == 1) set_rest_lengths<double, 1>(rest, binding, pairs);
  if (model.dimension() == 2) set_rest_lengths<double, 2>(rest, binding, pairs);
  if (model.dimension() == 3) set_rest_lengths<double, 3>(rest, binding, pairs);
  return pairs;
}

/// LAMMPS takes the nearest image of a bond's other end: it has to be the bond's own.
bool is_nearest(const BoundPair<double>& pair, const SceneForce& force, const Model& model,
                double& length) {
  const auto& box = model.plan().box;
  double squares = 0.0;
  bool nearest = true;
  for (int d = 0; d < model.dimension(); ++d) {
    const double apart = model.bodies()[force.bodies.back()].bound.start[pair.j][d] -
                         model.bodies()[force.bodies.front()].bound.start[pair.i][d] +
                         pair.image[d];
    squares += apart * apart;
    nearest = nearest && !(box[d] > 0.0 && std::abs(apart) >= 0.5 * box[d]);
  }
  length = std::sqrt(squares);
  return nearest;
}

template <class Description, class Coefficients>
void add_bonds(const SceneForce& force, const std::string& style, LammpsTerms& terms,
               Coefficients coefficients) {
  const auto& d = given<Description>(force);
  const auto& first = terms.atoms.bodies[force.bodies.front()];
  const auto& second = terms.atoms.bodies[force.bodies.back()];
  std::unordered_map<std::string, std::size_t> known;  // types by their coefficients
  for (const auto& pair : bonded_pairs_of(d.pairs, d.rest_lengths, force, terms.model)) {
    double length = 0.0;
    if (!is_nearest(pair, force, terms.model, length)) {
      refuse(force, "pairs", "",
             fmt::format("the bond of particles {} and {} is half the box or longer: LAMMPS would "
                         "take a nearer image",
                         pair.i, pair.j),
             "a longer box, or shorter bonds", terms);
      return;
    }
    if (!std::isfinite(pair.datum)) {
      refuse(force, "rest_lengths", "", fmt::format("particles {} and {} coincide", pair.i, pair.j),
             "", terms);
      return;
    }
    terms.longest_bond = std::max({terms.longest_bond, length, pair.datum});
    const LammpsBondType type{style, coefficients(d, pair.datum)};
    const auto [found, is_new] = known.try_emplace(type.coefficients, terms.bond_types.size() + 1);
    if (is_new) terms.bond_types.push_back(type);
    terms.bonds.push_back({found->second, {first.first_atom + pair.i, second.first_atom + pair.j}});
  }
}

void add_harmonic_bonds(const SceneForce& force, LammpsTerms& terms) {
  add_bonds<HarmonicBondsDescription>(force, "harmonic", terms, [](const auto& d, double length) {
    return fmt::format("{} {}", n(0.5 * d.stiffness), n(length));
  });
}

void add_morse_bonds(const SceneForce& force, LammpsTerms& terms) {
  add_bonds<MorseBondsDescription>(force, "morse", terms, [](const auto& d, double length) {
    return fmt::format("{} {} {}", n(d.depth), n(d.inverse_width), n(length));
  });
}

// ---- on particles

/// Formulas of the force on each particle of a body, per axis (empty: none), and of its energy.
void add_formulas(const SceneForce& force, std::array<std::string, 3> components,
                  const std::string& energy, LammpsTerms& terms) {
  const std::string id = id_of(force, terms);
  std::string arguments;
  for (int axis = 0; axis < 3; ++axis) {
    if (components[axis].empty()) {
      arguments += " 0.0";
      continue;
    }
    const std::string name = id + kAxisNames[axis];
    terms.commands.push_back(fmt::format("variable {} atom \"{}\"", name, components[axis]));
    arguments += " v_" + name;
  }
  terms.commands.push_back(fmt::format("variable {}e atom \"{}\"", id, energy));
  terms.commands.push_back(fmt::format("fix {} {} addforce{} energy v_{}e", id,
                                       lammps_group(force.bodies.front()), arguments, id));
  terms.commands.push_back(fmt::format("fix_modify {} energy yes", id));
}

void add_constant_force(const SceneForce& force, LammpsTerms& terms) {
  const std::string id = id_of(force, terms);
  std::vector<double> components = given<ConstantForceDescription>(force).force.components;
  components.resize(3, 0.0);
  terms.commands.push_back("# " + title_of(force) + ", on each particle");
  terms.commands.push_back(fmt::format("fix {} {} addforce {} {} {}", id,
                                       lammps_group(force.bodies.front()), n(components[0]),
                                       n(components[1]), n(components[2])));
  terms.commands.push_back(fmt::format("fix_modify {} energy yes", id));
}

void add_sinusoidal_substrate(const SceneForce& force, LammpsTerms& terms) {
  const auto& d = given<SinusoidalSubstrateDescription>(force);
  const bool decays = d.decay != 0.0 && terms.model.dimension() > 1;
  const std::string turns = fmt::format("2.0*PI*({}-{})/{}", lammps_coordinate(terms, 0),
                                        in_formula(d.offset), in_formula(d.period));
  const std::string y = lammps_coordinate(terms, 1);
  const std::string height =
      decays ? fmt::format("exp(-{}*{}*{})*", in_formula(d.decay), y, y) : "";
  std::array<std::string, 3> formulas;
  formulas[0] = fmt::format("{}2.0*PI*{}/{}*sin({})", height, in_formula(d.amplitude),
                            in_formula(d.period), turns);
  if (decays) {
    formulas[1] = fmt::format("{}2.0*{}*{}*{}*cos({})", height, in_formula(d.decay), y,
                              in_formula(d.amplitude), turns);
  }
  terms.commands.push_back("# " + title_of(force) + ", on each particle");
  add_formulas(force, formulas, fmt::format("{}{}*cos({})", height, in_formula(d.amplitude), turns),
               terms);
}

/// The spring's whole force is printed, per axis.
void add_driving_spring(const SceneForce& force, LammpsTerms& terms) {
  const auto& d = given<DrivingSpringDescription>(force);
  if (!d.reverse.when.empty()) {
    refuse(force, "reverse", "",
           "LAMMPS has no driver that reverses when an observable passes a "
           "value",
           "a driver without it", terms);
    return;
  }
  const std::string id = id_of(force, terms);
  const std::size_t body = force.bodies.front();
  const std::string group = lammps_group(body);
  const Model::Body& bound = terms.model.bodies()[body];
  const bool each = d.attach.kind == Attachment::Kind::each_particle;
  const bool centre = d.attach.kind == Attachment::Kind::centre_of_mass;
  const std::size_t atom =
      terms.atoms.bodies[body].first_atom + (d.attach.kind == Attachment::Kind::particle
                                                 ? static_cast<std::size_t>(d.attach.particle)
                                                 : 0);
  terms.commands.push_back(
      fmt::format("# {}, on {}: k*(start + velocity*time - x) along each axis", title_of(force),
                  centre ? "the centre of mass, shared among the particles by mass"
                  : each ? "each particle"
                         : fmt::format("atom {}", atom)));
  const std::string share = centre ? fmt::format("mass/mass({})*", group)
                            : each ? ""
                                   : fmt::format("(id=={})*", atom);
  std::array<std::string, 3> formulas;
  std::string energy;
  terms.uses_time = true;
  for (int axis = 0; axis < terms.model.dimension(); ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    const double stiffness = stiffness_on(d, axis);
    if (!(stiffness > 0.0)) continue;
    const char* const name = kAxisNames[axis];
    std::string end;
    if (!d.start.components.empty()) {
      end = in_formula(d.start.components[k]);
    } else if (each) {
      end = lammps_start(terms, axis);
    } else {
      const std::size_t particle = atom - terms.atoms.bodies[body].first_atom;
      end = in_formula(static_cast<double>(terms.model.placed(
          axis, centre ? bound.bound.start_centre[k] : bound.bound.start[particle][k])));
    }
    const std::string at =
        centre ? fmt::format("xcm({},{})", group, name) : lammps_coordinate(terms, axis);
    std::string extension =
        fmt::format("({}+{}*v_time-{})", end, in_formula(d.velocity.components[k]), at);
    if (centre) {
      const std::string whole = id + "_" + name;
      terms.commands.push_back(
          fmt::format("variable {} equal \"{}*{}\"", whole, in_formula(stiffness), extension));
      terms.columns.push_back("v_" + whole);
      formulas[k] = fmt::format("{}v_{}", share, whole);
      extension = fmt::format("v_{}/{}", whole, in_formula(stiffness));
    } else {
      formulas[k] = fmt::format("{}{}*{}", share, in_formula(stiffness), extension);
    }
    energy += fmt::format("{}{}*({})^2", energy.empty() ? "" : "+", in_formula(0.5 * stiffness),
                          extension);
  }
  add_formulas(force, formulas, fmt::format("{}({})", share, energy), terms);
  for (int axis = 0; axis < 3 && !centre; ++axis) {
    if (formulas[static_cast<std::size_t>(axis)].empty()) continue;
    const std::string whole = id + "_" + kAxisNames[axis];
    terms.commands.push_back(
        fmt::format("compute {} {} reduce sum v_{}{}", whole, group, id, kAxisNames[axis]));
    terms.columns.push_back("c_" + whole);
  }
}

/// `fix viscous`, or with noise `fix langevin`.
void add_damping(const SceneForce& force, LammpsTerms& terms) {
  const auto& d = given<ViscousDampingDescription>(force);
  const std::string id = id_of(force, terms);
  const std::string group = lammps_group(force.bodies.front());
  const auto& atoms = terms.atoms.bodies[force.bodies.front()];
  if (!(d.temperature > 0.0) || !(d.coefficient > 0.0)) {
    terms.commands.push_back(
        "# " + title_of(force) +
        ": -c*v. (LAMMPS takes v at the middle of a step: of first order in the step.)");
    terms.commands.push_back(fmt::format("fix {} {} viscous {}", id, group, n(d.coefficient)));
    return;
  }
  const double temperature = d.temperature / terms.units.temperature;
  constexpr std::int64_t kLargestSeed = 900000000;  // that LAMMPS takes
  const std::int64_t seed =
      1 + ((terms.model.scene().run.seed % kLargestSeed) + kLargestSeed) % kLargestSeed;
  // Its friction is mass/damp for each mass; "scale" makes one coefficient of them.
  std::string scales;
  const double first_mass = atoms.types.front().mass;
  for (std::size_t k = 1; k < atoms.types.size(); ++k) {
    scales +=
        fmt::format(" scale {} {}", atoms.first_type + k, n(atoms.types[k].mass / first_mass));
  }
  terms.commands.push_back("# " + title_of(force) +
                           ": friction of the same coefficient, and noise of the same temperature "
                           "with other random numbers");
  terms.commands.push_back(fmt::format("fix {} {} langevin {} {} {} {}{}", id, group,
                                       n(temperature), n(temperature),
                                       n(first_mass / d.coefficient), seed, scales));
}

struct LammpsTranslation {
  const char* force;
  void (*add)(const SceneForce& force, LammpsTerms& terms);
};

constexpr std::array kTranslations = {
    LammpsTranslation{"lennard_jones", &add_lennard_jones},
    LammpsTranslation{"tersoff", &add_tersoff},
    LammpsTranslation{"harmonic_bonds", &add_harmonic_bonds},
    LammpsTranslation{"morse_bonds", &add_morse_bonds},
    LammpsTranslation{"viscous_damping", &add_damping},
    LammpsTranslation{"langevin", &add_damping},
    LammpsTranslation{"constant_force", &add_constant_force},
    LammpsTranslation{"driving_spring", &add_driving_spring},
    LammpsTranslation{"sinusoidal_substrate", &add_sinusoidal_substrate},
};

}  // namespace

void add_lammps_force(const SceneForce& force, LammpsTerms& terms) {
  for (const Variation& variation : force.variations) {
    refuse(force, variation.row->key, "", "differs between particles, which LAMMPS does not know",
           "one value for all", terms);
  }
  if (!force.variations.empty()) return;
  if (force.active) {
    refuse(force, "active", "", "acts between two times, which the input for one run does not say",
           "forces that act at all times", terms);
    return;
  }
  const auto* const found =
      std::find_if(kTranslations.begin(), kTranslations.end(), [&force](const auto& one) {
        return force.record->library.empty() && force.record->name == one.force;
      });
  if (found == kTranslations.end()) {
    std::vector<const char*> translated;
    for (const LammpsTranslation& one : kTranslations) translated.push_back(one.force);
    refuse(force, "type", "\"" + force.record->name + "\"", "has no exact counterpart in LAMMPS",
           fmt::format("{}", fmt::join(translated, ", ")), terms);
    return;
  }
  found->add(force, terms);
}

}  // namespace tomlin
