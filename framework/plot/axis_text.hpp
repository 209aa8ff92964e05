#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "framework/plot/figure.hpp"
#include "framework/plot/stored_run.hpp"

/// What stands beside the axes of figures.
namespace tomlin {

/// A text that is to be shown as it is, as a part of an enhanced one.
std::string literal_text(std::string_view plain);

/// What the run's scene calls the unit of this dimension, as headers and results name dimensions:
/// "length", "length/time", "mass*length/time^2". Empty where it has no name for it. In metal units
/// their symbols, of headers that have these, "eV/A", too; enhanced.
std::string unit_name(const StoredRun& run, std::string_view dimension);

/// "force": what the dimension of a header's unit is called, "force" or "eV/A"; empty of a number.
std::string dimension_words(const StoredRun& run, const std::string& unit);

/// "lateral force F_x / (V_0/a)": words and symbol, either may be empty, and the unit unless it is
/// empty. All are enhanced.
FigureText axis_text(const std::string& words, const std::string& symbol, const std::string& unit);

/// Throws InputError where the runs' scenes call the unit of a dimension differently: their numbers
/// have no axis in common.
void check_unit_names(const std::vector<StoredRun>& runs, std::string_view dimension);

}  // namespace tomlin
