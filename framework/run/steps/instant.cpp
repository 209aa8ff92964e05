#include "framework/run/steps/instant.hpp"

#include <string>
#include <vector>

#include "framework/core/numbers/constants.hpp"
#include "framework/core/text/axis_names.hpp"
#include "framework/core/text/nearest_name.hpp"

namespace tomlin {
namespace {}  // namespace

Instant::Instant(const Model& model, std::string_view path, const std::string& key,
                 const SourceLocation& location) {
  struct Candidate {
    std::string path;
    Kind kind;
    std::size_t index;
    int axis;
  };
  std::vector<Candidate> all;
  const auto per_axis = [&](const std::string& name, Kind kind, std::size_t index) {
    for (int d = 0; d < model.dimension(); ++d) {
      all.push_back({name + "." + kAxisNames[d], kind, index, d});
    }
  };
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const std::string name = "bodies." + model.bodies()[b].bound.name;
    per_axis(name + ".centre_of_mass", Kind::centre, b);
    per_axis(name + ".velocity", Kind::velocity, b);
    if (model.bodies()[b].rotates()) all.push_back({name + ".rotation", Kind::rotation, b, 0});
  }
  for (std::size_t k = 0; k < model.drivers().size(); ++k) {
    const std::string name = "drivers." + model.drivers()[k].name;
    per_axis(name + ".force", Kind::force, k);
    if (model.drivers()[k].drive->steady) per_axis(name + ".position", Kind::position, k);
  }
  std::vector<std::string> names;
  for (const Candidate& one : all) {
    const std::string brief = one.path.substr(one.path.find('.') + 1);
    if (path == one.path || path == brief) {
      kind_ = one.kind;
      index_ = one.index;
      axis_ = one.axis;
      return;
    }
    names.push_back(one.path);
    names.push_back(brief);
  }
  throw InputError(
      {Fault(FaultCode::observable_unknown, location, key, "\"" + std::string(path) + "\"",
             "there is no observable of that name that has a value at each moment",
             "bodies.NAME.centre_of_mass.x, .velocity.x, .rotation, drivers.NAME.force.x, "
             ".position.x, or another axis",
             nearest_name(std::string(path), names).value_or(""))});
}

double Instant::above(const Model& model, const State& state, double value) const {
  double numbers[3];
  switch (kind_) {
    case Kind::centre:
      model.centre(index_, state.position, numbers);
      return static_cast<double>(model.placed(axis_, numbers[axis_]) - value);
    case Kind::velocity:
      model.centre_velocity(index_, state.velocity, numbers);
      return numbers[axis_] - value;
    case Kind::rotation:
      return kTau * state.turns[index_] - value;
    case Kind::force:
      return state.rates[model.drivers()[index_].first_rate + axis_] - value;
    case Kind::position:
      return static_cast<double>(model.pulled_end(index_, state.time, axis_) - value);
  }
  return 0.0;
}

}  // namespace tomlin
