#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "framework/core/system/instruction_set.hpp"
#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"

namespace tomlin {

/// Estimates for a whole run, made from a few steps.
struct Trial {
  double stable_step = 0.0;          ///< of a fixed-step scheme; infinite where nothing limits it
  bool step_is_stable = true;        ///< false: the scene's step is longer; no step is taken then
  std::optional<FaultCode> failure;  ///< of a step that failed
  bool finished = false;             ///< the trial was the whole run
  std::uint64_t steps = 0;
  std::uint64_t evaluations = 0;  ///< of all forces
  double time = 0.0;              ///< of the scene, reached
  double seconds = 0.0;           ///< of this machine
  RunLayout layout;               ///< what a run would send to its sink
};

/// Binds the scene and steps it for about so many seconds; leaves nothing behind. Throws InputError
/// for everything that a run would refuse, PluginError where the code of a plugin throws.
Trial try_out(const std::shared_ptr<const Scene>& scene, double seconds,
              InstructionSet set = chosen_instruction_set());

/// Layout of a run's data for its sink; nothing where the run would fail before its start.
/// Throws InputError for everything that a run would refuse.
std::optional<RunLayout> layout_of(const std::shared_ptr<const Scene>& scene);

}  // namespace tomlin
