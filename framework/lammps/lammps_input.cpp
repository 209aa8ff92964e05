#include "framework/lammps/lammps_input.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/axis_names.hpp"
#include "framework/lammps/lammps_terms.hpp"
#include "framework/output/number_text.hpp"

namespace tomlin {
namespace {

constexpr std::size_t kMostTypes = 1000;  // LAMMPS holds tables of all pairs of them
constexpr std::size_t kMostBodies = 30;   // LAMMPS has 32 groups

const BodyDescription& common_of(const SceneBody& body) {
  return body.record->common(body.description.get());
}

// ---- what a scene has no counterpart for, forces aside

bool moves_steadily(const Motion& motion) {
  return std::all_of(motion.velocity.begin(), motion.velocity.end(),
                     [](const TimeFunction& v) { return v.is_constant(); }) &&
         motion.angular_velocity.is_constant() && motion.angular_velocity(0.0) == 0.0;
}

void check_bodies(const Scene& scene, std::vector<Fault>& faults) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    if (common_of(body).coordinates == Coordinates::rigid) {
      faults.emplace_back(FaultCode::component_unsuitable, body.location_of("coordinates"),
                          "body." + body.name + ".coordinates", "\"rigid\"",
                          "a rigid body is not written for LAMMPS",
                          "\"particles\", \"fixed\", or \"prescribed\" with a constant velocity");
    }
    if (body.motion && !moves_steadily(*body.motion)) {
      faults.emplace_back(FaultCode::component_unsuitable, body.location_of("motion"),
                          "body." + body.name + ".motion", "",
                          "this motion is not written for LAMMPS", "a constant velocity");
    }
    if (b == kMostBodies) {
      faults.emplace_back(FaultCode::component_unsuitable, body.location, "body." + body.name, "",
                          "LAMMPS has no more groups of atoms",
                          fmt::format("at most {} bodies", kMostBodies));
    }
  }
}

void check_run(const RunSettings& run, std::vector<Fault>& faults) {
  if (run.dynamics != Dynamics::inertial) {
    faults.emplace_back(FaultCode::integrator_unsuitable, run.location_of("dynamics"),
                        "run.dynamics", fmt::format("\"{}\"", to_string(run.dynamics)),
                        "LAMMPS is written for with inertia only", "\"inertial\"");
    return;
  }
  const IntegratorRecord& scheme = *run.integrator.record;
  if (run.accuracy || scheme.step == nullptr ||
      !(scheme.step(run.integrator.description.get()) > 0.0)) {
    faults.emplace_back(FaultCode::integrator_unsuitable,
                        run.location_of(run.accuracy ? "accuracy" : "integrator"),
                        run.accuracy ? "run.accuracy" : "run.integrator.type",
                        run.accuracy ? "" : "\"" + scheme.name + "\"", "LAMMPS needs a fixed step",
                        "--set 'run.integrator={type=\"velocity_verlet\",dt=STEP}'");
  }
}

// ---- atoms

LammpsAtoms atoms_of(const Model& model) {
  LammpsAtoms atoms;
  for (const Model::Body& body : model.bodies()) {
    LammpsAtoms::Body& own = atoms.bodies.emplace_back();
    own.first_atom = atoms.count + 1;
    own.first_type = atoms.types + 1;
    for (std::size_t i = 0; i < body.bound.slot.count; ++i) {
      const std::vector<std::int32_t>& species = body.bound.species;
      const LammpsAtoms::Type type{
          body.bound.mass[i],
          species.empty() ? "" : body.bound.species_names[static_cast<std::size_t>(species[i])]};
      const auto found = std::find(own.types.begin(), own.types.end(), type);
      own.type.push_back(own.first_type + static_cast<std::size_t>(found - own.types.begin()));
      if (found == own.types.end()) own.types.push_back(type);
      if (atoms.types + own.types.size() > kMostTypes) {
        const SceneBody& from = model.scene().bodies[body.bound.index];
        throw InputError({Fault(FaultCode::component_unsuitable, from.location_of("particle_mass"),
                                "body." + from.name + ".particle_mass", "",
                                "each mass is a type of atoms in LAMMPS, and there are too many",
                                fmt::format("at most {} types in all", kMostTypes))});
      }
    }
    atoms.count += own.type.size();
    atoms.types += own.types.size();
  }
  return atoms;
}

/// [atom][axis], three axes.
struct LammpsStart {
  std::vector<double> position;
  std::vector<double> velocity;
};

/// State at the scene's start: velocities of a temperature are drawn.
LammpsStart start_of(Model& model, std::size_t atoms) {
  StateLayout layout;
  model.declare(layout);
  RunState state(layout);
  model.attach(state);
  model.start();
  const auto& view = model.system().view;
  std::vector<double> rates(view.rates + 2 * kGroup, 0.0);
  // Places those that follow from few coordinates.
  model.evaluate_at(DoubleDouble(0.0), view.position, view.velocity, view.integrals, rates.data());
  const auto axes = static_cast<std::size_t>(model.dimension());
  LammpsStart start{std::vector<double>(3 * atoms, 0.0), std::vector<double>(3 * atoms, 0.0)};
  std::size_t atom = 0;
  for (const Model::Body& body : model.bodies()) {
    const auto& slot = body.bound.slot;
    std::vector<double> positions(slot.count * axes);
    model.place_particles(body.bound.index, view.position, positions.data());
    for (std::size_t i = 0; i < slot.count; ++i, ++atom) {
      for (std::size_t d = 0; d < axes; ++d) {
        start.position[3 * atom + d] = positions[i * axes + d];
        if (slot.mapped) continue;  // fixed, or moved by a fix
        start.velocity[3 * atom + d] = view.velocity[slot.offset + d * slot.stride + i];
      }
    }
  }
  return start;
}

// ---- the box

struct LammpsBox {
  std::array<double, 3> low{};
  std::array<double, 3> high{};
  std::array<const char*, 3> boundary{};
  double size = 1.0;  ///< of what is in it
};

LammpsBox box_of(const Model& model, const LammpsStart& start, double reach) {
  LammpsBox box;
  std::array<double, 3> extent{};
  for (std::size_t d = 0; d < 3; ++d) {
    box.low[d] = box.high[d] = start.position[d];
    for (std::size_t k = d; k < start.position.size(); k += 3) {
      box.low[d] = std::min(box.low[d], start.position[k]);
      box.high[d] = std::max(box.high[d], start.position[k]);
    }
    extent[d] = std::max(box.high[d] - box.low[d], model.plan().box[d]);
  }
  const double largest = std::max({extent[0], extent[1], extent[2], reach});
  if (largest > 0.0) box.size = largest;
  for (std::size_t d = 0; d < 3; ++d) {
    const bool exists = static_cast<int>(d) < model.dimension();
    const double length = model.plan().box[d];
    if (exists && length > 0.0) {
      box.low[d] = 0.0;
      box.high[d] = length;
      box.boundary[d] = "p";
      continue;
    }
    // A plane needs a periodic z, and on a line nothing leaves y = 0.
    box.boundary[d] = exists ? "m" : d == 2 ? "p" : "f";
    box.low[d] -= 0.5 * box.size;
    box.high[d] += 0.5 * box.size;
  }
  return box;
}

// ---- files

void append_triple(std::string& text, const double* numbers) {
  for (int d = 0; d < 3; ++d) {
    text += ' ';
    append_number(text, numbers[d]);
  }
}

std::string data_file(const LammpsTerms& terms, const LammpsStart& start, const LammpsBox& box) {
  const LammpsAtoms& atoms = terms.atoms;
  const Scene& scene = terms.model.scene();
  std::string text = fmt::format("# from tomlin: {}\n\n{} atoms\n{} atom types\n",
                                 lammps_comment(scene.name), atoms.count, atoms.types);
  if (!terms.bonds.empty()) {
    text += fmt::format("{} bonds\n{} bond types\n", terms.bonds.size(), terms.bond_types.size());
  }
  text += '\n';
  for (std::size_t d = 0; d < 3; ++d) {
    text += fmt::format("{} {} {}lo {}hi\n", lammps_number(box.low[d]), lammps_number(box.high[d]),
                        kAxisNames[d], kAxisNames[d]);
  }
  text += "\nMasses\n\n";
  for (std::size_t b = 0; b < atoms.bodies.size(); ++b) {
    for (std::size_t k = 0; k < atoms.bodies[b].types.size(); ++k) {
      const auto& [mass, species] = atoms.bodies[b].types[k];
      text +=
          fmt::format("{} {} # body {}{}\n", atoms.bodies[b].first_type + k,
                      lammps_number(mass / terms.units.mass), lammps_comment(scene.bodies[b].name),
                      species.empty() ? "" : ", " + lammps_comment(species));
    }
  }
  text += terms.bonds.empty() ? "\nAtoms # atomic\n\n" : "\nAtoms # bond\n\n";
  std::string velocities;
  std::size_t atom = 0;
  for (std::size_t b = 0; b < atoms.bodies.size(); ++b) {
    for (const std::size_t type : atoms.bodies[b].type) {
      text += std::to_string(atom + 1);
      if (!terms.bonds.empty()) text += fmt::format(" {}", b + 1);
      text += fmt::format(" {}", type);
      append_triple(text, &start.position[3 * atom]);
      text += '\n';
      velocities += std::to_string(atom + 1);
      append_triple(velocities, &start.velocity[3 * atom]);
      velocities += '\n';
      ++atom;
    }
  }
  text += "\nVelocities\n\n" + velocities;
  if (terms.bonds.empty()) return text;
  text += "\nBonds\n\n";
  for (std::size_t k = 0; k < terms.bonds.size(); ++k) {
    const LammpsBond& bond = terms.bonds[k];
    text += fmt::format("{} {} {} {}\n", k + 1, bond.type, bond.atoms[0], bond.atoms[1]);
  }
  return text;
}

/// The text of in.lmp, part by part.
class LammpsScript {
 public:
  LammpsScript(const LammpsTerms& terms, const LammpsBox& box)
      : terms_(terms), model_(terms.model), scene_(terms.model.scene()), box_(box) {}

  std::string text() {
    write_head();
    write_pairs();
    write_bonds();
    write_neighbours();
    write_groups();
    write_forces();
    write_motion();
    write_run();
    return std::move(text_);
  }

 private:
  template <class... Arguments>
  void line(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    text_ += fmt::format(format, std::forward<Arguments>(arguments)...) + "\n";
  }

  void write_head() {
    const std::string file = std::filesystem::path(scene_.file).filename().string();
    line("# Input of LAMMPS, made from {}{}{}", lammps_comment(file),
         scene_.name.empty() ? "" : ": ", lammps_comment(scene_.name));
    line("#   lmp -in {}                 runs it, in this folder", kLammpsInput);
    line("#   lmp -in {} -var steps 0    energy and forces at the start alone", kLammpsInput);
    line("# At the start energy and forces are those of tomlin to rounding.\n");
    write_units();
    line("dimension {}", model_.dimension() == 3 ? 3 : 2);
    line("# p: periodic, m: grows with the atoms{}",
         model_.dimension() == 1 ? ", f: nothing leaves y = 0" : "");
    line("boundary {} {} {}", box_.boundary[0], box_.boundary[1], box_.boundary[2]);
    line("atom_style {}", terms_.bonds.empty() ? "atomic" : "bond");
    // Without a cutoff there are no bins to sort into.
    line("atom_modify map array{}", terms_.pairs.empty() ? " sort 0 0.0" : "");
    line("newton on");
    line("read_data {}\n", kLammpsData);
  }

  void write_units() {
    const LammpsUnits& units = terms_.units;
    if (std::string_view(units.style) == "lj") {
      line("# Numbers are those of the scene: with these units all constants of LAMMPS are 1.");
    } else {
      line("# eV, Angstrom, ps, u, K. LAMMPS computes with u = {} eV ps^2/Angstrom^2 and a",
           units.mass);
      line("# Boltzmann constant of {} eV/K, where CODATA 2018 has 1.03642696e-4 and",
           units.temperature);
      line("# 8.617333262e-5. The masses in {} are larger by as much, so that accelerations are",
           kLammpsData);
      line("# those of tomlin.");
    }
    line("units {}", units.style);
  }

  void write_pairs() {
    if (terms_.pairs.empty()) return;
    line("# Each potential acts between the types of its bodies, and no pair is left to rules of");
    line("# mixing. Bonded particles interact as all others do.");
    line("special_bonds lj/coul 1.0 1.0 1.0");
    text_ += "pair_style hybrid/overlay";
    for (const LammpsPairs& pairs : terms_.pairs) {
      text_ += " " + pairs.style + (pairs.arguments.empty() ? "" : " " + pairs.arguments);
    }
    text_ += "\npair_coeff * * none\n";
    for (std::size_t k = 0; k < terms_.pairs.size(); ++k) {
      const LammpsPairs& pairs = terms_.pairs[k];
      const auto alike = [&pairs](const LammpsPairs& other) { return other.style == pairs.style; };
      const auto from = terms_.pairs.begin();
      std::string style = pairs.style;
      if (std::count_if(from, terms_.pairs.end(), alike) > 1) {
        style += fmt::format(" {}",
                             std::count_if(from, from + static_cast<std::ptrdiff_t>(k + 1), alike));
      }
      line("# {}", pairs.comment);
      for (const auto& [types, coefficients] : pairs.coefficients) {
        line("pair_coeff {} {} {}", types, style, coefficients);
      }
      if (!pairs.modify.empty()) line("pair_modify pair {} {}", style, pairs.modify);
    }
    text_ += '\n';
  }

  void write_bonds() {
    if (terms_.bonds.empty()) return;
    const auto& types = terms_.bond_types;
    const bool mixed = std::any_of(types.begin(), types.end(), [&types](const auto& type) {
      return type.style != types.front().style;
    });
    line(
        "# Bonds. harmonic: half the stiffness, the length at rest. morse: depth, inverse width, "
        "length.");
    line("bond_style {}", mixed ? "hybrid harmonic morse" : types.front().style);
    for (std::size_t k = 0; k < types.size(); ++k) {
      line("bond_coeff {} {}{}", k + 1, mixed ? types[k].style + " " : "", types[k].coefficients);
    }
    text_ += '\n';
  }

  void write_neighbours() {
    double longest = 0.0;
    for (const LammpsPairs& pairs : terms_.pairs) longest = std::max(longest, pairs.cutoff);
    constexpr double kSkin = 0.15;           // of the longest cutoff
    constexpr double kLongestStretch = 3.0;  // longest bond in a run / at its start
    line("# Lists of neighbours are renewed once an atom has moved by half the skin.");
    const double skin = kSkin * (longest > 0.0 ? longest : box_.size);
    line("neighbor {} bin", lammps_number(skin));
    line("neigh_modify every 1 delay 0 check yes");
    if (!terms_.bonds.empty()) {
      line("# Ends of bonds are found within {} times the longest bond.", kLongestStretch);
    }
    if (!terms_.bonds.empty() || longest == 0.0) {
      line("comm_modify cutoff {}", lammps_number(skin + kLongestStretch * terms_.longest_bond));
    }
    text_ += '\n';
  }

  void write_groups() {
    for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
      std::string types;
      for (std::size_t k = 0; k < terms_.atoms.bodies[b].types.size(); ++k) {
        types += fmt::format(" {}", terms_.atoms.bodies[b].first_type + k);
      }
      line("group {} type{}    # body {}", lammps_group(b), types,
           lammps_comment(scene_.bodies[b].name));
      const auto within = [b](const LammpsPairs& pairs) {
        return pairs.bodies[0] == b && pairs.bodies[1] == b;
      };
      if (!terms_.pairs.empty() && !moves(b) &&
          std::none_of(terms_.pairs.begin(), terms_.pairs.end(), within)) {
        line("neigh_modify exclude group {0} {0}    # no force acts within it", lammps_group(b));
      }
    }
    text_ += '\n';
  }

  void write_forces() {
    for (const Model::LeftOut& force : model_.left_out()) {
      line("# {} is left out: {}", lammps_comment(force.force), force.why);
    }
    if (terms_.commands.empty()) return;
    if (terms_.uses_time) line("variable time equal step*dt");
    if (terms_.uses_positions && periodic()) {
      line("compute position all property/atom xu yu zu    # as if the box had no sides");
    }
    if (terms_.uses_starts) {
      line("fix start all store/state 0 xu yu zu    # where each particle was at time 0");
    }
    for (const std::string& command : terms_.commands) text_ += command + "\n";
    text_ += '\n';
  }

  void write_motion() {
    std::string still;
    for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
      if (moves(b)) {
        write_held(b);
        continue;
      }
      still += " " + lammps_group(b);
      if (scene_.bodies[b].motion) {
        std::string velocity;
        for (std::size_t d = 0; d < 3; ++d) {
          const auto& motion = scene_.bodies[b].motion->velocity;
          velocity += " " + (d < motion.size() ? lammps_number(motion[d](0.0)) : "0.0");
        }
        line("fix motion{} {} move linear{} units box", b + 1, lammps_group(b), velocity);
      } else {
        line("fix still{} {} setforce 0.0 0.0 0.0    # a fixed body", b + 1, lammps_group(b));
      }
    }
    if (model_.dimension() < 3) line("fix plane all enforce2d");
    if (model_.dimension() == 1) line("fix line all setforce NULL 0.0 0.0");
    const std::string moving = still.empty() ? "all" : "moving";
    if (!still.empty()) line("group moving subtract all{}", still);
    line("fix verlet {} nve    # velocity Verlet", moving);
    text_ += '\n';
  }

  void write_held(std::size_t b) {
    std::string forces;
    for (std::size_t d = 0; d < 3; ++d) {
      forces += model_.bodies()[b].held[d] ? " 0.0" : " NULL";
    }
    if (forces.find("0.0") == std::string::npos) return;
    line("fix held{} {} setforce{}    # axes that are held", b + 1, lammps_group(b), forces);
  }

  void write_run() {
    const SceneIntegrator& scheme = scene_.run.integrator;
    const double step = scheme.record->step(scheme.description.get());
    if (scheme.record->name != "velocity_verlet") {
      line("# The scene's integrator is {}; this one takes steps of the same length.",
           lammps_comment(scheme.record->name));
    }
    line("timestep {}", lammps_number(step));
    const std::int64_t steps = steps_in(scene_.run.duration, step);
    const std::int64_t every =
        scene_.output.every ? std::max<std::int64_t>(1, std::llround(*scene_.output.every / step))
                            : std::max<std::int64_t>(1, steps / 100);
    line("thermo {}", every);
    std::string columns = "step time pe ke etotal";
    for (const std::string& column : terms_.columns) columns += " " + column;
    line("thermo_style custom {}", columns);
    line("thermo_modify norm no format float %.15g");
    line("{}dump trajectory all custom {} trajectory.lammpstrj id type xu yu zu",
         scene_.output.trajectory ? "" : "# ", every);
    line("{}dump_modify trajectory sort id format float %.17g",
         scene_.output.trajectory ? "" : "# ");
    line("variable steps index {}", steps);
    line("run ${{steps}}");
  }

  bool moves(std::size_t b) const {
    return follows_forces(common_of(scene_.bodies[b]).coordinates);
  }

  bool periodic() const { return model_.plan().box != std::array<double, 3>{}; }

  /// Whole steps; a shorter one at the end is left out.
  static std::int64_t steps_in(double duration, double step) {
    constexpr double kMostSteps = 9e15;        // every whole number up to it is a double
    constexpr double kRoundingOfSteps = 1e-9;  // in steps
    return static_cast<std::int64_t>(
        std::min(std::floor(duration / step + kRoundingOfSteps), kMostSteps));
  }

  const LammpsTerms& terms_;
  const Model& model_;
  const Scene& scene_;
  const LammpsBox& box_;
  std::string text_;
};

}  // namespace

std::string LammpsAtoms::Body::range() const {
  if (types.size() == 1) return std::to_string(first_type);
  return fmt::format("{}*{}", first_type, first_type + types.size() - 1);
}

std::string lammps_group(std::size_t body) { return fmt::format("body{}", body + 1); }

std::string lammps_number(double number) { return fmt::format("{}", number); }

std::string lammps_comment(const std::string& text) {
  constexpr std::size_t kLongestComment = 200;  // bytes: lines of LAMMPS have an end
  std::string plain = text.substr(0, kLongestComment);
  for (char& c : plain) {
    if (c < ' ' || c > '~' || c == '&' || c == '"' || c == '\'' || c == '$') c = '_';
  }
  return plain;
}

std::string lammps_coordinate(LammpsTerms& terms, int axis) {
  terms.uses_positions = true;
  if (terms.model.plan().box == std::array<double, 3>{}) return kAxisNames[axis];
  return fmt::format("c_position[{}]", axis + 1);
}

std::string lammps_start(LammpsTerms& terms, int axis) {
  terms.uses_starts = true;
  return fmt::format("f_start[{}]", axis + 1);
}

LammpsUnits lammps_units(const Scene& scene) {
  return scene.units == UnitSystem::metal ? kLammpsMetal : kLammpsReduced;
}

std::vector<LammpsFile> lammps_input(const std::shared_ptr<const Scene>& scene,
                                     const LammpsUnits& units) {
  Model model(scene);
  const LammpsAtoms atoms = atoms_of(model);
  const LammpsStart start = start_of(model, atoms.count);
  LammpsTerms terms{.model = model, .units = units, .atoms = atoms};
  check_bodies(*scene, terms.faults);
  for (const SceneForce& force : scene->forces) {
    const auto& out = model.left_out();
    const bool left_out =
        std::any_of(out.begin(), out.end(),
                    [&force](const Model::LeftOut& other) { return other.force == force.name; });
    if (!left_out) add_lammps_force(force, terms);
  }
  check_run(scene->run, terms.faults);
  if (!terms.faults.empty()) throw InputError(std::move(terms.faults));

  double reach = terms.longest_bond;
  for (const LammpsPairs& pairs : terms.pairs) reach = std::max(reach, pairs.cutoff);
  const LammpsBox box = box_of(model, start, reach);
  std::vector<LammpsFile> files = std::move(terms.files);
  files.push_back({kLammpsData, data_file(terms, start, box)});
  files.push_back({kLammpsInput, LammpsScript(terms, box).text()});
  return files;
}

}  // namespace tomlin
