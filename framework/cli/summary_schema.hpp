#pragma once

#include <string>

namespace tomlin {

/// A JSON Schema (draft 7) of summary.json, made of the rows of all results.
std::string summary_schema();

/// A JSON Schema (draft 7) of sweep.json.
std::string sweep_summary_schema();

}  // namespace tomlin
