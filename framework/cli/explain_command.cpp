#include <nlohmann/json.hpp>

#include "framework/cli/commands.hpp"
#include "framework/cli/diagnostics.hpp"
#include "framework/cli/explanation.hpp"
#include "framework/cli/plugins.hpp"
#include "framework/core/text/fault.hpp"

namespace tomlin {

int explain_command(const ExplainArguments& arguments) {
  try {
    const SceneDocument document(arguments.scene);
    const Registry registry = registry_with_plugins(arguments.plugins, {&document, 1});
    const Explanation explanation = explain(document.read(registry, arguments.settings));
    return print_result(arguments.json ? explanation_json(explanation)
                                       : explanation_text(explanation));
  } catch (const InputError& error) {
    // On standard error they are text in any case.
    if (arguments.json) print_result(json_text({{"faults", faults_json(error.faults())}}));
    throw;
  }
}

}  // namespace tomlin
