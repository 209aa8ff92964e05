#include <filesystem>
#include <string>

#include "framework/cli/commands.hpp"
#include "framework/cli/exit_status.hpp"
#include "framework/cli/new_file.hpp"
#include "framework/cli/plugins.hpp"
#include "framework/cli/schema.hpp"
#include "framework/cli/summary_schema.hpp"
#include "framework/output/output_file.hpp"

namespace tomlin {

int schema_command(const SchemaArguments& arguments) {
  const std::string schema = arguments.of_summary
                                 ? summary_schema()
                                 : scene_schema(registry_with_plugins(arguments.plugins, {}));
  if (!arguments.file) return print_result(schema);
  const std::filesystem::path file = *arguments.file;
  refuse_to_replace(file, arguments.force);
  refuse_unwritable(file);
  OutputFile output(file);
  output.append(schema);
  output.publish();
  if (arguments.of_summary) return print_result(file.string() + "\n");
  return print_result(file.string() +
                      ": a scene beside it names it in its first line\n  #:schema ./" +
                      file.filename().string() + "\n");
}

}  // namespace tomlin
