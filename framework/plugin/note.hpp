#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tomlin {

/// Description of a build, in a plugin's note or in the program.
struct PluginNote {
  int api = 0;                            ///< TOMLIN_PLUGIN_API
  std::string release;                    ///< of tomlin
  std::string abi;                        ///< the C++ library, whose types cross the border
  std::string compiler;                   ///< stated, not compared: those that share an ABI get on
  std::string border;                     ///< hash of the headers whose types cross the border
  std::vector<std::string> number_types;  ///< "double", "quadruple"
  std::vector<std::string> instruction_sets;  ///< "baseline", "avx2", "avx512"
};

/// Nothing when something is missing in it.
std::optional<PluginNote> parse_note(std::string_view text);

/// The program's own.
PluginNote own_note();

/// A sentence that says which side has what; empty when the two go together. Fewer number types and
/// instruction sets are no mismatch: they only leave ways of running out.
std::string mismatch(const PluginNote& plugin, const PluginNote& program);

}  // namespace tomlin
