#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "framework/core/records/force.hpp"
#include "framework/core/records/integrator.hpp"
#include "framework/core/records/registry.hpp"
#include "framework/scene/language.hpp"

/// Everything that can be described, for text, JSON and the reference pages.
namespace tomlin {

/// A component and how a scene takes it.
struct Described {
  std::string kind;
  const ComponentRecord* record = nullptr;
  TableLayout layout;
  const ForceRecord* force = nullptr;            ///< null for another kind
  const IntegratorRecord* integrator = nullptr;  ///< likewise
};

/// Singular and plural of the name of a kind.
using KindNames = std::pair<const char*, const char*>;
inline constexpr std::array kKinds = {KindNames{"body", "bodies"}, KindNames{"force", "forces"},
                                      KindNames{"integrator", "integrators"},
                                      KindNames{"observer", "observers"}};

/// By kind, then as registered.
std::vector<Described> all_components(const Registry& registry);
std::vector<const Described*> those_of(std::string_view kind, const std::vector<Described>& all);

/// A declared property or an ability, and whether the component has it.
using Declaration = std::pair<const char*, bool>;

std::array<Declaration, 8> declared(const Traits& traits);
std::array<Declaration, 7> abilities(const IntegratorRecord& record);

/// "each particle", "pairs of particles", "a body as a whole, or particles of it".
const char* to_string(Element element);

/// "pairs of particles, of 1 to 2 bodies": what a force is evaluated on.
std::string acts_on(const ForceRecord& force);

/// "conservative", "order 4", "adaptive steps": what a component is said to be.
std::vector<std::string> trait_words(const Described& component);

/// "double", "quadruple": those that it is there for; none for a body.
std::vector<std::string> number_types(const Described& component);

/// "a, b, c", all of them.
std::string joined(const std::vector<std::string>& words);

/// "required", "default 1.0", "may be absent".
std::string default_text(const Parameter& row);

}  // namespace tomlin
