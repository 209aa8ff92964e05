#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

/// Units where a number is expected: numbers have none, and a message says so instead of something
/// about operators.
namespace tomlin {

inline constexpr std::string_view kNumbersHaveNoUnits =
    "numbers have no units here: a scene is in reduced or any consistent ones, or in those of "
    "[scene] units = \"metal\"";

/// A number with a unit behind it, "2.5 nm", "1 N/m", "0.3eV/A^2".
struct NumberWithUnit {
  std::string_view number;
  std::string_view unit;
  std::size_t column = 0;  ///< of the unit, bytes into the text
};

/// Nothing where the text is something else.
std::optional<NumberWithUnit> unit_in(std::string_view text);

/// Returns what to write in place of it: of an angle in degrees a formula in radians, of a
/// percentage its value as a part of 1; of others the number.
std::string written_without_unit(const NumberWithUnit& given);

/// "nm", "eV", "K": a unit that is written with a letter or a prefix of its own.
bool is_unit(std::string_view word);

}  // namespace tomlin
