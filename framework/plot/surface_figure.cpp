#include "framework/plot/surface_figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "framework/core/formula/formula.hpp"
#include "framework/core/records/variation.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/model/single_force.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/plot/axis_text.hpp"
#include "framework/plot/equal_scale.hpp"
#include "framework/plot/series_reader.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/effective.hpp"
#include "framework/scene/engine_units.hpp"

namespace tomlin {
namespace {

constexpr double kPeriodsAround = 0.75;  // of the substrate, on each side of the path
constexpr double kShareAround = 0.06;    // of the path, likewise
constexpr double kPixelsPerPeriod = 48.0;
constexpr double kFewestAcross = 320.0;  // pixels along the longer side
constexpr double kMostAcross = 640.0;

struct BodyPath {
  Polyline points;
  std::string body;
  std::string length;   ///< the dimension, as in the header
  double height = 0.0;  ///< along z, where it begins
  bool in_space = false;
};

BodyPath read_path(const StoredRun& run, const SurfaceRequest& request) {
  const SampleTable table(file_of(run, kTableFile));
  BodyPath path;
  path.body = chosen_owner(table, Owner::body, "centre_of_mass.y", request.owners);
  const std::string column = path.body + ".centre_of_mass.";
  const Series x = column_series(table, column + "x");
  const Series y = column_series(table, column + "y");
  SeriesReader reader;
  reader.add(x);
  reader.add(y);
  path.in_space = table.find(column + "z").has_value();
  if (path.in_space) reader.add(column_series(table, column + "z"));
  reader.read(table);
  if (path.in_space) path.height = reader.values(column_series(table, column + "z")).front();
  path.length = x.unit;
  const std::vector<double> along_x = reader.values(x);
  const std::vector<double> along_y = reader.values(y);
  for (std::size_t i = 0; i < along_x.size(); ++i) {
    const bool shown = along_x[i] >= request.from.value_or(-HUGE_VAL) &&
                       along_x[i] <= request.to.value_or(HUGE_VAL);
    if (shown) path.points.push_back({along_x[i], along_y[i]});
  }
  if (path.points.empty()) {
    const auto [least, most] = std::minmax_element(along_x.begin(), along_x.end());
    refuse_input(FaultCode::plot_no_data, request.from ? "--from" : "--to", "",
                 "there is no sample in this range",
                 fmt::format("{} from {:g} to {:g}", x.name, *least, *most));
  }
  return path;
}

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
std::shared_ptr<const Scene> particle_scene(const StoredRun& run, const Scene& scene,
                                            const std::vector<std::size_t>& forces,
                                            const Registry& registry) {
  const auto node = [](auto value) { return Node{std::move(value), {}}; };
  Table document = *run.scene->contents();
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
  return parse_scene(to_toml(document), file_of(run, kSceneFile), registry);
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
    const std::array<double, 3> place = {x, y, height_};
    double sum = 0.0;
    for (const auto& force : forces_) {
      for (const SingleForce::Variable& variable : force->variables()) {
        force->position(variable) = place[variable.axis];
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

/// The rectangle around the path, in square pixels.
Raster empty_map(const Polyline& path, double period) {
  Raster map;
  map.x_from = map.y_from = HUGE_VAL;
  map.x_to = map.y_to = -HUGE_VAL;
  for (const Point& point : path) {
    map.x_from = std::min(map.x_from, point.x);
    map.x_to = std::max(map.x_to, point.x);
    map.y_from = std::min(map.y_from, point.y);
    map.y_to = std::max(map.y_to, point.y);
  }
  const double extent = std::max(map.x_to - map.x_from, map.y_to - map.y_from);
  double margin = std::max(kPeriodsAround * period, kShareAround * extent);
  if (!(margin > 0.0)) margin = 1.0;
  map.x_from -= margin;
  map.x_to += margin;
  map.y_from -= margin;
  map.y_to += margin;
  const double width = map.x_to - map.x_from;
  const double height = map.y_to - map.y_from;
  const double longer = std::max(width, height);
  const double wanted = period > 0.0 ? kPixelsPerPeriod * longer / period : kMostAcross;
  const double pixel = longer / std::clamp(wanted, kFewestAcross, kMostAcross);
  map.columns = static_cast<std::size_t>(std::max(1.0, std::round(width / pixel)));
  const auto rows = static_cast<std::size_t>(std::max(1.0, std::round(height / pixel)));
  map.values.assign(map.columns * rows, 0.0);
  map.grey = true;
  return map;
}

void evaluate(Raster& map, Potential& potential) {
  const std::size_t rows = map.values.size() / map.columns;
  const double width = (map.x_to - map.x_from) / static_cast<double>(map.columns);
  const double height = (map.y_to - map.y_from) / static_cast<double>(rows);
  for (std::size_t k = 0; k < map.values.size(); ++k) {
    const std::size_t row = k / map.columns;
    const std::size_t column = k % map.columns;
    map.values[k] = potential.at(map.x_from + (0.5 + static_cast<double>(column)) * width,
                                 map.y_from + (0.5 + static_cast<double>(row)) * height);
  }
}

Curve point_of(const Point& point, Mark mark, const char* label) {
  Curve curve;
  curve.line = false;
  curve.mark = mark;
  curve.colour = 1;
  curve.label = label;
  curve.pieces = {{point}};
  return curve;
}

}  // namespace

Figure surface_figure(const StoredRun& run, const SurfaceRequest& request,
                      const Registry& registry) {
  const BodyPath path = read_path(run, request);
  const std::string file = file_of(run, kSceneFile);
  const auto scene = run.scene->read(registry);
  std::vector<std::size_t> substrates;
  for (std::size_t k = 0; k < scene->forces.size(); ++k) {
    if (is_substrate(*scene, scene->forces[k], path.body)) substrates.push_back(k);
  }
  if (substrates.empty()) {
    refuse_input(FaultCode::plot_no_data, file, "body." + path.body,
                 "no force on it is a substrate",
                 "a conservative force with a period that acts from outside the body; the figure "
                 "path shows the path alone");
  }
  for (const std::size_t k : substrates) {
    if (is_uniform(scene->forces[k])) continue;
    refuse_input(FaultCode::plot_no_data, file, "force." + scene->forces[k].name,
                 "it differs between the particles of the body: there is no one potential",
                 "substrates that are the same for all particles");
  }
  Panel panel;
  panel.raster = empty_map(path.points, longest_period(*scene, substrates));
  try {
    Potential potential(particle_scene(run, *scene, substrates, registry), path.height);
    evaluate(*panel.raster, potential);
  } catch (const InputError& error) {
    refuse_input(FaultCode::plot_no_data, file, "body." + path.body,
                 "the potential of one particle cannot be computed: " + error.faults().front().why,
                 "substrates that are the same for all particles");
  }
  if (path.in_space) panel.title = fmt::format("z = {:g}", path.height);
  panel.raster->label = axis_text("potential energy", "{/:Italic V}", unit_name(run, "energy"));
  Curve curve;
  curve.label = "path";
  curve.colour = 1;
  const Raster& map = *panel.raster;
  curve.pieces =
      reduced({path.points}, {map.x_from, map.x_to, map.y_from, map.y_to, request.width,
                              request.width * (map.y_to - map.y_from) / (map.x_to - map.x_from)});
  panel.curves = {std::move(curve), point_of(path.points.front(), Mark::large_disc, "start"),
                  point_of(path.points.back(), Mark::square, "end")};
  const auto along = [&](const char* axis) {
    return axis_text("", fmt::format("{{/:Italic {}}}", axis), unit_name(run, path.length));
  };
  panel.y_label = along("y");
  Figure figure;
  figure.x_label = along("x");
  figure.panels.push_back(std::move(panel));
  scale_equally(figure, 0.0);
  return figure;
}

}  // namespace tomlin
