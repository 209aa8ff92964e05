#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tomlin {

/// The valid name that was probably meant, for "did you mean": nearest by Damerau-Levenshtein
/// distance (insert, delete, replace, swap neighbours), letter case aside. Nothing unless
/// reasonably close; the first of equals. An abbreviation of three letters or more also counts, and
/// a word that one name alone has among its own: mass of particle_mass.
std::optional<std::string> nearest_name(std::string_view name,
                                        const std::vector<std::string>& valid_names);

}  // namespace tomlin
