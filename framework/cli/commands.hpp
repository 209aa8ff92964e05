#pragma once

#include <string>

#include "framework/cli/arguments.hpp"

/// The commands; each returns the program's exit status and throws InputError for bad input.
namespace tomlin {

int run_command(const RunArguments& arguments);
/// Throws OutputError too.
int tradeoff_command(const TradeoffArguments& arguments);
/// kExitFailed when a model's run fails. Throws OutputError too.
int compare_command(const CompareArguments& arguments);
int explain_command(const ExplainArguments& arguments);
/// kExitFailed when a check fails; with `json` faults of the scene go to standard output.
int check_command(const CheckArguments& arguments);
/// Writes a scene to start from. Throws OutputError too.
int new_command(const NewArguments& arguments);
/// With `markdown` and a folder writes the reference pages there. Throws OutputError too.
int describe_command(const DescribeArguments& arguments);
/// Throws OutputError too.
int schema_command(const SchemaArguments& arguments);
/// Throws GnuplotError and OutputError too.
int plot_command(const PlotArguments& arguments);

/// Writes a command's result to standard output; kExitFailed when that does not take it.
int print_result(const std::string& text);

}  // namespace tomlin
