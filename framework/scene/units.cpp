#include "framework/scene/units.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <system_error>

#include "framework/core/text/ascii.hpp"

namespace tomlin {
namespace {

constexpr std::array<std::string_view, 13> kPrefixes = {"",  "f", "p", "n", "u", "m",       "c",
                                                        "d", "k", "M", "G", "T", "\xC2\xB5"};

constexpr std::array<std::string_view, 38> kUnits = {
    "m",   "s",   "g",  "N",   "J",        "eV",           "K",        "Pa",  "Hz",   "V",
    "C",   "W",   "A",  "bar", "cal",      "mol",          "rad",      "deg", "amu",  "u",
    "Da",  "Ha",  "Ry", "min", "h",        "au",           "angstrom", "Ang", "Bohr", "bohr",
    "dyn", "erg", "L",  "psi", "\xC3\x85", "\xE2\x84\xAB", "\xC2\xB0", "%"};

/// Between the words of a compound unit.
bool is_joint(char c) {
  return is_blank(c) || std::string_view("/*^()-+.").find(c) != std::string_view::npos ||
         (c >= '0' && c <= '9');
}

}  // namespace

bool is_unit(std::string_view word) {
  return std::any_of(kPrefixes.begin(), kPrefixes.end(), [word](std::string_view prefix) {
    return word.starts_with(prefix) &&
           std::find(kUnits.begin(), kUnits.end(), word.substr(prefix.size())) != kUnits.end();
  });
}

std::optional<NumberWithUnit> unit_in(std::string_view text) {
  std::size_t begin = 0;
  while (begin < text.size() && is_blank(text[begin])) ++begin;
  const std::size_t sign =
      begin < text.size() && (text[begin] == '-' || text[begin] == '+') ? 1 : 0;
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data() + begin + sign, end, value);
  if (error == std::errc::invalid_argument) return std::nullopt;
  NumberWithUnit found;
  found.column = static_cast<std::size_t>(stop - text.data());
  found.number = text.substr(begin, found.column - begin);
  while (found.column < text.size() && is_blank(text[found.column])) ++found.column;
  found.unit = text.substr(found.column);
  // "2 * m" and "2 / s" are expressions over parameters.
  if (found.unit.empty() || (is_joint(found.unit.front()) && found.unit.front() != '(')) {
    return std::nullopt;
  }
  for (std::size_t word = 0; word < found.unit.size();) {
    std::size_t behind = word;
    while (behind < found.unit.size() && !is_joint(found.unit[behind])) ++behind;
    // The middle dot, and powers as raised digits, belong to no word.
    std::string name(found.unit.substr(word, behind - word));
    for (const std::string_view mark :
         {"\xC2\xB7", "\xC2\xB2", "\xC2\xB3", "\xE2\x81\xBB", "\xC2\xB9"}) {
      for (auto at = name.find(mark); at != std::string::npos; at = name.find(mark)) {
        name.erase(at, mark.size());
      }
    }
    if (!name.empty() && !is_unit(name)) return std::nullopt;
    word = behind + 1;
  }
  return found;
}

std::string written_without_unit(const NumberWithUnit& given) {
  std::string number(given.number);
  if (given.unit == "deg" || given.unit == "\xC2\xB0") {
    return "'" + number + " * pi / 180', since angles are in radians";
  }
  if (given.unit == "%") {
    return "'" + number +
           " / 100' where a part of 1 is asked for; error in run.until is absolute, in the units "
           "of "
           "its observable";
  }
  return number;
}

}  // namespace tomlin
