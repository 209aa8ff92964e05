#include <nlohmann/json.hpp>

#include "framework/cli/command.hpp"
#include "framework/cli/diagnostics.hpp"
#include "framework/cli/explanation.hpp"
#include "framework/cli/options.hpp"
#include "framework/cli/printable.hpp"
#include "framework/core/text/fault.hpp"

namespace tomlin {
namespace {

struct ExplainArguments : SceneOptions {
  bool json = false;
};

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

void add_options(CLI::App& parser, ExplainArguments& arguments) {
  add_scene_options(parser, arguments);
  add_json_option(parser, arguments.json);
}

int explain_scene(const ExplainArguments& arguments) {
  try {
    const OpenedScene opened(arguments);
    const Explanation explanation = explain(opened.scene);
    return print_result(arguments.json ? explanation_json(explanation)
                                       : explanation_text(explanation));
  } catch (const InputError& error) {
    // On standard error they are text in any case.
    if (arguments.json) print_result(json_text({{"faults", faults_json(error.faults())}}));
    throw;
  }
}

}  // namespace

CommandRecord explain_command() {
  return {"explain", "what a scene builds, its scales, its cost", kExplainFooter,
          declared<ExplainArguments>(add_options, nullptr, explain_scene)};
}

}  // namespace tomlin
