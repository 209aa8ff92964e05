#pragma once

namespace tomlin {

/// Elements that a force can be evaluated on.
enum class Element { site, pair, triple, surroundings, body };

/// Properties that a force declares. `tomlin check` verifies each; integrators read them.
struct Traits {
  bool conservative = false;  ///< force = -gradient of its energy
  bool depends_on_velocity = false;
  bool depends_on_time = false;
  bool stochastic = false;
  bool internal = false;     ///< forces and torques on its bodies sum to zero
  bool periodic = false;     ///< unchanged when everything moves by its declared period
  bool dissipative = false;  ///< its power is never positive
  bool does_work = false;    ///< a driver: the summary reports its force and work
};

}  // namespace tomlin
