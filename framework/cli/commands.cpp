#include "framework/cli/command.hpp"

namespace tomlin {

/// The functions that return the records, in the order of `tomlin --help`.
#define TOMLIN_COMMANDS(RECORD) \
  RECORD(run_command)           \
  RECORD(sweep_command)         \
  RECORD(merge_command)         \
  RECORD(tradeoff_command)      \
  RECORD(compare_command)       \
  RECORD(explain_command)       \
  RECORD(check_command)         \
  RECORD(new_command)           \
  RECORD(describe_command)      \
  RECORD(schema_command)        \
  RECORD(export_command)        \
  RECORD(plot_command)

#define TOMLIN_DECLARE_RECORD(function) CommandRecord function();
#define TOMLIN_CALL_RECORD(function) function(),

TOMLIN_COMMANDS(TOMLIN_DECLARE_RECORD)

std::vector<CommandRecord> commands() { return {TOMLIN_COMMANDS(TOMLIN_CALL_RECORD)}; }

}  // namespace tomlin
