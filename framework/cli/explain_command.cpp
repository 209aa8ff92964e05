#include "framework/cli/commands.hpp"
#include "framework/cli/explanation.hpp"
#include "framework/cli/plugins.hpp"

namespace tomlin {

int explain_command(const ExplainArguments& arguments) {
  const SceneDocument document(arguments.scene);
  const Registry registry = registry_with_plugins(arguments.plugins, {&document, 1});
  const Explanation explanation = explain(document.read(registry, arguments.settings));
  return print_result(arguments.json ? explanation_json(explanation)
                                     : explanation_text(explanation));
}

}  // namespace tomlin
