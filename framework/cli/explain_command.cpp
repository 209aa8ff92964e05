#include "framework/cli/commands.hpp"
#include "framework/cli/explanation.hpp"
#include "framework/cli/plugins.hpp"

namespace tomlin {

int explain_command(const ExplainArguments& arguments) {
  const Registry registry = registry_with_plugins(arguments.plugins, {arguments.scene});
  const Explanation explanation =
      explain(read_scene(arguments.scene, registry, arguments.settings));
  return print_result(arguments.json ? explanation_json(explanation)
                                     : explanation_text(explanation));
}

}  // namespace tomlin
