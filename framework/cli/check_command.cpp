#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/check_json.hpp"
#include "framework/cli/command.hpp"
#include "framework/cli/diagnostics.hpp"
#include "framework/cli/exit_status.hpp"
#include "framework/cli/options.hpp"
#include "framework/cli/printable.hpp"
#include "framework/cli/sections.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/core/text/warning.hpp"
#include "framework/model/model.hpp"
#include "framework/model/properties.hpp"
#include "framework/run/guard/trial.hpp"

namespace tomlin {
namespace {

struct CheckArguments : SceneOptions {
  bool json = false;
  bool verbose = false;    ///< what holds, too
  std::uint64_t seed = 1;  ///< of the random states at which properties are verified
};

constexpr const char* kCheckFooter = R"(
Reads and binds the scene as run does, compares a fixed step with the stable step, and verifies the
properties of every force on this scene's bodies: at the start, near it, far away, high above it, and
with two particles almost touching:

  conservative, exact, path,
  quadruple                   its force is minus the gradient of its energy
  hessian                     its second derivatives are the slopes of its force
  stiffness, tight            no curvature exceeds its bound, and some come near to it
  finite                      there are numbers wherever there can be
  internal                    its forces and torques sum to zero
  not conservative,
  not internal                it has not what it does not declare
  dissipative, friction,
  friction bound              its power is never positive; its friction matrix or bound is right
  balance, driver             power, stored energy, heat and a driver's work add up
  flow, flow repeats,
  heat of flow                an operator that it provides is its exact solution
  periodic, rebase, origin    a shift by its period, or of the origin, changes nothing
  velocity, time, repeatable  it depends on nothing that it does not declare
  uses velocity, uses time    and on what it declares
  its own                     it acts on its own bodies only
  set and add, padding, point its kernels say the same, and leave zeros beyond the last particle
  same bits                   so does every instruction set
  number types, digits        and every number type, each to its own rounding

Where all holds that is said in one line; --verbose shows every check, with its largest error and what
is allowed there. A property that does not hold is shown with the state, particle, position and time where
it broke, and with both numbers. "unseen": no state of the scene had anything to compare.

Examples:

  tomlin check pt.toml
  tomlin check pt.toml --verbose
  tomlin check pt.toml --set run.integrator.dt=0.1 --json

With --json faults of the scene are listed on standard output.

Exit status: 0 all checks hold; 1 one does not; 2 the scene is not right.)";

using Json = nlohmann::ordered_json;

/// One line of the answer.
struct Check {
  std::string subject;   ///< a force, or "step"
  std::string property;  ///< "conservative", "stable"
  bool holds = false;
  bool unseen = false;  ///< there was no state at which anything could be compared
  std::string text;
  Json numbers = Json::object();
};

struct Report {
  std::vector<Check> checks;
  std::vector<Warning> warnings;
  std::vector<Model::LeftOut> not_built;

  bool valid() const {
    for (const Check& check : checks) {
      if (!check.holds) return false;
    }
    return true;
  }
};

/// The fixed step against the stable step; `trial` has bound the scene as a run does.
void check_step(const Scene& scene, const Trial& trial, Report& report) {
  const SceneIntegrator& integrator = scene.run.integrator;
  if (integrator.record->adaptive) return;
  const double dt = integrator.record->step(integrator.description.get());
  const bool limited = std::isfinite(trial.stable_step);
  Check check;
  check.subject = integrator.record->name;
  check.property = "stable";
  check.holds = trial.step_is_stable || scene.run.allow_unstable;
  check.text = limited ? fmt::format("dt = {:g} is {:.3g} of the stable step {:.4g}", dt,
                                     dt / trial.stable_step, trial.stable_step)
                       : fmt::format("dt = {:g}; nothing limits it", dt);
  check.numbers = Json{{"dt", dt}, {"stable_step", limited ? Json(trial.stable_step) : Json()}};
  if (!trial.step_is_stable && check.holds) {
    report.warnings.push_back({FaultCode::integrator_beyond_stability,
                               check.text + ": run.allow_unstable insists", "run.integrator.dt"});
  }
  report.checks.push_back(std::move(check));
}

Json json_of(const PropertyPoint& point) {
  const auto number = [](double x) { return std::isfinite(x) ? Json(x) : Json(); };
  return Json{{"state", point.state},
              {"body", point.body.empty() ? Json() : Json(point.body)},
              {"particle", point.particle < 0 ? Json() : Json(point.particle)},
              {"coordinate", point.coordinate.empty() ? Json() : Json(point.coordinate)},
              {"place", point.position},
              {"time", point.time},
              {"found", number(point.found)},
              {"due", number(point.expected)}};
}

/// One row of the table: number of states, the worst error and what is allowed there.
std::string row_of(const std::string& states, const std::string& error, const std::string& allowed,
                   const std::string& meaning) {
  return fmt::format("{:>6}  {:>8}  {:>8}  {}", states, error, allowed, meaning);
}

Check check_of(const PropertyResult& result) {
  Check check;
  check.subject = result.force;
  check.property = result.property;
  check.holds = result.holds;
  check.unseen = result.states == 0 && result.holds;
  check.text = row_of(std::to_string(result.states), fmt::format("{:.2g}", result.error),
                      fmt::format("{:.2g}", result.allowed),
                      result.meaning + (check.unseen   ? "; nothing could be compared"
                                        : result.holds ? ""
                                                       : "; broken by " + result.worst.text()));
  check.numbers = Json{{"type", result.type},
                       {"meaning", result.meaning},
                       {"error", std::isfinite(result.error) ? Json(result.error) : Json()},
                       {"allowed", result.allowed},
                       {"states", result.states},
                       {"worst", json_of(result.worst)}};
  return check;
}

Report report_on(const std::shared_ptr<const Scene>& scene, std::uint64_t seed,
                 const std::atomic<bool>* stop = nullptr) {
  Report report;
  const Trial trial = try_out(scene, 0.0);
  check_step(*scene, trial, report);
  for (const PropertyResult& result : check_properties(*scene, {.seed = seed, .stop = stop})) {
    report.checks.push_back(check_of(result));
  }
  const Model model(scene);
  for (const Model::LeftOut& left : model.left_out()) {
    report.not_built.push_back(left);
  }
  return report;
}

std::vector<Warning> all_warnings(const Report& report) {
  std::vector<Warning> all = report.warnings;
  for (const Model::LeftOut& left : report.not_built) {
    all.push_back({FaultCode::scene_force_left_out,
                   left.force + " is not built and was not checked: " + left.why,
                   "force." + left.force});
  }
  return all;
}

/// "57 checks hold; 3 had nothing to compare", or how many do not.
std::string verdict_on(const Report& report) {
  std::size_t failed = 0;
  std::size_t unseen = 0;
  for (const Check& check : report.checks) {
    failed += check.holds ? 0 : 1;
    unseen += check.unseen ? 1 : 0;
  }
  const std::size_t count = report.checks.size();
  if (failed > 0) return fmt::format("{} of {} checks FAILED", failed, count);
  const std::string left = unseen == 0 ? "" : fmt::format("; {} had nothing to compare", unseen);
  return fmt::format("{} checks hold{}", count - unseen, left);
}

/// One line, where all holds; warnings of what holds only since the scene insists follow it.
std::string line_of(const Scene& scene, const Report& report) {
  std::string text = scene.file + ": " + verdict_on(report);
  std::string left_out;
  for (const Model::LeftOut& one : report.not_built) {
    left_out += (left_out.empty() ? "; not built, and so not checked: " : ", ") + one.force;
  }
  text += left_out + "\n";
  for (const Warning& warning : report.warnings) {
    text += scene.file + ": warning: " + to_string(warning) + "\n";
  }
  return text;
}

/// Every check, or those that do not hold.
std::string table_of(const Scene& scene, const Report& report, bool all) {
  Sections sections;
  sections.section(scene.file + ": a valid scene");
  sections.row("check", "verdict " + row_of("states", "error", "allowed", "what is compared"));
  for (const Check& check : report.checks) {
    if (check.holds && !all) continue;
    const char* verdict = check.unseen ? "unseen  " : check.holds ? "ok      " : "FAILED  ";
    sections.row(check.subject + " " + check.property, verdict + check.text);
  }
  for (const Warning& warning : all_warnings(report)) {
    sections.row("warning", to_string(warning));
  }
  sections.row("in all", verdict_on(report));
  sections.row("errors", "relative, the worst of the states looked at");
  return sections.text();
}

std::string text_of(const Scene& scene, const Report& report, bool verbose) {
  if (!verbose && report.valid()) return line_of(scene, report);
  return table_of(scene, report, verbose);
}

Json json_of(const Report& report) {
  Json json;
  json["valid"] = true;
  json["sound"] = report.valid();
  json["checks"] = Json::array();
  for (const Check& check : report.checks) {
    Json entry{{"subject", check.subject}, {"check", check.property}, {"ok", check.holds}};
    if (check.unseen) entry["unseen"] = true;
    entry.update(check.numbers);
    entry["text"] = check.text;
    json["checks"].push_back(std::move(entry));
  }
  const std::vector<Warning> warnings = all_warnings(report);
  json["warnings"] = texts_of(warnings);
  json["warning_codes"] = codes_of(warnings);
  return json;
}

void add_options(CLI::App& parser, CheckArguments& arguments) {
  add_scene_options(parser, arguments);
  CLI::Option* json = add_json_option(parser, arguments.json);
  parser.add_flag("--verbose", arguments.verbose, "show what holds, too, check by check")
      ->excludes(json);
  parser
      .add_option("--seed", arguments.seed, "of the random states at which properties are verified")
      ->capture_default_str();
}

int check_scene(const CheckArguments& arguments) {
  try {
    const OpenedScene opened(arguments);
    const Report report = report_on(opened.scene, arguments.seed);
    const int status =
        print_result(arguments.json ? json_text(json_of(report))
                                    : text_of(*opened.scene, report, arguments.verbose));
    return report.valid() ? status : kExitFailed;
  } catch (const InputError& error) {
    if (!arguments.json) throw;
    const int status =
        print_result(json_text({{"valid", false}, {"faults", faults_json(error.faults())}}));
    return status == kExitDone ? kExitBadInput : status;
  }
}

}  // namespace

std::string check_json(const std::shared_ptr<const Scene>& scene, std::uint64_t seed,
                       const std::atomic<bool>* stop) {
  return json_text(json_of(report_on(scene, seed, stop)));
}

CommandRecord check_command() {
  return {"check", "validate a scene and verify the declared properties of its forces",
          kCheckFooter, declared<CheckArguments>(add_options, nullptr, check_scene)};
}

}  // namespace tomlin
