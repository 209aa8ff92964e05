#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace tomlin {

/// The kind of a diagnostic, an error or a warning. Its identifier (`scene.unknown_key`) is stable:
/// scripts and tests may rely on it, while wording may change. A new code stands here and has a row
/// in fault_code.cpp.
enum class FaultCode {
  // The text of a scene.
  scene_syntax,
  scene_encoding,
  scene_too_large,
  scene_duplicate_key,
  // Keys and values.
  scene_unknown_key,
  scene_missing_key,
  scene_wrong_type,
  scene_out_of_range,
  scene_not_finite,
  scene_wrong_count,
  scene_unknown_choice,
  scene_conflict,
  scene_too_many_faults,
  // Components and their names.
  scene_unknown_component,
  scene_unknown_name,
  scene_duplicate_name,
  scene_invalid_name,
  scene_velocity_unused,
  scene_force_left_out,
  // Expressions and parameters.
  expression_syntax,
  expression_unknown_name,
  expression_not_finite,
  expression_cycle,
  // These are consistent as text and not as physics.
  component_invalid,
  component_unsuitable,
  component_no_species,
  component_other_units,
  body_invalid_coordinates,
  box_invalid,
  integrator_unsuitable,
  integrator_order_reduction,
  integrator_unused,
  integrator_beyond_stability,
  integrator_weak_drag,
  integrator_wide_distribution,
  integrator_unresolved_time,
  integrator_coarse_tolerance,
  number_type_unsuitable,
  number_type_coarse_positions,
  matrix_singular,
  // A run.
  run_invalid_window,
  run_endless,
  run_until_never,
  run_step_unstable,
  run_step_too_small,
  run_step_limit,
  run_no_equilibrium,
  run_no_accuracy,
  run_stiff_driver,
  run_far_above_barriers,
  run_window_rounding,
  run_window_too_short,
  run_window_not_whole,
  run_window_not_steady,
  run_few_slips,
  run_energy_balance,
  run_work_rounding,
  run_bond_beyond_half_box,
  run_zero_mode,
  run_tie,
  run_reverse_passed,
  run_until_slowest_unknown,
  run_until_not_steady,
  run_until_error_not_reached,
  run_not_determined,
  run_perturb_failed,
  run_comparison_stopped,
  run_accuracy_not_reached,
  run_accuracy_no_reference,
  run_accuracy_no_pilot,
  run_error_not_estimated,
  observable_unknown,
  observable_undefined,
  compare_different_setups,
  // Files and folders.
  file_cannot_read,
  file_cannot_write,
  file_exists,
  file_invalid,
  file_damaged,
  folder_in_use,
  resume_impossible,
  resume_other_scene,
  resume_other_version,
  output_too_large,
  output_events_dropped,
  plot_no_data,
  plot_no_matplotlib,
  // The command line and the machine.
  command_unknown,
  command_unknown_option,
  command_missing_argument,
  command_invalid_value,
  command_conflict,
  plugin_cannot_load,
  plugin_mismatch,
  plugin_error,
  machine_instruction_set,
  program_internal_error,
};

enum class Severity { error, warning };

/// "error", "warning".
std::string_view to_string(Severity severity);

/// One row of the table of diagnostics.
struct FaultKind {
  FaultCode code;
  std::string_view id;       ///< "scene.unknown_key"
  std::string_view meaning;  ///< one or two sentences
  std::string_view example;  ///< a command line that gives this diagnostic, or a situation
  std::string_view cure;     ///< what to do
  Severity severity = Severity::error;
};

/// All codes, in the order of the enumeration.
std::span<const FaultKind> fault_kinds();
const FaultKind& kind_of(FaultCode code);
std::string_view id_of(FaultCode code);
/// Nothing where no code has this identifier.
std::optional<FaultCode> fault_code_of(std::string_view id);

}  // namespace tomlin
