#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "framework/core/records/body.hpp"
#include "framework/core/records/registry.hpp"
#include "framework/core/records/traits.hpp"
#include "framework/core/records/unit_system.hpp"

/// Forces as the registry knows them. What a force becomes when a scene is bound stands in
/// framework/core/records/bound_force.hpp.
namespace tomlin {

template <class Real>
class BoundForce;
template <class Real>
struct Binding;
struct Quad;

template <class Real>
using ForceFactory = std::unique_ptr<BoundForce<Real>> (*)(const void* description,
                                                           const Binding<Real>& binding);

/// Factories by number type. A missing one removes that number type for scenes with this force;
/// the first is required.
struct ForceFactories {
  ForceFactory<double> in_double = nullptr;
  ForceFactory<Quad> in_quadruple = nullptr;

  ForceFactories() = default;
  ForceFactories(ForceFactory<double> d, ForceFactory<Quad> q = nullptr)
      : in_double(d), in_quadruple(q) {}

  template <class Real>
  ForceFactory<Real> in() const {
    if constexpr (std::is_same_v<Real, double>) {
      return in_double;
    } else {
      return in_quadruple;
    }
  }
};

/// Facts about the scene for a force whose description is checked.
struct SceneOutline {
  int dimension = 0;
  std::array<double, 3> box{};  ///< length of each periodic axis, else 0
  struct Body {
    std::string name;
    std::int64_t count = 0;
    bool closed = false;  ///< "neighbours" joins its ends, by its shape or through the box
    NeighbourList neighbours = nullptr;
    std::vector<std::string> species = {};  ///< that its particles are, each once; empty: none
  };
  std::vector<Body> bodies;  ///< those the force acts on, in the order named
  /// Units of the scene's file; `box` and descriptions are in the engine's. For forces, not for
  /// observers.
  UnitSystem units = UnitSystem::reduced;
};

/// Thrown by a factory for what only shows when a scene is bound: how a key of the force does not
/// fit the bodies as they stand.
struct BindError : std::runtime_error {
  explicit BindError(Complaint what) : std::runtime_error(what.why), complaint(std::move(what)) {}
  Complaint complaint;
};

/// For forces whose keys need no checking against each other.
inline std::vector<Complaint> no_complaints(const void*, const SceneOutline&) { return {}; }

/// For forces that hold no pairs.
inline std::uint64_t no_pairs(const void*, const SceneOutline&) { return 0; }

/// For forces that declare no period.
inline double no_period(const void*, int) { return 0.0; }
inline double no_length(const void*) { return 0.0; }
/// For forces whose keys say all.
inline std::string no_note(const void*) { return {}; }

struct ForceRecord : ComponentRecord {
  Element element = Element::site;
  Traits traits;
  /// Keeps its bodies at a temperature without noise; one that is stochastic does so by noise.
  bool thermostat = false;
  /// Traits and element that depend on what a scene asks for; null: as above.
  Traits (*traits_of)(const void* description) = nullptr;
  Element (*element_of)(const void* description) = nullptr;
  int fewest_bodies = 1;
  int most_bodies = 1;
  /// Its numbers and vectors, but for uniform rows, may differ between the particles of its body:
  /// `bind` honours Binding::variations. Scales are those of the numbers of largest size.
  bool varies = false;

  /// Faults across keys and against the bodies; empty when valid.
  std::vector<Complaint> (*complaints)(const void* description,
                                       const SceneOutline& scene) = &no_complaints;
  /// Number of pairs that it will hold, before anything is built: they take memory.
  std::uint64_t (*pairs)(const void* description, const SceneOutline& scene) = &no_pairs;
  /// Period of the force along an axis; 0 when it declares none. The longest period declared on
  /// an axis becomes the unit in which the scene's origin moves.
  double (*period)(const void* description, int axis) = &no_period;
  /// Over which the force changes by all that it changes, where no parameter is such a length; 0
  /// where there is none. Scales exactly with the unit of length, where that is a power of two.
  double (*length)(const void* description) = &no_length;
  /// Text of `explain` on the force besides its keys: of what it was given, how exact it is.
  std::string (*note)(const void* description) = &no_note;

  ForceFactories bind;

  /// Unit in which the scene's origin may move along an axis on which the force has no period, but
  /// phases that it keeps by its own `rebase`; 0 where there is no need to.
  double (*origin_cell)(const void* description, int axis) = &no_period;
};

/// A record for descriptions of this type, otherwise empty.
template <class Description>
ForceRecord record_of() {
  ForceRecord record;
  record.make_description = &make_description<Description>;
  return record;
}

/// The traits of a force as a scene describes it.
inline Traits traits_of(const ForceRecord& record, const void* description) {
  return record.traits_of == nullptr ? record.traits : record.traits_of(description);
}

/// The element that it is evaluated on there.
inline Element element_of(const ForceRecord& record, const void* description) {
  return record.element_of == nullptr ? record.element : record.element_of(description);
}

}  // namespace tomlin
