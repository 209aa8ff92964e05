#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "framework/cli/command.hpp"
#include "framework/cli/new_file.hpp"
#include "framework/cli/options.hpp"
#include "framework/cli/plugins.hpp"
#include "framework/cli/printable.hpp"
#include "framework/cli/schema.hpp"
#include "framework/cli/summary_schema.hpp"

namespace tomlin {
namespace {

struct SchemaArguments {
  std::optional<std::string> file;  ///< standard output without it
  std::vector<std::string> plugins;
  bool of_summary = false;
  bool of_sweep = false;
  bool force = false;
};

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

void add_options(CLI::App& parser, SchemaArguments& arguments) {
  add_plugin_option(parser, arguments.plugins);
  add_output_option(parser, arguments.file, "FILE", "the file; standard output by default");
  parser.add_flag("--summary", arguments.of_summary,
                  "of summary.json, for programs that read results");
  parser.add_flag("--sweep", arguments.of_sweep, "of sweep.json, likewise")
      ->excludes(parser.get_option("--summary"));
  parser.add_flag("--force", arguments.force, "replace a file that is there");
}

void check(SchemaArguments& arguments) { refuse_empty(arguments.file, "-o"); }

int write_schema(const SchemaArguments& arguments) {
  const std::string schema = arguments.of_summary ? summary_schema()
                             : arguments.of_sweep
                                 ? sweep_summary_schema()
                                 : scene_schema(registry_with_plugins(arguments.plugins, {}));
  if (!arguments.file) return print_result(schema);
  const std::filesystem::path file = *arguments.file;
  refuse_to_replace(file, arguments.force);
  refuse_unwritable(file);
  write_new_file(file, schema);
  if (arguments.of_summary || arguments.of_sweep) return print_result(file.string() + "\n");
  return print_result(file.string() +
                      ": a scene beside it names it in its first line\n  #:schema ./" +
                      file.filename().string() + "\n");
}

}  // namespace

CommandRecord schema_command() {
  return {"schema", "a JSON Schema of scenes or of summaries", kSchemaFooter,
          declared<SchemaArguments>(add_options, check, write_schema)};
}

}  // namespace tomlin
