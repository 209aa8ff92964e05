#include "framework/run/observers/samples.hpp"

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "framework/core/numbers/constants.hpp"
#include "framework/core/text/axis_names.hpp"
#include "framework/scene/engine_units.hpp"

namespace tomlin::observers {
namespace {

/// "position 8, clock 2, ...": numbers mean something only where the same fields are kept.
std::string fields_of(const StateLayout& layout) {
  std::string fields;
  for (const auto* group : {&layout.reals(), &layout.integers(), &layout.raw()}) {
    for (const StateLayout::Field& field : *group) {
      fields += fmt::format("{}{} {}", fields.empty() ? "" : ", ", field.name, field.count);
    }
  }
  return fields;
}

}  // namespace

Samples::Samples(const ObserverParts& parts) : parts_(parts), forces_(parts) {
  const RunSink* sink = parts.run.options.sink;
  const bool asked = sink != nullptr && sink->wants_samples();
  wanted_ = asked && parts.run.scene->output.every.has_value();
}

void Samples::show(SceneObservers& scene) {
  scene_ = &scene;
  wanted_ = parts_.run.scene->output.every.has_value();
}

RunLayout Samples::layout() const {
  const RunContext& run = parts_.run;
  const Model& model = run.model;
  RunLayout layout;
  layout.dimension = model.dimension();
  layout.box = run.scene->box.lengths;
  layout.periodic = run.scene->box.periodic;
  layout.events = parts_.events.expects_any();
  layout.state = fields_of(run.state.layout());
  layout.state_bytes = run.state.to_bytes().size();
  if (!run.scene->output.every) return layout;
  // The last may miss the end of the run by rounding, and comes nevertheless.
  constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();
  const double intervals = run.plan.duration / *run.scene->output.every;
  layout.most_samples = std::floor(intervals * (1.0 + kRounding) + kNoStep) + 1.0;
  std::vector<SampleColumn>& columns = layout.columns;
  const UnitSystem units = run.scene->units;
  const auto per_axis = [&](const std::string& name, const Dimension& dimension) {
    for (int d = 0; d < model.dimension(); ++d) {
      columns.push_back({name + "." + kAxisNames[d], unit_in_tables(units, dimension)});
    }
  };
  columns.push_back({"time", unit_in_tables(units, dimension::time)});
  for (const Model::Driver& driver : model.drivers()) {
    per_axis(driver.name + ".force", dimension::force);
  }
  for (const Model::Driver& driver : model.drivers()) {
    if (driver.drive->steady) per_axis(driver.name + ".position", dimension::length);
  }
  for (const Model::Body& body : model.bodies()) {
    per_axis(body.bound.name + ".centre_of_mass", dimension::length);
    per_axis(body.bound.name + ".velocity", dimension::velocity);
    if (body.rotates()) columns.push_back({body.bound.name + ".rotation", "rad"});
  }
  for (const std::string& name : forces_.names()) per_axis(name + ".force", dimension::force);
  if (scene_ != nullptr) scene_->list_columns(columns);
  if (run.scene->output.trajectory) {
    for (const Model::Body& body : model.bodies()) {
      layout.bodies.push_back({body.bound.name, body.bound.mass, body.bound.species});
      const double unit = scene_unit(units, dimension::mass);
      for (double& mass : layout.bodies.back().mass) mass = scene_number(mass, unit);
    }
    layout.species = run.scene->species;
  }
  return layout;
}

void Samples::begin_sink() {
  if (std::exchange(sink_has_begun_, true)) return;
  RunSink* sink = parts_.run.options.sink;
  if (sink == nullptr && !wanted_) return;
  RunLayout given = layout();
  if (!wanted_) {
    given.columns.clear();
    given.bodies.clear();
    given.most_samples = 0.0;
  }
  row_.assign(given.row(), 0.0);
  if (sink != nullptr) sink->begin(given);
}

double Samples::next_time() const {
  if (!wanted_) return std::numeric_limits<double>::infinity();
  const double every = *parts_.run.scene->output.every;
  const double time = static_cast<double>(*next_) * every;
  // The last sample may miss the end of the run by rounding.
  const double end = parts_.run.plan.duration;
  return std::abs(time - end) <= kNoStep * every ? end : time;
}

bool Samples::is_taken_at(double time) const {
  return wanted_ &&
         static_cast<double>(*next_) * *parts_.run.scene->output.every <= time * (1.0 + kNoStep);
}

bool Samples::are_taken_every(double time) const {
  return wanted_ && scene_ == nullptr && forces_.names().empty() &&
         *parts_.run.scene->output.every == time;
}

void Samples::take(const RunMoment& moment) {
  ++*next_;
  const Model& model = parts_.run.model;
  const int axes = model.dimension();
  double* next = row_.data();
  *next++ = moment.time;
  for (const Model::Driver& driver : model.drivers()) {
    for (int d = 0; d < axes; ++d) *next++ = moment.rates[driver.first_rate + d];
  }
  for (std::size_t k = 0; k < model.drivers().size(); ++k) {
    if (!model.drivers()[k].drive->steady) continue;
    for (int d = 0; d < axes; ++d) {
      *next++ = static_cast<double>(model.pulled_end(k, DoubleDouble(moment.time), d));
    }
  }
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    double numbers[3];
    model.centre(b, moment.position, numbers);
    for (int d = 0; d < axes; ++d) {
      *next++ = static_cast<double>(model.placed(d, numbers[d]));
    }
    model.centre_velocity(b, moment.velocity, numbers);
    for (int d = 0; d < axes; ++d) *next++ = numbers[d];
    if (model.bodies()[b].rotates()) *next++ = kTau * parts_.rotations.turns_of(b, moment.position);
  }
  if (!forces_.names().empty()) {
    forces_.evaluate(moment, [&next](std::size_t, std::size_t, double force) { *next++ = force; });
  }
  if (scene_ != nullptr) {
    next = scene_->sample(moment, next);
    if (next == nullptr) return;
  }
  if (parts_.run.scene->output.trajectory) {
    for (std::size_t b = 0; b < model.bodies().size(); ++b) {
      next = model.place_particles(b, moment.position, next);
    }
  }
  if (parts_.run.options.sink != nullptr) parts_.run.options.sink->sample(row_);
}

}  // namespace tomlin::observers
