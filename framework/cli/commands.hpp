#pragma once

#include <string>

#include "framework/cli/arguments.hpp"

/// The commands; each returns the program's exit status and throws InputError for bad input.
namespace tomlin {

int run_command(const RunArguments& arguments);
int describe_command(const DescribeArguments& arguments);

/// Writes a command's result to standard output; kExitFailed when that does not take it.
int print_result(const std::string& text);

}  // namespace tomlin
