#include "framework/run/observables.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "framework/core/nearest_name.hpp"

namespace tomlin {
namespace {

constexpr const char* kAxes[] = {"x", "y", "z"};
constexpr std::string_view kFamilies[] = {"drivers.", "bodies.", "observers."};

// What is not there for want of a window has no length of its own.
std::size_t dimension_of(const RunResult& result) {
  std::size_t dimension = 0;
  for (const auto& driver : result.drivers) {
    dimension = std::max(dimension, driver.final_force.size());
  }
  for (const auto& body : result.bodies) {
    dimension = std::max(dimension, body.centre_of_mass.size());
  }
  return dimension;
}

/// Collects the numbers under one heading after another.
class Collector {
 public:
  explicit Collector(std::size_t dimension) : dimension_(dimension) {}

  Collector& under(std::string heading) {
    heading_ = std::move(heading);
    return *this;
  }
  Collector& add(const char* name, std::optional<double> value) {
    push(name, value);
    return *this;
  }
  Collector& add(const char* name, const std::vector<double>& components) {
    for (std::size_t d = 0; d < dimension_; ++d) {
      std::optional<double> value;
      if (d < components.size()) value = components[d];
      push(std::string(name) + "." + kAxes[d], value);
    }
    return *this;
  }
  Collector& add_count(const char* name, const std::optional<std::uint64_t>& count) {
    std::optional<double> value;
    if (count) value = static_cast<double>(*count);
    return add(name, value);
  }
  std::vector<Observable> take() { return std::move(all_); }

 private:
  void push(const std::string& name, std::optional<double> value) {
    if (value && !std::isfinite(*value)) value.reset();
    all_.push_back({heading_ + "." + name, value});
  }

  std::size_t dimension_;
  std::string heading_;
  std::vector<Observable> all_;
};

void add_driver(Collector& all, const DriverResult& driver) {
  all.under("drivers." + driver.name)
      .add("mean_force", driver.mean_force)
      .add("final_force", driver.final_force)
      .add("max_force", driver.max_force)
      .add("min_force", driver.min_force)
      .add("static_force", driver.static_force)
      .add("work", driver.work)
      .add("work_per_distance", driver.work_per_distance)
      .add("distance", driver.distance);
}

void add_body(Collector& all, const BodyResult& body, bool planar) {
  all.under("bodies." + body.name)
      .add("centre_of_mass", body.centre_of_mass)
      .add("velocity", body.velocity);
  if (planar) {
    all.add("rotation", body.rotation).add("turns", body.turns).add("rolling", body.rolling);
  }
  all.add("mean_velocity", body.mean_velocity).add("max_speed", body.max_speed);
}

void add_observer(Collector& all, const ObserverResult& observer) {
  all.under("observers." + observer.name);
  for (const ObserverResult::Number& number : observer.numbers) {
    all.add(number.name.c_str(), number.value);
    all.add(("mean_" + number.name).c_str(), number.mean);
  }
}

/// "driver.work" of "drivers.driver.work".
std::string_view without_family(std::string_view path) {
  for (const std::string_view family : kFamilies) {
    if (path.starts_with(family)) return path.substr(family.size());
  }
  return path;
}

Fault unknown(const std::vector<Observable>& all, std::string_view path, const Place& place) {
  std::vector<std::string> names;
  for (const Observable& one : all) {
    names.emplace_back(without_family(one.path));
    names.push_back(one.path);
  }
  Fault fault;
  fault.place = place;
  fault.key = path;
  fault.why = "there is no observable of that name";
  fault.admissible = "a dotted path as in summary.json, components by letter";
  if (!names.empty()) fault.admissible += ", say \"" + names.front() + "\"";
  fault.nearest = nearest_name(path, names).value_or("");
  // "mean_force", without whose and along which axis: the first of these.
  for (const std::string& name : names) {
    const bool part = ("." + name + ".").find("." + std::string(path) + ".") != std::string::npos;
    if (fault.nearest.empty() && !path.empty() && part) fault.nearest = name;
  }
  return fault;
}

}  // namespace

std::vector<Observable> observables(const RunResult& result) {
  const std::size_t dimension = dimension_of(result);
  Collector all(dimension);
  for (const DriverResult& driver : result.drivers) add_driver(all, driver);
  for (const BodyResult& body : result.bodies) add_body(all, body, dimension == 2);
  for (const ObserverResult& observer : result.observers) add_observer(all, observer);
  all.under("events")
      .add_count("slips", result.events.slips)
      .add_count("hops", result.events.hops)
      .add_count("turns", result.events.turns)
      .add_count("reversals", result.events.reversals)
      .add_count("driver_reversals", result.events.driver_reversals)
      .add_count("ties", result.events.ties);
  if (result.equilibrium) {
    all.under("equilibrium")
        .add("energy", result.equilibrium->energy)
        .add_count("neutral_directions", result.equilibrium->neutral_directions)
        .add("smallest_curvature", result.equilibrium->smallest_curvature)
        .add("log_determinant", result.equilibrium->log_determinant);
  }
  if (result.energy) {
    all.under("energy")
        .add("kinetic", result.energy->kinetic)
        .add("potential", result.energy->potential)
        .add("work_in", result.energy->work_in)
        .add("heat_out", result.energy->heat_out)
        .add("stored_change", result.energy->stored_change)
        .add("numerical_work", result.energy->numerical_work);
  }
  all.under("time")
      .add("end", result.end_time)
      .add_count("steps", result.steps)
      .add_count("force_evaluations", result.force_evaluations)
      .add_count("jacobian_columns", result.jacobian_columns)
      .add_count("refused_steps", result.refused_steps);
  all.under("window").add("from", result.window_from).add("to", result.window_to);
  all.under("performance")
      .add("wall_seconds", result.wall_seconds)
      .add("steps_per_second", result.steps_per_second);
  return all.take();
}

namespace {

Observable found(const RunResult& result, std::string_view path, const Place& place) {
  const std::vector<Observable> all = observables(result);
  for (const Observable& one : all) {
    if (one.path == path || without_family(one.path) == path) return one;
  }
  throw InputError({unknown(all, path, place)});
}

}  // namespace

std::optional<double> observable(const RunResult& result, std::string_view path,
                                 const Place& place) {
  return found(result, path, place).value;
}

std::string full_path(const RunResult& result, std::string_view path, const Place& place) {
  return found(result, path, place).path;
}

}  // namespace tomlin
