#include "framework/model/properties.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "framework/model/properties/force_under_test.hpp"
#include "framework/model/properties/scale.hpp"

namespace tomlin {
namespace {

using properties::ForceUnderTest;
using properties::Property;
using States = Property::States;

bool always(ForceUnderTest&) { return true; }
bool is_conservative(ForceUnderTest& e) { return e.traits().conservative; }
bool has_curvature_bound(ForceUnderTest& e) {
  return e.force().curvature->curvature_bound() >= 0.0;
}
bool has_exact_numbers(ForceUnderTest& e) { return e.exact() != nullptr; }

/// In the order of results. Some properties cannot be refuted by one state and have to be seen at
/// one at least: where none shows them, they hold with no state.
constexpr Property kProperties[] = {
    {"conservative", "force = -gradient of its energy, by differences", States::everywhere,
     is_conservative, properties::conservative},
    // To be seen at one state at least.
    {"not conservative", "it is not the gradient of its energy, and need not be declared so",
     States::near, [](ForceUnderTest& e) { return !e.traits().conservative; },
     properties::not_conservative},
    {"exact", "force = -gradient of its energy, differentiated in quadruple precision",
     States::everywhere,
     [](ForceUnderTest& e) { return e.traits().conservative && e.exact() != nullptr; },
     properties::exact},
    {"quadruple", "force = -gradient of its energy, both in quadruple precision",
     States::everywhere,
     [](ForceUnderTest& e) { return e.traits().conservative && e.exact() != nullptr; },
     properties::quadruple_gradient},
    {"quadruple", "power = energy stored + heat, all in quadruple precision", States::everywhere,
     [](ForceUnderTest& e) {
       return e.exact() != nullptr && !e.traits().conservative && !e.on_prescribed() &&
              e.exact()->heat().has_value();
     },
     properties::quadruple_heat},
    // An energy may jump on the way.
    {"path", "work along a path of some lengths = minus the change of energy", States::three,
     is_conservative, properties::path},
    {"hessian", "second derivatives = slopes of the force", States::near, is_conservative,
     properties::hessian},
    {"stiffness", "no curvature beyond the bound that the stable step is made of", States::near,
     has_curvature_bound, properties::stiffness},
    // To be seen at one state at least.
    {"tight", "some curvature comes to half of the bound that the stable step is made of",
     States::near, [](ForceUnderTest& e) { return e.force().curvature->curvature_bound() > 0.0; },
     properties::tight},
    {"finite", "forces and energies are numbers, near, far, high and touching", States::everywhere,
     always, properties::finite},
    {"internal", "forces and torques sum to zero", States::everywhere,
     [](ForceUnderTest& e) {
       return e.traits().internal && acts_on_all_its_bodies(e) && is_open(e);
     },
     properties::internal},
    {"internal", "forces sum to zero", States::everywhere,
     [](ForceUnderTest& e) {
       return e.traits().internal && acts_on_all_its_bodies(e) && !is_open(e);
     },
     properties::internal},
    // To be seen at one state at least.
    {"not internal", "its forces do not sum to zero, and need not be declared to", States::near,
     [](ForceUnderTest& e) { return !e.traits().internal && !e.on_prescribed(); },
     properties::not_internal},
    {"dissipative", "its power is never positive, at any speed", States::everywhere,
     [](ForceUnderTest& e) { return e.traits().dissipative; }, properties::dissipative},
    {"friction", "the friction matrix = minus the force's slopes in the velocities", States::near,
     [](ForceUnderTest& e) { return e.force().friction->is_friction(); }, properties::friction,
     properties::coefficients_are_positive},
    {"friction bound", "the force changes with velocities by no more than its bound", States::near,
     [](ForceUnderTest& e) { return e.force().friction->friction_bound() != 0.0; },
     properties::friction_bound},
    {"balance", "power = energy stored + heat - a driver's work, as the ledger adds them",
     States::everywhere, properties::takes_part_in_balance, properties::balance},
    {"flow", "its operator is the exact solution of its force alone", States::near,
     properties::has_operator, properties::flow},
    {"flow repeats", "its operator gives the same bits from the same stage", States::near,
     properties::has_operator, properties::flow_repeats},
    {"heat of flow", "its operator's heat is the energy that is gone", States::near,
     properties::has_operator, properties::heat_of_flow},
    {"driver", "reports the force it exerts, and force . velocity as its power", States::near,
     [](ForceUnderTest& e) {
       return e.traits().does_work || e.force().driving->drive() != nullptr ||
              e.force().driving->rate_count() != 0;
     },
     properties::driver, properties::reports_if_it_drives},
    {"periodic", "a shift by its period, and by a million, changes nothing", States::near,
     [](ForceUnderTest& e) { return e.traits().periodic || has_period(e); }, properties::periodic,
     properties::declares_period_if_periodic},
    {"rebase", "an origin moved by whole periods changes no bit", States::near,
     [](ForceUnderTest& e) { return has_period(e) && !e.on_prescribed(); }, properties::rebase},
    {"origin", "nothing changes when the origin moves, and all comes back with it", States::near,
     [](ForceUnderTest& e) { return !e.on_prescribed(); }, properties::origin},
    {"velocity", "independent of velocities", States::near,
     [](ForceUnderTest& e) { return !e.traits().depends_on_velocity; }, properties::velocity},
    // To be seen at one state at least.
    {"uses velocity", "depends on velocities, as it declares", States::near,
     [](ForceUnderTest& e) { return e.traits().depends_on_velocity; }, properties::uses_velocity},
    {"time", "force and energy are the same at all times", States::near,
     [](ForceUnderTest& e) { return !e.traits().depends_on_time && !e.on_prescribed(); },
     properties::same_at_all_times, properties::time_is_bound_as_declared},
    {"time", "the same however time is divided into steps", States::near,
     [](ForceUnderTest& e) { return e.traits().depends_on_time && !e.on_prescribed(); },
     properties::divided_time, properties::time_is_bound_as_declared},
    // To be seen at one state at least.
    {"uses time", "depends on time, as it declares", States::near,
     [](ForceUnderTest& e) { return e.traits().depends_on_time && !e.on_prescribed(); },
     properties::uses_time},
    {"repeatable", "the same bits after other evaluations", States::backwards,
     [](ForceUnderTest& e) { return !e.traits().stochastic; }, properties::repeatable,
     properties::evaluate_forwards},
    {"its own", "acts on its own bodies only, and adds to what is there", States::near, always,
     properties::its_own},
    {"set and add", "kernels that set write, over anything, what those that add give to zeros",
     States::near, properties::has_setting_passes, properties::set_and_add},
    {"padding", "beyond the last particle of a body, forces are zero up to a whole group",
     States::near, always, properties::padding},
    {"point", "its kernel for a single particle on a line has the bits of the loop",
     States::everywhere, properties::has_point_kernel, properties::point},
    {"same bits", "on every instruction set of this machine", States::everywhere, always,
     properties::same_bits},
    {"number types", "the same in double and quadruple precision, each to its rounding",
     States::everywhere, has_exact_numbers, properties::number_types},
    // To be seen at one state at least.
    {"digits", "each number type rounds as its precision says", States::near,
     properties::shows_digits, properties::digits},
};

/// The shortest distance between particles that follow one another.
double shortest_spacing(const Model::Body& body) {
  double shortest = 0.0;
  for (std::size_t i = 1; i < body.bound.start.size(); ++i) {
    double square = 0.0;
    for (std::size_t d = 0; d < 3; ++d) {
      const double apart = body.bound.start[i][d] - body.bound.start[i - 1][d];
      square += apart * apart;
    }
    const double distance = std::sqrt(square);
    if (distance > 0.0 && (shortest == 0.0 || distance < shortest)) shortest = distance;
  }
  return shortest;
}

/// 0 where none is declared.
double shortest_length(const Model& model) {
  double shortest = 0.0;
  const auto consider = [&](double length) {
    if (length > 0.0 && (shortest == 0.0 || length < shortest)) shortest = length;
  };
  for (const Model::Force& force : model.forces()) consider(force.diagnosis->shortest_bond());
  for (const SceneForce& force : model.scene().forces) {
    for (int axis = 0; axis < model.dimension(); ++axis) {
      consider(force.record->period(force.description.get(), axis));
    }
  }
  for (const Model::Body& body : model.bodies()) {
    consider(body.rolling_radius);
    consider(shortest_spacing(body));
  }
  return shortest;
}

/// Length of each force: the scene's shortest that is declared, or its own where that is much
/// shorter or nothing is declared. Without either it is that of the other forces; where none has
/// one, how far from the origin bodies are, but at most 1.
std::vector<double> lengths_of(const Scene& scene) {
  const double declared = shortest_length(Model(std::make_shared<Scene>(scene)));
  std::vector<double> lengths(scene.forces.size(), 0.0);
  double shortest = 0.0;
  double reach = 0.0;
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    SingleForce alone(scene, k);
    if (!alone.built() || alone.variables().empty()) continue;
    for (const SingleForce::Variable& variable : alone.variables()) {
      if (variable.axis >= 0) reach = std::max(reach, std::abs(alone.position(variable)));
    }
    lengths[k] = properties::length_of(alone, declared).value_or(declared);
    if (lengths[k] > 0.0 && (shortest == 0.0 || lengths[k] < shortest)) shortest = lengths[k];
  }
  if (shortest == 0.0) shortest = reach > 0.0 ? std::min(reach, 1.0) : 1.0;
  for (double& length : lengths) {
    if (length == 0.0) length = shortest;
  }
  return lengths;
}

}  // namespace

std::vector<PropertyResult> check_properties(const Scene& scene, const PropertyOptions& options) {
  const std::vector<double> lengths = lengths_of(scene);
  std::vector<PropertyResult> results;
  for (std::size_t k = 0; k < scene.forces.size(); ++k) {
    ForceUnderTest force(scene, k, lengths[k], options);
    if (!force.worthwhile()) continue;
    for (const Property& property : kProperties) {
      if (options.stop != nullptr && *options.stop) return results;
      if (auto result = force.check(property)) results.push_back(std::move(*result));
    }
  }
  if (!results.empty()) {
    const double length = *std::min_element(lengths.begin(), lengths.end());
    if (auto result = properties::sum_of_all(scene, length, options)) {
      results.push_back(std::move(*result));
    }
  }
  return results;
}

}  // namespace tomlin
