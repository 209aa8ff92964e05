#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/records/facets.hpp"
#include "framework/core/records/traits.hpp"
#include "framework/core/text/warning.hpp"
#include "framework/model/scales.hpp"
#include "framework/output/output_size.hpp"
#include "framework/scene/scene.hpp"

namespace tomlin {

/// The model that a scene builds, its scales and the cost of running it.
struct Explanation {
  struct Body {
    std::string name;
    std::string type;
    Coordinates coordinates = Coordinates::particles;
    std::size_t particles = 0;
    double mass = 0.0;  ///< of all particles together, in the scene's unit
    std::size_t coordinate_count = 0;
    std::size_t degrees_of_freedom = 0;  ///< coordinates that may move
    double rolling_radius = 0.0;         ///< 0: does not roll
    std::string note;                    ///< what its record says of it; may be empty
  };
  struct Force {
    std::string name;
    std::string type;
    std::vector<std::string> bodies;
    Element element = Element::site;
    std::string note;                          ///< what its record says of it; may be empty
    std::optional<NeighbourCount> neighbours;  ///< at the start; of a force with a cutoff
  };
  /// A part of the engine and whether the scene asks for it.
  struct Part {
    std::string name;
    bool built = false;
    std::string note;
  };
  struct Step {
    std::string type;
    bool adaptive = false;
    std::optional<double> accuracy;  ///< asked for: the run picks an integrator, maybe another
    double dt = 0.0;                 ///< 0: adaptive
    double stable_step = 0.0;        ///< infinite where nothing limits it
    bool stable = true;
    /// Above 1 the step is too long.
    double part_of_stable_step() const { return dt / stable_step; }
  };
  struct Cost {
    double steps = 0.0;
    double evaluations = 0.0;  ///< of all forces
    double seconds = 0.0;
    bool exact = false;  ///< the trial was the whole run
    double part = 0.0;   ///< of the run that was tried
    std::string instruction_set;
  };

  struct Output {
    OutputSize size;
    bool events = false;  ///< whether any can happen
    double room = 0.0;    ///< in the current folder; infinite where it is not known
  };

  std::shared_ptr<const Scene> scene;
  std::vector<Body> bodies;
  std::vector<Force> forces;
  std::vector<std::pair<std::string, std::string>> left_out;  ///< force and why
  std::vector<Part> parts;
  Scales scales;
  Step step;
  std::optional<Cost> cost;  ///< nothing when no step could be tried
  Output output;
  std::vector<Warning> warnings;
};

/// Binds the scene and tries a few steps for up to `trial_seconds`. Throws InputError for
/// everything that a run would refuse.
Explanation explain(const std::shared_ptr<const Scene>& scene, double trial_seconds = 0.1);

/// For people, and for programs.
std::string explanation_text(const Explanation& explanation);
std::string explanation_json(const Explanation& explanation);

}  // namespace tomlin
