#include "framework/cli/described.hpp"

#include <fmt/format.h>

#include "framework/core/records/body.hpp"
#include "framework/core/records/observer.hpp"
#include "framework/scene/effective.hpp"
#include "framework/scene/natural_units.hpp"

namespace tomlin {
namespace {

template <class Record>
std::vector<std::string> number_types_of(const Record& record) {
  std::vector<std::string> types;
  if (record.bind.in_double) types.emplace_back(to_string(NumberType::double_precision));
  if (record.bind.in_quadruple) types.emplace_back(to_string(NumberType::quadruple_precision));
  return types;
}

template <class Declarations>
void append_held(std::vector<std::string>& words, const Declarations& given) {
  for (const auto& [name, holds] : given) {
    if (holds) words.emplace_back(name);
  }
}

}  // namespace

std::vector<Described> all_components(const Registry& registry) {
  std::vector<Described> all;
  for (const auto& record : registry.bodies()) {
    all.push_back({"body", record.get(), body_layout(*record), nullptr, nullptr});
  }
  for (const auto& record : registry.forces()) {
    all.push_back({"force", record.get(), force_layout(*record), record.get(), nullptr});
  }
  for (const auto& record : registry.integrators()) {
    all.push_back({"integrator", record.get(), integrator_layout(*record), nullptr, record.get()});
  }
  for (const auto& record : registry.observers()) {
    all.push_back({"observer", record.get(), observer_layout(*record), nullptr, nullptr});
  }
  return all;
}

std::vector<const Described*> those_of(std::string_view kind, const std::vector<Described>& all) {
  std::vector<const Described*> found;
  for (const Described& component : all) {
    if (component.kind == kind) found.push_back(&component);
  }
  return found;
}

std::array<Declaration, 8> declared(const Traits& traits) {
  return {Declaration{"conservative", traits.conservative},
          Declaration{"depends on velocity", traits.depends_on_velocity},
          Declaration{"depends on time", traits.depends_on_time},
          Declaration{"stochastic", traits.stochastic},
          Declaration{"internal", traits.internal},
          Declaration{"periodic", traits.periodic},
          Declaration{"dissipative", traits.dissipative},
          Declaration{"does work", traits.does_work}};
}

std::array<Declaration, 7> abilities(const IntegratorRecord& record) {
  return {Declaration{"adaptive", record.adaptive},
          Declaration{"takes scenes without inertia", record.without_inertia},
          Declaration{"takes friction as an operator", record.splits_friction},
          Declaration{"takes bonds as an operator", record.splits_bonds},
          Declaration{"needs derivatives of the forces", record.needs_tangent},
          Declaration{"only for scenes without friction", record.conservative_only},
          Declaration{"follows equilibria", record.follows_equilibria}};
}

const char* to_string(Element element) {
  switch (element) {
    case Element::site:
      return "each particle";
    case Element::pair:
      return "pairs of particles";
    case Element::triple:
      return "angles of three particles";
    case Element::surroundings:
      return "each particle and its neighbours";
    case Element::body:
      return "a body as a whole, or particles of it";
  }
  return "";
}

std::string acts_on(const ForceRecord& force) {
  std::string text = to_string(force.element);
  if (force.element_of != nullptr) {
    text = "particles, pairs, angles or a body as a whole, as a scene says";
  }
  if (force.most_bodies == 1) return text;
  if (force.fewest_bodies == force.most_bodies) {
    return text + fmt::format(", of {} bodies", force.most_bodies);
  }
  return text + fmt::format(", of {} to {} bodies", force.fewest_bodies, force.most_bodies);
}

std::vector<std::string> trait_words(const Described& component) {
  std::vector<std::string> words;
  if (component.force != nullptr && component.force->traits_of != nullptr) {
    words.emplace_back("properties depend on the scene");
  } else if (component.force != nullptr) {
    append_held(words, declared(component.force->traits));
  }
  if (component.integrator != nullptr) {
    const IntegratorRecord& record = *component.integrator;
    words.push_back(fmt::format("order {}", record.order));
    if (!record.adaptive) words.emplace_back("fixed steps");
    words.push_back(
        fmt::format("{} evaluations of all forces per step", record.evaluations_per_step));
    append_held(words, abilities(record));
  }
  return words;
}

std::vector<std::string> number_types(const Described& component) {
  if (component.force != nullptr) return number_types_of(*component.force);
  if (component.integrator != nullptr) return number_types_of(*component.integrator);
  return {};
}

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

std::string default_text(const Parameter& row) {
  if (row.required()) return "required";
  const auto standard = row.standard ? to_node(*row.standard) : std::nullopt;
  if (!standard) return "may be absent";
  return "default " + value_text(*standard) + natural_unit_text(row);
}

}  // namespace tomlin
