#include "framework/core/text/fault_code.hpp"

#include <algorithm>
#include <array>

namespace tomlin {
namespace {

/// Examples that begin with "tomlin" are executed by a test, with the scene of `tomlin new pt` in
/// pt.toml.
constexpr FaultKind kKinds[] = {
    {FaultCode::scene_syntax, "scene.syntax", "The text is not valid TOML 1.0.",
     "tomlin run pt.toml --set 'run.duration=[1,'",
     "Correct the line that the message points at; what is expected there stands in the message."},
    {FaultCode::scene_encoding, "scene.encoding",
     "The text holds bytes that are not UTF-8, or control characters.",
     "A scene saved in Latin-1 with an umlaut in a comment.",
     "Save the file as UTF-8; write control characters in text as escapes, \\u0007."},
    {FaultCode::scene_too_large, "scene.too_large",
     "The scene exceeds a limit of size: bytes, depth of nesting, number of components, particles "
     "or terms of an expression.",
     "A body with more particles than fit into memory.",
     "Reduce what the message names; the limit stands in the message."},
    {FaultCode::scene_duplicate_key, "scene.duplicate_key",
     "A key, a table or an item of a list is given twice.",
     "Two lines stiffness = ... in one table.", "Remove one of the two."},
    {FaultCode::scene_unknown_key, "scene.unknown_key",
     "There is no key, table or parameter of this name at this position.",
     "tomlin run pt.toml --set run.duraton=5",
     "Use one of the admissible keys; the nearest one is suggested. `tomlin describe COMPONENT` "
     "lists the keys of a component."},
    {FaultCode::scene_missing_key, "scene.missing_key", "A required key or table is missing.",
     "A scene without [run].", "Add the key; what it expects stands in the message."},
    {FaultCode::scene_wrong_type, "scene.wrong_type",
     "The value is of another type than the key expects: text instead of a number, a number "
     "instead of a list.",
     "tomlin run pt.toml --set run.duration=true",
     "Write a value of the admissible type; expressions are text in double quotes."},
    {FaultCode::scene_out_of_range, "scene.out_of_range",
     "The number is outside the admissible interval, or not an integer where one is expected.",
     "tomlin run pt.toml --set run.duration=-1", "Choose a value in the interval of the message."},
    {FaultCode::scene_not_finite, "scene.not_finite",
     "A number is infinite or NaN, or becomes so when it is converted or evaluated.",
     "tomlin run pt.toml --set run.duration=nan", "Write a finite number."},
    {FaultCode::scene_wrong_count, "scene.wrong_count",
     "A list is empty, or its length does not fit the dimension, the particles or the other lists.",
     "A velocity of three components in a scene on a line.",
     "Give as many items as the message asks for."},
    {FaultCode::scene_unknown_choice, "scene.unknown_choice",
     "The text is not one of the words that this key accepts.",
     "tomlin run pt.toml --set run.dynamics=inertia", "Use one of the admissible words."},
    {FaultCode::scene_conflict, "scene.conflict",
     "Two keys exclude each other, or a key has a meaning only together with another.",
     "tomlin run pt.toml --set measure.in=time --set measure.driver=driver",
     "Remove one, or add the other."},
    {FaultCode::scene_too_many_faults, "scene.too_many_faults",
     "There are more faults than are shown.", "A file that is not a scene at all.",
     "Correct the faults that are shown first."},
    {FaultCode::scene_unknown_component, "scene.unknown_component",
     "There is no force, body shape, integrator or observer of this type.",
     "tomlin run pt.toml --set run.integrator.type=leapfrog",
     "Use a type that `tomlin describe` lists, or load the plugin that has it."},
    {FaultCode::scene_unknown_name, "scene.unknown_name",
     "A body, force or driver is referred to by a name that nothing in the scene has.",
     "tomlin run pt.toml --set force.driver.body=tipp",
     "Correct the name; those of the scene stand "
     "in the message."},
    {FaultCode::scene_duplicate_name, "scene.duplicate_name", "Two components have the same name.",
     "Two [[force]] tables with name = \"driver\".", "Rename one of the two."},
    {FaultCode::scene_invalid_name, "scene.invalid_name",
     "A name has characters that names cannot have, or has a meaning of its own.",
     "A body called \"drivers\".", "Choose another name, of letters, digits, _ and -."},
    {FaultCode::scene_velocity_unused, "scene.velocity_unused",
     "A body has an initial velocity, and the dynamics have no inertia: velocities follow from "
     "forces or from drivers.",
     "tomlin run pt.toml --set run.dynamics=overdamped --set 'body.tip.velocity=[1.0]'",
     "Remove the velocity, or choose dynamics = \"inertial\".", Severity::warning},
    {FaultCode::scene_force_left_out, "scene.force_left_out",
     "A force of the scene has no effect and is not built, so that `check` has not compared its "
     "properties.",
     "A check of a rigid ring with bonds.",
     "Remove the force, or check it in a scene where it acts; `tomlin explain SCENE` says why it "
     "is left out.",
     Severity::warning},
    {FaultCode::expression_syntax, "expression.syntax", "An expression cannot be parsed.",
     "tomlin run pt.toml --set 'run.duration=\"2 *\"'",
     "Correct the expression at the column of the message."},
    {FaultCode::expression_unknown_name, "expression.unknown_name",
     "An expression uses a parameter, variable or function that does not exist there.",
     "tomlin run pt.toml --set 'run.duration=\"2 * perod\"'",
     "Define the parameter under [parameters], or correct the name."},
    {FaultCode::expression_not_finite, "expression.not_finite",
     "An expression has no finite value: a division by zero, an overflow, or an argument outside "
     "the domain of a function.",
     "tomlin run pt.toml --set 'run.duration=\"1 / 0\"'",
     "Correct the expression or the parameters that it uses."},
    {FaultCode::expression_cycle, "expression.cycle", "Parameters are defined by one another.",
     "[parameters] with a = \"b\" and b = \"a\".", "Give one of them a number."},
    {FaultCode::component_invalid, "component.invalid",
     "Each parameter is admissible by itself, but the component rejects their combination.",
     "tomlin run pt.toml --set "
     "'run.integrator={type=\"dopri5\",smallest_step=1.0,largest_step=0.1}'",
     "See the page of the component: `tomlin describe COMPONENT`."},
    {FaultCode::component_unsuitable, "component.unsuitable",
     "The force, observer or operator cannot act on this body or in this scene: another dimension, "
     "element kind, number type or boundary condition is needed.",
     "A force between bonds on a body without bonds.",
     "Apply it to another body, or use another component."},
    {FaultCode::component_no_species, "component.no_species",
     "The potential has the numbers of one species, and the particles of the body have none: "
     "whatever they are, they get these numbers.",
     "A tube without species beside a tersoff with the numbers of carbon.",
     "Give the body the species that the message names.", Severity::warning},
    {FaultCode::component_other_units, "component.other_units",
     "A published set of numbers is in eV and Angstrom, and the scene is in reduced units: masses, "
     "times and other forces have to be in units that go with these.",
     "A tersoff with a named set in a scene without units = \"metal\".",
     "Take units = \"metal\" in [scene], where masses are in g/mol and times in ps.",
     Severity::warning},
    {FaultCode::body_invalid_coordinates, "body.invalid_coordinates",
     "The coordinates, held axes, prescribed motion or initial state of a body contradict each "
     "other, or particles start nearer to each other than their forces allow for.",
     "A body with coordinates = \"prescribed\" and without motion; a nanotube through a sheet.",
     "Give each body one kind of coordinates, and motion only to prescribed bodies; move bodies "
     "apart."},
    {FaultCode::box_invalid, "box.invalid",
     "The periodic box does not fit the bodies, the forces or the lattice periods.",
     "A periodic length that is not a multiple of the substrate's period.",
     "Choose a box length that fits, as the message says."},
    {FaultCode::integrator_unsuitable, "integrator.unsuitable",
     "The integrator cannot treat this scene.",
     "tomlin run pt.toml --set run.dynamics=overdamped --set run.integrator.type=velocity_verlet",
     "Use one of the admissible integrators; `tomlin explain SCENE` lists them."},
    {FaultCode::integrator_order_reduction, "integrator.order_reduction",
     "The integrator would silently lose its order of convergence in this scene.",
     "A splitting scheme with a force that depends on velocity beside friction.",
     "Use one of the admissible integrators."},
    {FaultCode::integrator_unused, "integrator.unused",
     "Quasistatic dynamics follow equilibria by a scheme of their own; the integrator of the scene "
     "is not used.",
     "tomlin run pt.toml --set run.dynamics=quasistatic", "Remove run.integrator.",
     Severity::warning},
    {FaultCode::integrator_beyond_stability, "integrator.beyond_stability",
     "The fixed step is beyond the stability limit of the integrator, and run.allow_unstable "
     "admits it.",
     "tomlin check pt.toml --set run.integrator.dt=5.0 --set run.allow_unstable=true",
     "Take a step below the limit of the message and remove run.allow_unstable.",
     Severity::warning},
    {FaultCode::integrator_weak_drag, "integrator.weak_drag",
     "The integrator separates friction from forces, and its step is so long beside the time in "
     "which friction stops a motion that the drag is too small by the stated part.",
     "tomlin run pt.toml --set 'run.integrator={type=\"velocity_verlet\",dt=0.1}'",
     "Take a smaller dt, an integrator that treats friction with the forces, or dynamics = "
     "\"overdamped\".",
     Severity::warning},
    {FaultCode::integrator_wide_distribution, "integrator.wide_distribution",
     "With noise and without inertia the scheme makes the distribution of positions in a well too "
     "wide at this step, by a tenth of the variance or more.",
     "A thermal run by euler_maruyama with dt = 0.2 in a well of relaxation rate 1.",
     "Take a smaller dt, or leimkuhler_matthews, which has the variance of harmonic wells exactly.",
     Severity::warning},
    {FaultCode::integrator_unresolved_time, "integrator.unresolved_time",
     "A force or a prescribed motion depends on time and changes within a fixed step.",
     "A force sin(1000 * t) with steps of 0.1.", "Take a smaller dt or an adaptive integrator.",
     Severity::warning},
    {FaultCode::integrator_coarse_tolerance, "integrator.coarse_tolerance",
     "The tolerance of an adaptive integrator does not resolve the scene's shortest length, a "
     "period or half a bond.",
     "tomlin run pt.toml --set "
     "'run.integrator={type=\"dopri5\",absolute_tolerance=0.1,relative_tolerance=0.1}'",
     "Take finer tolerances.", Severity::warning},
    {FaultCode::number_type_unsuitable, "number_type.unsuitable",
     "The number type is not available for a component of the scene.",
     "number_type = \"quadruple\" with a library that has kernels in double precision alone.",
     "Use number_type = \"double\", the default."},
    {FaultCode::number_type_coarse_positions, "number_type.coarse_positions",
     "A body is so far from zero that displacements which matter are lost in the rounding of its "
     "positions.",
     "A ring 1e9 radii above the substrate.", "Start nearer to zero, or use a finer number_type.",
     Severity::warning},
    {FaultCode::matrix_singular, "matrix.singular",
     "A mass, friction or stiffness matrix cannot be inverted.",
     "Overdamped dynamics of a body without friction.",
     "Add mass, friction or a restoring force to the coordinate that the message names."},
    {FaultCode::run_invalid_window, "run.invalid_window",
     "The window of measurement is empty, outside the run, or counted in periods that no force or "
     "several forces have.",
     "tomlin run pt.toml --set measure.from=2.0 --set measure.to=1.0",
     "Correct from and to, or name the driver whose periods are meant."},
    {FaultCode::run_endless, "run.endless",
     "The run would take more steps than can be counted, or its step vanishes beside the time.",
     "tomlin run pt.toml --set run.duration=1e300", "Shorten the run, or lengthen the step."},
    {FaultCode::run_until_never, "run.until_never",
     "The condition of run.until cannot be evaluated in this scene.",
     "until = { steady = ... } without a moving driver; until = { error = ..., of = ... } of what "
     "has no statistical error.",
     "Give a duration instead, or a driver with a period; with error, a mean of a scene with "
     "noise."},
    {FaultCode::run_step_unstable, "run.step.unstable",
     "A coordinate became infinite or NaN, or moved too far in one step: the step is longer than "
     "is stable, or a force diverges.",
     "tomlin run pt.toml --set run.integrator.dt=1e3 --set run.duration=1e6",
     "Shorten the step (`tomlin explain SCENE` shows the stable one), or use an adaptive "
     "integrator; results up to the failure are kept."},
    {FaultCode::run_step_too_small, "run.step.too_small",
     "An adaptive integrator would need a step smaller than the least that changes the time.",
     "A force with a jump, or a tolerance below the rounding errors.",
     "Loosen the tolerance, or smooth the force."},
    {FaultCode::run_step_limit, "run.step.limit",
     "The run needs more steps or force evaluations than allowed.",
     "A stiff scene with an explicit adaptive integrator.",
     "Raise the limit, loosen the tolerance, or use an implicit integrator."},
    {FaultCode::run_no_equilibrium, "run.no_equilibrium",
     "A quasistatic run has found no stable equilibrium.",
     "A body that no force restrains: a zero mode of the stiffness.",
     "Add a force that restrains it, or hold the coordinate."},
    {FaultCode::run_no_accuracy, "run.no_accuracy",
     "The accuracy that was asked for cannot be met by any integrator that suits the scene.",
     "A chaotic scene whose observables depend on the last digit of the start.",
     "Loosen run.accuracy, or name an integrator."},
    {FaultCode::run_stiff_driver, "run.stiff_driver",
     "The error of positions times the stiffness of a driver is a large part of the forces that "
     "resist it: its force is known no better.",
     "tomlin run pt.toml --set k=1e12 --set 'run.integrator={type=\"radau9\"}'",
     "Use a finer tolerance or a softer spring.", Severity::warning},
    {FaultCode::run_far_above_barriers, "run.far_above_barriers",
     "In reduced units the temperature of a bath is more than a hundred times the highest barrier "
     "of the periodic forces on the body, which it then hardly feels.",
     "A run in reduced units with temperature = 300 over a corrugation of amplitude 1.",
     "In reduced units a temperature is an energy: give Boltzmann's constant times the "
     "temperature, "
     "or take units = \"metal\", where it is in K.",
     Severity::warning},
    {FaultCode::run_window_rounding, "run.window_rounding",
     "The window is so short beside the time before its end that the rounding of running integrals "
     "shows in its means.",
     "tomlin run pt.toml --set measure.in=time --set measure.from=700.0 --set "
     "measure.to=700.0000000001",
     "Take a longer window, or begin it earlier.", Severity::warning},
    {FaultCode::run_window_too_short, "run.window_too_short",
     "A driver moves by a small part of a period within the window: the means are those of the "
     "start, not of sliding.",
     "tomlin run pt.toml --set measure.from=0.0 --set measure.to=0.005",
     "Let the run and its window last for whole periods.", Severity::warning},
    {FaultCode::run_window_not_whole, "run.window_not_whole",
     "The window is not a whole number of the periods that a driver passes: the means depend on "
     "where it begins.",
     "tomlin run pt.toml --set measure.to=7.5",
     "Take whole periods, as the message suggests; in = \"driver_periods\" counts them.",
     Severity::warning},
    {FaultCode::run_window_not_steady, "run.window_not_steady",
     "What a driver pulls has not followed it within the window: the means are those of a spring "
     "that is being loaded or unloaded.",
     "tomlin run pt.toml --set k=0.01 --set measure.from=0.0",
     "Begin the window later, and let the run last longer.", Severity::warning},
    {FaultCode::run_few_slips, "run.few_slips",
     "So few of the slips of the run begin within the window that its means depend on single ones.",
     "tomlin run pt.toml --set measure.to=5.0", "Take a longer window.", Severity::warning},
    {FaultCode::run_energy_balance, "run.energy_balance",
     "The energy balance does not close: the integrator itself adds or removes more than a "
     "twentieth of work and heat or, if it is adaptive, more than 300 of its tolerances.",
     "tomlin run pt.toml --set damping=0.0 --set run.integrator.dt=0.5",
     "Take shorter steps or finer tolerances; run.ledger = true gives the whole balance.",
     Severity::warning},
    {FaultCode::run_work_rounding, "run.work_rounding",
     "The work of the drivers is small beside its rounding errors: the motion is so slow that it "
     "dissipates less than double precision resolves.",
     "A driver of velocity 1e-12 with an implicit integrator.",
     "Use dynamics = \"quasistatic\", the limit of slow driving.", Severity::warning},
    {FaultCode::run_bond_beyond_half_box, "run.bond_beyond_half_box",
     "A bond in a periodic box became as long as half the box: it keeps the image of its particle "
     "with which it started, though another one is nearer.",
     "Two bound particles that are pulled apart by more than half the periodic length.",
     "Take a larger box; a force between nearest images is an expression of r.", Severity::warning},
    {FaultCode::run_zero_mode, "run.zero_mode",
     "The equilibrium at the end of a quasistatic run has a direction in which no force holds the "
     "bodies: they stay at their position along it.",
     "A free body without any force, in quasistatic dynamics.",
     "Add a force that restrains it, or hold the coordinate.", Severity::warning},
    {FaultCode::run_tie, "run.tie",
     "An equilibrium has become unstable in a symmetric scene: rounding alone decides which one "
     "follows.",
     "A particle on the maximum of a substrate whose amplitude grows, in quasistatic dynamics.",
     "Break the symmetry by a small force; run.perturb shows how far results differ.",
     Severity::warning},
    {FaultCode::run_reverse_passed, "run.reverse_passed",
     "The observable at which a driver reverses is beyond its value at the start already; the "
     "driver reverses when it passes the value.",
     "tomlin run pt.toml --set 'force.driver.reverse={when=\"driver.force.x\",above=-1.0}'",
     "Start on the other side, or choose another value.", Severity::warning},
    {FaultCode::run_until_slowest_unknown, "run.until_slowest_unknown",
     "The scene has too many coordinates for its slowest internal time to be computed: run.until "
     "relies on how the observable has changed so far.",
     "A chain of 2000 particles that runs until its force is steady.", "Compare with a longer run.",
     Severity::warning},
    {FaultCode::run_until_not_steady, "run.until_not_steady",
     "The observable of run.until is not steady to the tolerance by the latest time.",
     "tomlin run pt.toml --set "
     "'run.until={steady=\"driver.mean_force.x\",tolerance=1e-9,max=200.0}'",
     "Raise max, or the tolerance.", Severity::warning},
    {FaultCode::run_until_error_not_reached, "run.until_error_not_reached",
     "The statistical error of the mean of run.until is larger than asked for at the latest time, "
     "or is not known there.",
     "A thermal run with until = { error = 1e-6, of = \"driver.mean_force.x\" } and a short "
     "duration.",
     "Raise the duration, or max, or ask for less.", Severity::warning},
    {FaultCode::run_not_determined, "run.not_determined",
     "Runs from slightly different starts share fewer than three digits of an observable.",
     "tomlin run pt.toml --set damping=0.02 --set 'run.perturb={size=0.1,repeats=3}'",
     "Take the mean and the spread of many runs, or an observable that is determined.",
     Severity::warning},
    {FaultCode::run_perturb_failed, "run.perturb_failed",
     "A run from a perturbed start, or a repeat, failed; the results are those of the other ones.",
     "tomlin run pt.toml --set 'run.perturb={size=1e300,repeats=2}'",
     "Take a smaller size in run.perturb, or a shorter step.", Severity::warning},
    {FaultCode::run_comparison_stopped, "run.comparison_stopped",
     "The run itself is complete, and was stopped during the runs beside it: from perturbed "
     "starts, "
     "with a coarser integrator, or repeats.",
     "An interrupt during the repetitions of run.perturb.", "Resume the run with --resume.",
     Severity::warning},
    {FaultCode::run_accuracy_not_reached, "run.accuracy_not_reached",
     "The estimated error of the results, or that of the most accurate setting that was found "
     "before the run, is larger than run.accuracy.",
     "tomlin run pt.toml --set run.accuracy=1e-15",
     "Ask for less, or name an integrator and its step.", Severity::warning},
    {FaultCode::run_accuracy_no_reference, "run.accuracy_no_reference",
     "No adaptive integrator finished its trial run, which the others are compared with: the "
     "errors of the settings are not known.",
     "A scene whose trial runs with fine tolerances would take too long.",
     "Name an integrator and its step.", Severity::warning},
    {FaultCode::run_accuracy_no_pilot, "run.accuracy_no_pilot",
     "No integrator finished the trial runs that run.accuracy is based on; the one that the scene "
     "has by default is taken with its defaults.",
     "A scene with so many coordinates that trial runs would take too long.",
     "Name an integrator and its step.", Severity::warning},
    {FaultCode::run_error_not_estimated, "run.error_not_estimated",
     "The results have no estimated error: no coarser run is possible, it failed, or it would cost "
     "too much; or, with noise, the window is shorter than 50 correlation times.",
     "A scene whose steps are limited by stability, so that a coarser run is not cheaper.",
     "Estimate it by a run with half the step; with noise, run longer, or take repeats.",
     Severity::warning},
    {FaultCode::observable_unknown, "observable.unknown",
     "There is no observable of this name in the scene.",
     "tomlin run pt.toml --set 'measure.observables=[\"driver.mean_forse.x\"]'",
     "Use one of the names that `tomlin explain SCENE` lists."},
    {FaultCode::observable_undefined, "observable.undefined",
     "The observable exists and has no value in this run.",
     "A period of slips in a run without slips.", "Choose another observable, or a longer run."},
    {FaultCode::compare_different_setups, "compare.different_setups",
     "The scenes that are compared differ in what has to be equal.",
     "A comparison of two scenes with different driving velocities.",
     "Make the quantity that the message names equal in all scenes."},
    {FaultCode::file_cannot_read, "file.cannot_read", "A file or folder cannot be read.",
     "tomlin run missing.toml", "Check its name and permissions."},
    {FaultCode::file_cannot_write, "file.cannot_write",
     "A file or folder cannot be made or written.", "tomlin run pt.toml -o /proc/results",
     "Choose another folder, or make room."},
    {FaultCode::file_exists, "file.exists",
     "Writing would replace a file that is there already, or one that the run reads.",
     "A second tomlin run of the same scene without --force.",
     "Choose another name; for a run, --force starts again and --resume continues."},
    {FaultCode::file_invalid, "file.invalid", "The file is not of the kind that is expected there.",
     "tomlin plot pt.toml -o force.svg", "Give a file or folder of the expected kind."},
    {FaultCode::file_damaged, "file.damaged",
     "A checkpoint, journal or result is truncated or corrupted: a checksum is wrong or a record "
     "is missing.",
     "A journal that was cut by hand.", "Start the run again with --force."},
    {FaultCode::folder_in_use, "folder.in_use", "Another run writes into this folder.",
     "Two runs with the same -o at the same time.", "Wait for it, or choose another folder."},
    {FaultCode::resume_impossible, "resume.impossible",
     "The folder holds nothing that a run can continue from.",
     "--resume of a folder whose checkpoint was removed.", "Start the run again with --force."},
    {FaultCode::resume_other_scene, "resume.other_scene",
     "The run in the folder is of another scene, or its files belong to different runs.",
     "--resume after a change of a parameter.",
     "Resume with the scene of that run, or start again with --force."},
    {FaultCode::resume_other_version, "resume.other_version",
     "The checkpoint was written by another version of the program or of a plugin, which would "
     "not continue with the same bits.",
     "--resume after an update.", "Resume with that version, or start again with --force."},
    {FaultCode::output_too_large, "output.too_large",
     "The run would write more than there is room or than is allowed.",
     "tomlin run pt.toml --set output.every=1e-9",
     "Sample more rarely, or allow it as the message "
     "says."},
    {FaultCode::output_events_dropped, "output.events_dropped",
     "The run has more events than are kept: events.csv has the first ones, and all are counted.",
     "A run of more than a million slips.", "Run a part of it for the later events.",
     Severity::warning},
    {FaultCode::plot_no_data, "plot.no_data",
     "The folder has no column, body or sample that the figure needs.",
     "A figure of a run whose scene has no [output].",
     "Choose another figure or column, or run with it."},
    {FaultCode::plot_no_matplotlib, "plot.no_matplotlib",
     "Figures are drawn by matplotlib in Python, which is not there.",
     "A machine without matplotlib.",
     "Install it (Debian: python3-matplotlib), and build the Python module, ./dev python."},
    {FaultCode::command_unknown, "command.unknown", "There is no command of this name.",
     "tomlin rum", "`tomlin --help` lists the commands."},
    {FaultCode::command_unknown_option, "command.unknown_option",
     "The command has no such option, or does not expect this argument.",
     "tomlin run pt.toml --thread=2", "`tomlin COMMAND --help` lists the options."},
    {FaultCode::command_missing_argument, "command.missing_argument",
     "An argument or the value of an option is missing.", "tomlin run",
     "`tomlin COMMAND --help` shows what is expected."},
    {FaultCode::command_invalid_value, "command.invalid_value",
     "An option or argument has a value that it cannot have.",
     "tomlin compare pt.toml pt.toml --observable driver.mean_force.x --tolerance -1",
     "Give an admissible value."},
    {FaultCode::command_conflict, "command.conflict", "Two options exclude each other.",
     "tomlin run pt.toml --resume --force", "Give one of them."},
    {FaultCode::plugin_cannot_load, "plugin.cannot_load",
     "The plugin cannot be found, read or loaded, or registers nothing valid.",
     "tomlin run pt.toml --plugin missing.so", "Check the file; build it with tomlin_add_plugin."},
    {FaultCode::plugin_mismatch, "plugin.mismatch",
     "The plugin was built for another version, compiler or number type.",
     "A plugin that was built before an update.", "Build it again."},
    {FaultCode::plugin_error, "plugin.error",
     "Code of a plugin has thrown an exception or returned nothing.",
     "A force that throws in its constructor.", "Report it to the plugin's author."},
    {FaultCode::machine_instruction_set, "machine.instruction_set",
     "The instruction set that was asked for is unknown, or this processor lacks it.",
     "TOMLIN_INSTRUCTION_SET=avx512 on a processor without it.",
     "Remove TOMLIN_INSTRUCTION_SET; the best available one is used."},
    {FaultCode::program_internal_error, "program.internal_error",
     "An exception that the program did not expect: a defect of tomlin.", "None is known.",
     "Report it with the scene and the command."},
};

constexpr bool in_order() {
  for (std::size_t k = 0; k < std::size(kKinds); ++k) {
    if (static_cast<std::size_t>(kKinds[k].code) != k) return false;
  }
  return true;
}
static_assert(in_order() &&
              std::size(kKinds) == static_cast<std::size_t>(FaultCode::program_internal_error) + 1);

}  // namespace

std::string_view to_string(Severity severity) {
  return severity == Severity::warning ? "warning" : "error";
}

std::span<const FaultKind> fault_kinds() { return kKinds; }

const FaultKind& kind_of(FaultCode code) { return kKinds[static_cast<std::size_t>(code)]; }

std::string_view id_of(FaultCode code) { return kind_of(code).id; }

std::optional<FaultCode> fault_code_of(std::string_view id) {
  const auto found = std::find_if(std::begin(kKinds), std::end(kKinds),
                                  [id](const FaultKind& kind) { return kind.id == id; });
  if (found == std::end(kKinds)) return std::nullopt;
  return found->code;
}

}  // namespace tomlin
