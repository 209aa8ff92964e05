#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "framework/core/formula/formula.hpp"
#include "framework/core/records/variation.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/model/model.hpp"
#include "framework/model/single_force.hpp"
#include "framework/python/handles.hpp"
#include "framework/run/results/results.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/effective.hpp"
#include "framework/scene/engine_units.hpp"

namespace tomlin::python {
namespace {

bool is_substrate(const Scene& scene, const SceneForce& force, const std::string& body) {
  const Traits traits = force.traits();
  const bool repeats = force.period(0) > 0.0 || force.period(1) > 0.0 ||
                       force.record->origin_cell(force.description.get(), 0) > 0.0;
  return repeats && traits.conservative && !traits.internal && !traits.does_work &&
         !traits.depends_on_time && !force.driver && force.bodies.size() == 1 &&
         scene.bodies[force.bodies.front()].name == body;
}

/// Whether a force is the same for all particles of its body, however many these are.
bool is_uniform(const SceneForce& force) {
  for (const Parameter& row : force.record->parameters) {
    const ParameterValue value = row.read(force.description.get());
    const auto* energy = std::get_if<Formula>(&value);
    if (energy == nullptr || energy->text.empty()) continue;
    const FormulaLaw law(*energy, {});
    if (law.depends_on_particle() || law.uses(formula_variable::count)) return false;
  }
  return std::all_of(force.variations.begin(), force.variations.end(), [](const Variation& one) {
    const auto same = [](const auto& list) {
      return std::equal(list.begin() + 1, list.end(), list.begin());
    };
    const auto* numbers = std::get_if<PerParticle>(&one.values);
    return numbers ? same(numbers->values) : same(std::get<PerParticleVector>(one.values).values);
  });
}

/// The keys of a force as the scene has them, with the numbers that they have there: an expression
/// may depend on the count of the particles.
void write_numbers(const SceneForce& force, UnitSystem units, Table& table) {
  for (const Parameter& row : force.record->parameters) {
    if (table.find(row.key) == nullptr) continue;
    if (!can_vary(row)) continue;
    const ParameterValue value =
        in_scene_units(row.read(force.description.get()), scene_unit(units, row.dimension));
    if (auto number = to_node(value)) table.set(row.key, *std::move(number));
  }
}

/// The scene of one particle at the origin and on these forces of the scene.
std::shared_ptr<const Scene> particle_scene(const SceneHandle& handle,
                                            const std::vector<std::size_t>& forces) {
  const Scene& scene = *handle.scene;
  const auto node = [](auto value) { return Node{std::move(value), {}}; };
  Table document = handle.document->with(handle.settings);
  Table particle;
  particle.set("name", node(std::string("particle")));
  particle.set("type", node(std::string("point")));
  List origin;
  for (int d = 0; d < scene.dimension; ++d) origin.push_back(node(0.0));
  particle.set("position", node(std::move(origin)));
  particle.set("particle_mass", node(1.0));
  document.set("body", node(List{node(std::move(particle))}));
  List kept;
  for (const std::size_t force : forces) {
    Table table = *(*document.find("force")->as<List>())[force].as<Table>();
    std::erase_if(table.entries,
                  [](const Entry& entry) { return entry.key == "body" || entry.key == "bodies"; });
    write_numbers(scene.forces[force], scene.units, table);
    kept.push_back(node(std::move(table)));
  }
  document.set("force", node(std::move(kept)));
  std::erase_if(document.entries, [](const Entry& entry) {
    return entry.key == "observer" || entry.key == "measure" || entry.key == "output";
  });
  Table integrator;
  integrator.set("type", node(std::string("rk4")));
  integrator.set("dt", node(1.0));
  Table how;
  how.set("duration", node(1.0));
  how.set("integrator", node(std::move(integrator)));
  document.set("run", node(std::move(how)));
  return parse_scene(to_toml(document), scene.file, *handle.registry);
}

/// The energy of one particle on substrates.
class Potential {
 public:
  Potential(std::shared_ptr<const Scene> scene, double height)
      : scene_(std::move(scene)), height_(height) {
    for (std::size_t k = 0; k < scene_->forces.size(); ++k) {
      auto force = std::make_unique<SingleForce>(*scene_, k);
      if (force->built()) forces_.push_back(std::move(force));
    }
  }

  double at(double x, double y) {
    const std::array<double, 3> point = {x, y, height_};
    double sum = 0.0;
    for (const auto& force : forces_) {
      for (const SingleForce::Variable& variable : force->variables()) {
        force->position(variable) = point[variable.axis];
      }
      sum += force->energy(0.0);
    }
    return sum;
  }

 private:
  std::shared_ptr<const Scene> scene_;
  double height_;
  std::vector<std::unique_ptr<SingleForce>> forces_;
};

/// The longest period of the substrates; 0: along no axis.
double longest_period(const Scene& scene, const std::vector<std::size_t>& forces) {
  double longest = 0.0;
  for (const std::size_t k : forces) {
    for (const int axis : {0, 1}) longest = std::max(longest, scene.forces[k].period(axis));
  }
  return longest;
}

std::vector<std::size_t> substrates_of(const SceneHandle& handle, const std::string& body) {
  const Scene& scene = *handle.scene;
  std::vector<std::size_t> substrates;
  for (std::size_t k = 0; k < scene.forces.size(); ++k) {
    if (is_substrate(scene, scene.forces[k], body)) substrates.push_back(k);
  }
  if (substrates.empty()) {
    refuse_input(FaultCode::plot_no_data, scene.file, "body." + body,
                 "no force on it is a substrate",
                 "a conservative force with a period that acts from outside the body; the figure "
                 "path shows the path alone");
  }
  for (const std::size_t k : substrates) {
    if (is_uniform(scene.forces[k])) continue;
    refuse_input(FaultCode::plot_no_data, scene.file, "force." + scene.forces[k].name,
                 "it differs between the particles of the body: there is no one potential",
                 "substrates that are the same for all particles");
  }
  return substrates;
}

double substrate_period(const SceneHandle& handle, const std::string& body) {
  return longest_period(*handle.scene, substrates_of(handle, body));
}

/// Energies [y][x] of one particle.
py::array_t<double> substrate_potential(const SceneHandle& handle, const std::string& body,
                                        const std::vector<double>& x, const std::vector<double>& y,
                                        double z) {
  const std::vector<std::size_t> substrates = substrates_of(handle, body);
  py::array_t<double> energies({y.size(), x.size()});
  double* next = energies.mutable_data();
  try {
    Potential potential(particle_scene(handle, substrates), z);
    for (const double above : y) {
      for (const double across : x) *next++ = potential.at(across, above);
    }
  } catch (const InputError& error) {
    refuse_input(FaultCode::plot_no_data, handle.scene->file, "body." + body,
                 "the potential of one particle cannot be computed: " + error.faults().front().why,
                 "substrates that are the same for all particles");
  }
  return energies;
}

/// Particles seen from the centre of mass, whether the body is a ring, and whether it keeps its
/// shape.
py::tuple shape_of(const SceneHandle& handle, const std::string& name) {
  const Model model(handle.scene);
  const auto& bodies = model.bodies();
  const auto found = std::find_if(bodies.begin(), bodies.end(),
                                  [&](const auto& body) { return body.bound.name == name; });
  if (found == bodies.end()) {
    refuse_input(FaultCode::plot_no_data, handle.scene->file, "body." + name,
                 "there is no such body");
  }
  std::vector<std::array<double, 2>> arms;
  for (const auto& arm : found->arms) arms.push_back({arm[0], arm[1]});
  return py::make_tuple(arms, found->rolling_radius > 0.0,
                        found->moves_as_one() || found->prescribed());
}

/// The key of a result, "mean_force", and its unit; None of one that is not declared.
py::object quantity(const std::string& path, const std::string& system) {
  const ResultQuantity* found = quantity_at(path);
  if (found == nullptr) return py::none();
  const auto units = value_named<UnitSystem>(system).value_or(UnitSystem::reduced);
  return py::make_tuple(found->key, unit_in_tables(units, *found));
}

}  // namespace

void define_figures(py::module_& module, py::class_<SceneHandle>& scene) {
  scene.def("shape_of", &shape_of)
      .def("substrate_period", &substrate_period)
      .def("substrate_potential", &substrate_potential);
  module.def("quantity", &quantity);
}

}  // namespace tomlin::python
