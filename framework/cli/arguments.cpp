#include "framework/cli/arguments.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "framework/cli/plot_text.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/core/text/nearest_name.hpp"

namespace tomlin {
namespace {

constexpr const char* kVersion = "tomlin " TOMLIN_VERSION;

struct LaterCommand {
  const char* name;
  const char* what;
};

constexpr std::array kLaterCommands = {
    LaterCommand{"sweep", "many runs over the values of parameters"},
    LaterCommand{"stability", "thresholds and equilibria"},
    LaterCommand{"merge", "the parts of a sweep into one"},
    LaterCommand{"export", "input files for LAMMPS"},
    LaterCommand{"report", "a web page of a run"},
};

constexpr const char* kProgramFooter = R"(
A first run. Write this to pt.toml, the Prandtl-Tomlinson model:

  [parameters]
  v = 1e-2

  [[body]]
  type = "point"
  position = [0.5]                 # in a well: x = 0 is a maximum of the substrate
  particle_mass = 1.0

  [[force]]
  type = "driving_spring"
  stiffness = 2.0
  velocity = ["v"]

  [[force]]
  type = "viscous_damping"
  coefficient = 2.0

  [[force]]
  type = "sinusoidal_substrate"
  amplitude = 0.1
  period = 1.0

  [run]
  duration = 1000.0
  integrator = { type = "rk4", dt = 1e-2 }

  [output]
  every = 1.0

and type

  tomlin run pt.toml

The mean lateral force is printed; pt.out/ then holds summary.json with all results,
observables.csv with the friction trace, and scene.toml, the scene with every default filled in.

  tomlin run --help            how to change parameters and choose the folder
  tomlin explain pt.toml       its scales, its regime, the stable step, what a run costs
  tomlin check pt.toml         is the scene sound, and do its forces what they claim
  tomlin new pt|fk|ring        a commented scene to start from
  tomlin describe expression   a force of one's own as a formula in the scene
  tomlin new plugin NAME       a force of one's own in C++, with its test
  tomlin describe              the bodies, forces, integrators and observers
  tomlin describe NAME         one of them: equation, source, parameters, an example
  tomlin schema                with which editors complete and check scenes
  tomlin plot pt.out -o a.svg  the friction trace
  tomlin tradeoff pt.toml --observable driver.mean_force.x
                               measure the cost of accuracy and find the cheapest setting

Exit status: 0 done; 1 a run or a check failed; 2 the input was not right, and nothing was done.)";

constexpr const char* kRunFooter = R"(
Examples:

  tomlin run pt.toml
      writes to pt.out/ in the current folder.
  tomlin run pt.toml --set v=1e-3 -o slow
      the parameter v has another value; writes to slow/.
  tomlin run pt.toml --set "v=V0/10" --set run.integrator.dt=1e-3 --force
      an expression over [parameters]; a dotted path; pt.out/ may hold an earlier run.

PATH is a parameter's name or a dotted path such as run.duration, body.ring.coordinates or
force.driver.stiffness, with a component's name, or its type where it has none. VALUE is as in a
scene: a number, true, [1.0, 0.0], a word or an expression.

  tomlin run pt.toml --resume
      resumes the run that was stopped in pt.out/, or starts it if there is none.

DIR then holds
  summary.json      mean, static and extreme forces, work, motion of the bodies, warnings
  observables.csv   the samples in time, when the scene has [output] every
  events.csv        slips, turns and the like: when, how large
  scene.toml        the scene with all defaults filled in; running it gives the same bits
and, while the run is going on or after it was stopped, what it can be resumed from
  run.checkpoint    kept every [run] checkpoint_every seconds
  run.journal       all samples and events so far

Ctrl-C ends a run early and leaves what is known so far, with a checkpoint; a second Ctrl-C ends it
at once. A run that was stopped, was killed or ran out of disk space resumes with --resume, from the last
checkpoint to the same bits as one that was left alone. The scene must be the same, and so must the
version of tomlin.

Exit status: 0 done; 1 the run failed numerically (the message says when, where and why) or its
results could not be written; 2 the input was not right, and nothing was written; 130 or 143 after
an interrupt.)";

constexpr const char* kPluginFooter = R"(
A force that tomlin does not have is compiled into a shared library; tomlin new plugin NAME writes
one to start from. A scene names its libraries above its first [table], relative to its own folder:

  plugins = ["libmorse.so"]

or --plugin does, relative to the current folder. Both load it from that place and no other. See
also tomlin describe --plugin LIB.)";

constexpr const char* kTradeoffFooter = R"(
Computes one number of the scene's summary in every way that applies: by every integrator from
coarse to fine, in double and in float, and by simpler models of the scene (flexible bodies as rigid
ones, without inertia, quasistatic). Each is held against a reference whose own error is established:
the best scheme tightened until the number stops moving, checked by a scheme of another family and
in quadruple numbers. Shows what accuracy costs, in force evaluations with Jacobian columns and in
seconds, and recommends the cheapest setting whose error is below T, as lines of a scene.

Examples:

  tomlin tradeoff pt.toml --observable driver.mean_force.x --tolerance 1e-4
  tomlin tradeoff pt.toml --observable driver.mean_force.x --set v=1e-3 --write cheap.toml

T is relative to the number itself; where that is zero, as far as the reference knows it, T is in its
unit. The error that a setting is recommended by keeps a fifth below T.

The number is also computed from starts that differ by 1e-12 and 1e-9 of a period: when that moves it
by more than T and than ten times the estimated error of the steps, it is not determined by the
scene; then the digits that have a meaning are told, and nothing is recommended for the others.

A run that does not fit into the budget is left out, and listed with how far it got.

DIR then holds
  tradeoff.csv      every point: rung (the method), step or tolerance, value, error, cost
  tradeoff.json     the same with the reference, what was left out and the recommendation
  tradeoff.svg      error against cost, when there is gnuplot

Exit status: 0 done, whatever was found; 1 the results could not be written; 2 the input was not
right, and nothing was written; 130 or 143 after an interrupt.)";

constexpr const char* kCompareFooter = R"(
Runs every scene, estimates its error by a second run with other steps, and holds one number of the
summary against that of the model with the most free coordinates. Shows value, error and cost of
each, and which is the simplest that agrees within T (relative; absolute where the number is zero).
A model agrees when it does so even if both errors are taken in full; where the errors alone are
larger than T it is undecided.

Models are comparable when their drivers have the same velocity and their forces the same periods;
other scenes are refused. Another stiffness or amplitude is noted.

In --observable "driver" and "body" stand for the only driver and the only body of each scene.

Examples:

  tomlin compare tip.toml ring.toml --observable driver.mean_force.x
  tomlin compare tip.toml chain.toml ring.toml --observable driver.mean_force.x --tolerance 1e-3

DIR then holds
  compare.csv       a row for each model
  compare.json      the same, with notes and warnings
  compare.svg       the forces of the drivers over their way, when there is gnuplot

Exit status: 0 done; 1 a run failed, or the results could not be written; 2 the input was not right,
and nothing was written; 130 or 143 after an interrupt.)";

constexpr const char* kExplainFooter = R"(
Shows, without running the scene:

  built          bodies, coordinates, forces; what is left out and why; what was not asked for
  scales         natural frequencies, damping and its regime, the stick-slip parameter, the
                 washboard frequency, spacing against period
  time step      against the stable step of the integrator. A step that is too long is shown, and
                 refused by run.
  cost           steps, force evaluations and time, from a trial of a tenth of a second
  output         rows and bytes of what a run would write at most, and the room that there is

Examples:

  tomlin explain pt.toml
  tomlin explain pt.toml --set v=1e-3 --json

Exit status: 0 done; 2 the scene is not right.)";

constexpr const char* kCheckFooter = R"(
Reads and binds the scene as run does, compares a fixed step with the stable step, and holds every
force against its own claims on this scene's bodies: at the start, near it, far away, high above it,
and with two particles almost touching:

  conservative, exact, path   its force is minus the gradient of its energy
  hessian                     its second derivatives are the slopes of its force
  finite                      there are numbers wherever there can be
  internal                    its forces and torques sum to zero
  dissipative, friction       its power is never positive; its friction matrix is right
  balance, driver             power, stored energy, heat and a driver's work add up
  periodic, origin            a shift by its period, or of the origin, changes nothing
  velocity, time, repeatable  it depends on nothing that it does not tell of
  its own                     it acts on its own bodies only
  same bits, number types     every instruction set and number type says the same

Where all holds that is said in one line; --verbose shows every check, with its largest error and what
is allowed there. A claim that does not hold is shown with the state, particle, place and time where it
broke, and with both numbers.

Examples:

  tomlin check pt.toml
  tomlin check pt.toml --verbose
  tomlin check pt.toml --set run.integrator.dt=0.1 --json

With --json faults of the scene are listed on standard output.

Exit status: 0 all checks hold; 1 one does not; 2 the scene is not right.)";

constexpr const char* kNewFooter = R"(
Models:

  pt      one tip on a substrate: Prandtl-Tomlinson
  fk      a driven chain of particles and springs: Frenkel-Kontorova
  ring    a ring that drags, rolls or hops
  plugin  no scene but a folder: a force of one's own in C++, with a CMake file, a scene and a test

Examples:

  tomlin new pt                  writes pt.toml, a scene with comments that runs as it is
  tomlin new ring my_ring        writes my_ring.toml
  tomlin new fk -o scenes/a.toml
  tomlin new plugin my_force     writes the folder my_force

Exit status: 0 done; 1 the file could not be written; 2 the input was not right.)";

constexpr const char* kDescribeFooter = R"(
Examples:

  tomlin describe                          all components in a line each
  tomlin describe sinusoidal_substrate     equation, source, parameters, an example that runs
  tomlin describe force                    the forces, and the keys that each of them takes
  tomlin describe run                      the keys of a table of the scene
  tomlin describe results                  what summary.json has, with dimensions and meanings
  tomlin describe diagnostics              the codes of errors and warnings
  tomlin describe scene.unknown_key        what one of them means, an example and a cure
  tomlin describe rk4 --json               the same for programs
  tomlin describe rk4 --markdown           the same for a page
  tomlin describe --markdown -o DIR        all of it as pages, DIR/forcefields/REFERENCE.md ...)";

constexpr const char* kSchemaFooter = R"(
With it an editor completes and checks scenes while they are written: keys, types, words, ranges,
each with its unit and default. With Taplo (Even Better TOML in VS Code, and others) the first line
of a scene names it:

  #:schema ./tomlin.schema.json

What only holds between several values (names of bodies, ends of windows, stable steps), and what
expressions say, is seen by tomlin check SCENE.

Examples:

  tomlin schema -o tomlin.schema.json
  tomlin schema > tomlin.schema.json)";

[[noreturn]] void refuse(FaultCode code, std::string why, std::string nearest = "",
                         std::string admissible = "") {
  refuse_input(code, "tomlin", "", std::move(why), std::move(admissible), std::move(nearest));
}

/// CLI11 has one kind of error for too few values and for too many.
FaultCode code_of(const CLI::ParseError& error) {
  const std::string_view text = error.what();
  switch (static_cast<CLI::ExitCodes>(error.get_exit_code())) {
    case CLI::ExitCodes::RequiredError:
    case CLI::ExitCodes::RequiresError:
      return FaultCode::command_missing_argument;
    case CLI::ExitCodes::ExcludesError:
      return FaultCode::command_conflict;
    case CLI::ExitCodes::ArgumentMismatch:
      return text.ends_with("missing") || text.find("least") != std::string_view::npos
                 ? FaultCode::command_missing_argument
                 : FaultCode::command_invalid_value;
    default:
      return FaultCode::command_invalid_value;
  }
}

bool is_option(std::string_view word) { return word.size() > 1 && word.front() == '-'; }

constexpr std::array kCommands = {"run", "tradeoff", "compare", "explain", "check",
                                  "new", "describe", "schema",  "plot"};

std::string all_commands() {
  return fmt::format("{}; tomlin --help tells more", fmt::join(kCommands, ", "));
}

/// The command must be one of ours. Those to come take any arguments.
void check_command(std::string_view word) {
  std::vector<std::string> names(kCommands.begin(), kCommands.end());
  if (std::find(names.begin(), names.end(), word) != names.end()) return;
  for (const LaterCommand& later : kLaterCommands) {
    if (word == later.name) {
      refuse(FaultCode::command_not_in_this_version,
             fmt::format("\"{}\" is not in this version", word));
    }
    names.emplace_back(later.name);
  }
  refuse(FaultCode::command_unknown, fmt::format("there is no command \"{}\"", word),
         nearest_name(word, names).value_or(""), all_commands());
}

/// An option without a command: of the program itself.
void check_option(std::string_view word) {
  static const std::vector<std::string> names = {"-h", "--help", "--version"};
  if (std::find(names.begin(), names.end(), word) != names.end()) return;
  refuse(FaultCode::command_unknown_option, fmt::format("tomlin has no option {}", word),
         nearest_name(word, names).value_or(""), "tomlin --help shows them");
}

/// "PATH=VALUE" each.
std::vector<Setting> settings_of(const std::vector<std::string>& texts) {
  std::vector<Setting> settings;
  std::vector<Fault> faults;
  for (const std::string& text : texts) {
    const auto equals = text.find('=');
    if (equals == std::string::npos) {
      faults.emplace_back(FaultCode::command_missing_argument, Place{"--set"},
                          text.empty() ? "\"\"" : text, "", "no value", "PATH=VALUE");
      continue;
    }
    settings.push_back({text.substr(0, equals), text.substr(equals + 1)});
  }
  if (!faults.empty()) throw InputError(std::move(faults));
  return settings;
}

/// "A,B" as A and B.
std::vector<std::string> parts_of(const std::string& list, const char* option) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    if (end == begin) {
      refuse(FaultCode::command_invalid_value,
             fmt::format("{}: \"{}\" has an empty part", option, list));
    }
    parts.push_back(list.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

double finite_number(const std::string& text, const char* option) {
  double number = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stop != end || !std::isfinite(number)) {
    refuse(FaultCode::command_invalid_value,
           fmt::format("{}: \"{}\" is not a number", option, text));
  }
  return number;
}

/// The command line as CLI11 sees it.
class CommandLine {
 public:
  CommandLine() {
    app_.set_help_flag("-h,--help", "show this and leave");
    app_.set_version_flag("--version", kVersion, "show the version and leave");
    app_.get_formatter()->column_width(28);
    app_.require_subcommand(1);
    app_.footer(kProgramFooter);
    set_up_run();
    set_up_tradeoff();
    set_up_compare();
    set_up_explain();
    set_up_check();
    set_up_new();
    set_up_describe();
    set_up_schema();
    set_up_plot();
    for (const LaterCommand& later : kLaterCommands) {
      app_.add_subcommand(later.name, later.what)->group("Later, not in this version");
    }
  }

  Arguments parse(int argc, const char* const* argv) {
    try {
      app_.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
      return TextToPrint{app_.help()};
    } catch (const CLI::CallForVersion&) {
      return TextToPrint{std::string(kVersion) + "\n"};
    } catch (const CLI::ExtrasError&) {
      refuse_extras();
    } catch (const CLI::ParseError& error) {
      refuse(code_of(error),
             fmt::format("{} ({} --help tells more)", error.what(), name_of(chosen())));
    }
    refuse_empty_plugins();
    if (app_.got_subcommand(describe_)) return describe_arguments();
    if (app_.got_subcommand(schema_)) return schema_arguments();
    if (app_.got_subcommand(plot_)) return plot_arguments();
    if (app_.got_subcommand(new_)) return new_arguments();
    if (app_.got_subcommand(explain_)) {
      explained_.settings = settings_of(settings_);
      explained_.plugins = plugins_;
      return explained_;
    }
    if (app_.got_subcommand(tradeoff_)) return tradeoff_arguments();
    if (app_.got_subcommand(compare_)) return compare_arguments();
    if (app_.got_subcommand(check_)) {
      checked_.settings = settings_of(settings_);
      checked_.plugins = plugins_;
      return checked_;
    }
    return run_arguments();
  }

 private:
  /// SCENE and --set.
  void take_scene(CLI::App& command, std::string& scene) {
    command.add_option("SCENE", scene, "the scene, a TOML file")->option_text(" ")->required();
    take_settings(command);
  }

  void take_settings(CLI::App& command) {
    command.add_option("--set", settings_, "replace a parameter or any value of the scene")
        ->type_name("PATH=VALUE")
        ->option_text("PATH=VALUE ...")
        ->allow_extra_args(false);
    take_plugins(command);
  }

  void take_plugins(CLI::App& command) {
    command.add_option("--plugin", plugins_, "more components, from a shared library")
        ->type_name("LIB")
        ->option_text("LIB ...")
        ->allow_extra_args(false);
  }

  void refuse_empty_plugins() const {
    for (const std::string& name : plugins_) {
      if (name.empty()) {
        refuse(FaultCode::command_invalid_value, "--plugin is empty", "",
               "the file of a shared library");
      }
    }
  }

  void set_up_run() {
    run_ = app_.add_subcommand("run", "run one scene");
    run_->footer(std::string(kRunFooter) + "\n" + kPluginFooter);
    take_scene(*run_, asked_.scene);
    run_->add_option("-o,--output", asked_.folder, "folder for the results; SCENE's stem + .out")
        ->type_name("DIR");
    run_->add_flag("--resume", asked_.resume, "go on with the run that was stopped in DIR");
    run_->add_flag("--force", asked_.force,
                   "DIR need not be empty; only files that tomlin writes are replaced");
    run_->add_flag("--quiet", asked_.quiet, "print errors only");
  }

  void set_up_tradeoff() {
    tradeoff_ = app_.add_subcommand("tradeoff",
                                    "measure the cost of accuracy and find the cheapest setting");
    tradeoff_->footer(kTradeoffFooter);
    take_scene(*tradeoff_, traded_.scene);
    tradeoff_->add_option("--observable", traded_.observable, "a dotted path in summary.json")
        ->type_name("O")
        ->required();
    tradeoff_->add_option("--tolerance", traded_.tolerance, "error to be met; 1e-3 by default")
        ->type_name("T");
    tradeoff_->add_option("--budget", traded_.budget, "time to use; 60 by default")
        ->type_name("SECONDS");
    tradeoff_->add_option("--write", traded_.write, "the scene with the recommended lines")
        ->type_name("NEW.toml");
    tradeoff_
        ->add_option("-o,--output", traded_.folder,
                     "folder for the results; SCENE's stem + .tradeoff.out")
        ->type_name("DIR");
    tradeoff_->add_flag("--force", traded_.force,
                        "DIR need not be empty, and NEW.toml may be there; what tomlin writes is "
                        "replaced");
  }

  void set_up_compare() {
    compare_ = app_.add_subcommand("compare", "models side by side; the simplest that agrees");
    compare_->footer(kCompareFooter);
    compare_->add_option("SCENE", compared_.scenes, "the scenes, TOML files; two at least")
        ->option_text("...")
        ->required();
    take_settings(*compare_);
    compare_->add_option("--observable", compared_.observable, "a dotted path in summary.json")
        ->type_name("O")
        ->required();
    compare_->add_option("--tolerance", compared_.tolerance, "to agree within; 1e-2 by default")
        ->type_name("T");
    compare_->add_option("-o,--output", compared_.folder, "folder for the results; compare.out")
        ->type_name("DIR");
    compare_->add_flag("--force", compared_.force,
                       "DIR need not be empty; what tomlin writes is replaced");
  }

  void set_up_explain() {
    explain_ = app_.add_subcommand("explain", "what a scene builds, its scales, its cost");
    explain_->footer(kExplainFooter);
    take_scene(*explain_, explained_.scene);
    explain_->add_flag("--json", explained_.json, "as JSON");
  }

  void set_up_check() {
    check_ = app_.add_subcommand(
        "check", "validate a scene and verify the declared properties of its forces");
    check_->footer(kCheckFooter);
    take_scene(*check_, checked_.scene);
    CLI::Option* json = check_->add_flag("--json", checked_.json, "as JSON");
    check_->add_flag("--verbose", checked_.verbose, "show what holds, too, check by check")
        ->excludes(json);
    check_
        ->add_option("--seed", checked_.seed,
                     "of the random states at which properties are verified")
        ->capture_default_str();
  }

  void set_up_new() {
    new_ = app_.add_subcommand("new", "write a commented scene to start from");
    new_->footer(kNewFooter);
    new_->add_option("MODEL", begun_.model, "pt, fk, ring or plugin")->option_text(" ")->required();
    new_->add_option("NAME", begun_.name, "of the file, or of the force; MODEL by default")
        ->option_text(" ");
    new_->add_option("-o,--output", begun_.file,
                     "the file, NAME.toml by default; of a plugin the folder, NAME by default")
        ->type_name("FILE");
    new_->add_flag("--force", begun_.force, "replace a file that is there");
  }

  void set_up_describe() {
    describe_ = app_.add_subcommand("describe", "show the components that scenes are made of");
    describe_->footer(kDescribeFooter);
    describe_
        ->add_option(
            "NAME", described_.name,
            "a component by its type, a kind of them (force), or a table of the scene; all by "
            "default")
        ->option_text(" ");
    take_plugins(*describe_);
    CLI::Option* json = describe_->add_flag("--json", described_.json, "as JSON");
    CLI::Option* markdown =
        describe_->add_flag("--markdown", described_.markdown, "as Markdown")->excludes(json);
    describe_->add_option("-o,--output", described_.folder, "folder for the reference pages")
        ->type_name("DIR")
        ->needs(markdown);
    describe_->add_flag("--force", described_.force, "replace pages that are there");
  }

  void set_up_schema() {
    schema_ = app_.add_subcommand("schema", "a JSON Schema of scenes or of summaries");
    schema_->footer(kSchemaFooter);
    take_plugins(*schema_);
    schema_->add_option("-o,--output", outlined_.file, "the file; standard output by default")
        ->type_name("FILE");
    schema_->add_flag("--summary", outlined_.of_summary,
                      "of summary.json, for programs that read results");
    schema_->add_flag("--force", outlined_.force, "replace a file that is there");
  }

  void set_up_plot() {
    plot_ = app_.add_subcommand("plot", "draw a figure of finished runs");
    plot_->footer(plot_footer());
    plot_->add_option("DIR", plotted_.words, "folders of runs; and WHAT to draw, force by default")
        ->option_text("... [WHAT]")
        ->required();
    plot_->add_option("-o,--output", plotted_.file, "the picture: .svg, .png or .pdf")
        ->type_name("FILE")
        ->required();
    plot_->add_option("--x", plotted_.x, "a quantity or a column, instead of WHAT's")
        ->type_name("X");
    plot_->add_option("--y", panels_, "the same upwards; again for another panel")
        ->type_name("Y[,Y]")
        ->option_text("Y[,Y] ...")
        ->allow_extra_args(false);
    plot_->add_option("--from", plotted_.from, "where the x axis begins")->type_name("X");
    plot_->add_option("--to", plotted_.to, "where it ends")->type_name("X");
    plot_
        ->add_option("--at", moments_,
                     "moments to show a ring at: times, or values of --x; five by default")
        ->type_name("T[,T]")
        ->allow_extra_args(false);
    plot_->add_option("--driver", plotted_.driver, "which one, where there are several")
        ->type_name("NAME");
    plot_->add_option("--body", plotted_.body, "likewise")->type_name("NAME");
    plot_->add_option("--label", plotted_.labels, "what to call a DIR; once for each, in order")
        ->type_name("TEXT")
        ->option_text("TEXT ...")
        ->allow_extra_args(false);
    plot_->add_option("--title", plotted_.title, "above the figure; none by default")
        ->type_name("TEXT");
  }

  PlotArguments plot_arguments() {
    for (const std::string& panel : panels_) plotted_.y.push_back(parts_of(panel, "--y"));
    for (const std::string& list : moments_) {
      for (const std::string& moment : parts_of(list, "--at")) {
        plotted_.at.push_back(finite_number(moment, "--at"));
      }
    }
    for (const auto& [limit, option] :
         {std::pair{plotted_.from, "--from"}, std::pair{plotted_.to, "--to"}}) {
      if (limit && !std::isfinite(*limit)) {
        refuse(FaultCode::command_invalid_value, fmt::format("{} is not finite", option));
      }
    }
    return plotted_;
  }

  NewArguments new_arguments() const {
    if (begun_.name && begun_.name->empty()) {
      refuse(FaultCode::command_invalid_value, "NAME is empty");
    }
    if (begun_.file && begun_.file->empty()) {
      refuse(FaultCode::command_invalid_value, "-o is empty");
    }
    if (begun_.name && begun_.file && begun_.model != "plugin") {
      refuse(FaultCode::command_conflict, "NAME and -o both name the file", "", "one of them");
    }
    return begun_;
  }

  DescribeArguments describe_arguments() const {
    if (described_.folder && described_.folder->empty()) {
      refuse(FaultCode::command_invalid_value, "-o is empty");
    }
    if (described_.folder && !described_.name.empty()) {
      refuse(FaultCode::command_conflict, "a folder is written with the pages of all components",
             "", "-o without NAME");
    }
    DescribeArguments arguments = described_;
    arguments.plugins = plugins_;
    return arguments;
  }

  SchemaArguments schema_arguments() const {
    if (outlined_.file && outlined_.file->empty()) {
      refuse(FaultCode::command_invalid_value, "-o is empty");
    }
    SchemaArguments arguments = outlined_;
    arguments.plugins = plugins_;
    return arguments;
  }

  TradeoffArguments tradeoff_arguments() {
    for (const auto& [number, option] :
         {std::pair{traded_.tolerance, "--tolerance"}, std::pair{traded_.budget, "--budget"}}) {
      if (!std::isfinite(number) || number <= 0.0) {
        refuse(FaultCode::command_invalid_value, fmt::format("{} is {:g}", option, number), "",
               "> 0");
      }
    }
    if (traded_.write && traded_.write->empty()) {
      refuse(FaultCode::command_invalid_value, "--write is empty");
    }
    traded_.settings = settings_of(settings_);
    traded_.plugins = plugins_;
    return traded_;
  }

  CompareArguments compare_arguments() {
    if (compared_.scenes.size() < 2) {
      refuse(FaultCode::command_missing_argument, "one scene cannot be compared", "",
             "two or more");
    }
    if (!std::isfinite(compared_.tolerance) || compared_.tolerance <= 0.0) {
      refuse(FaultCode::command_invalid_value,
             fmt::format("--tolerance is {:g}", compared_.tolerance), "", "> 0");
    }
    compared_.settings = settings_of(settings_);
    compared_.plugins = plugins_;
    return compared_;
  }

  RunArguments run_arguments() {
    if (asked_.resume && asked_.force) {
      refuse(FaultCode::command_conflict, "--resume continues a run, --force starts it again", "",
             "one of them");
    }
    asked_.settings = settings_of(settings_);
    asked_.plugins = plugins_;
    return asked_;
  }

  const CLI::App& chosen() const {
    const auto subcommands = app_.get_subcommands();
    return subcommands.empty() ? app_ : *subcommands.back();
  }

  std::string name_of(const CLI::App& app) const {
    return &app == &app_ ? "tomlin" : "tomlin " + app.get_name();
  }

  /// What is left over stands before the command or behind it.
  [[noreturn]] void refuse_extras() const {
    const CLI::App& app = app_.remaining().empty() ? chosen() : app_;
    const auto extras = app.remaining();
    const std::string word = extras.empty() ? "" : extras.front();
    const bool takes_settings = app.get_option_no_throw("--set") != nullptr;
    if (takes_settings && !is_option(word) && word.find('=') != std::string::npos) {
      refuse(FaultCode::command_unknown_option,
             fmt::format("\"{}\" is not preceded by --set", word), "", "--set " + word);
    }
    if (!is_option(word)) {
      refuse(FaultCode::command_unknown_option,
             fmt::format("{} does not expect \"{}\" ({} --help tells more)", name_of(app), word,
                         name_of(app)));
    }
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
    const std::string name = word.substr(0, word.find('='));
    std::string admissible = name_of(app) + " --help shows them";
    if (takes_settings) admissible += "; values of the scene are given by --set PATH=VALUE";
    refuse(FaultCode::command_unknown_option,
           fmt::format("{} has no option {}", name_of(app), name),
           nearest_name(name, names).value_or(""), admissible);
  }

  CLI::App app_{"Nanoscale friction models from plain scene files.", "tomlin"};
  CLI::App* run_ = nullptr;
  CLI::App* tradeoff_ = nullptr;
  CLI::App* compare_ = nullptr;
  CLI::App* explain_ = nullptr;
  CLI::App* check_ = nullptr;
  CLI::App* new_ = nullptr;
  CLI::App* describe_ = nullptr;
  CLI::App* schema_ = nullptr;
  CLI::App* plot_ = nullptr;
  RunArguments asked_;
  TradeoffArguments traded_;
  CompareArguments compared_;
  ExplainArguments explained_;
  CheckArguments checked_;
  NewArguments begun_;
  DescribeArguments described_;
  SchemaArguments outlined_;
  PlotArguments plotted_;
  std::vector<std::string> panels_;
  std::vector<std::string> moments_;
  std::vector<std::string> settings_;
  std::vector<std::string> plugins_;
};

}  // namespace

Arguments parse_arguments(int argc, const char* const* argv) {
  if (argc < 2) {
    refuse(FaultCode::command_missing_argument, "a command is missing", "", all_commands());
  }
  // `tomlin help run` is `tomlin run --help`.
  if (argv[1] == std::string_view("help")) {
    std::vector<const char*> words = {argv[0]};
    if (argc > 2) words.push_back(argv[2]);
    words.push_back("--help");
    return parse_arguments(static_cast<int>(words.size()), words.data());
  }
  if (!is_option(argv[1])) {
    check_command(argv[1]);
  } else if (argc == 2) {
    check_option(argv[1]);
  }
  return CommandLine().parse(argc, argv);
}

}  // namespace tomlin
