#pragma once

#include <cstddef>
#include <string_view>

#include "framework/core/text/fault.hpp"
#include "framework/model/model.hpp"

namespace tomlin {

/// An observable that has a value at every moment, for whoever waits for it to pass one:
///   bodies.NAME.centre_of_mass.AXIS, bodies.NAME.velocity.AXIS, bodies.NAME.rotation (rad),
///   drivers.NAME.force.AXIS, drivers.NAME.position.AXIS (of the support).
/// The leading "bodies." or "drivers." may be left out.
class Instant {
 public:
  /// Throws InputError, with the nearest name, when there is none of that path; `key` and
  /// `location` say where it was written.
  Instant(const Model& model, std::string_view path, const std::string& key,
          const SourceLocation& location);

  /// The state at a moment. Rates are read where needs_rates() says so.
  struct State {
    DoubleDouble time;
    const double* position = nullptr;
    const double* velocity = nullptr;
    const double* rates = nullptr;
    const double* turns = nullptr;  ///< unwrapped, by body
  };
  bool needs_rates() const { return kind_ == Kind::force; }
  bool needs_turns() const { return kind_ == Kind::rotation; }
  std::size_t index() const { return index_; }  ///< of the body or the driver

  /// The observable less a value, to the last digit however far from the origin.
  double above(const Model& model, const State& state, double value) const;

 private:
  enum class Kind { centre, velocity, rotation, force, position };
  Kind kind_ = Kind::centre;
  std::size_t index_ = 0;
  int axis_ = 0;
};

}  // namespace tomlin
