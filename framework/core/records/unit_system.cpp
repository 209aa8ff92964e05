#include "framework/core/records/unit_system.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <system_error>
#include <utility>

namespace tomlin {
namespace {

double power(double x, int n) {
  double result = 1.0;
  for (int k = 0; k < std::abs(n); ++k) result = n < 0 ? result / x : result * x;
  return result;
}

constexpr std::pair<std::string_view, Dimension> kNamedDimensions[] = {
    {"1", dimension::none},
    {"mass", dimension::mass},
    {"length", dimension::length},
    {"time", dimension::time},
    {"force", dimension::force},
    {"energy", dimension::energy},
    {"velocity", dimension::velocity},
    {"temperature", dimension::temperature}};

/// "length" or "time^2".
std::optional<Dimension> factor_named(std::string_view text) {
  int exponent = 1;
  if (const auto hat = text.find('^'); hat != std::string_view::npos) {
    const std::string_view digits = text.substr(hat + 1);
    const char* const end = digits.data() + digits.size();
    const auto [stop, error] = std::from_chars(digits.data(), end, exponent);
    constexpr int kMostPowers = 9;
    if (error != std::errc() || stop != end || std::abs(exponent) > kMostPowers) return {};
    text = text.substr(0, hat);
  }
  for (const auto& [name, one] : kNamedDimensions) {
    if (text != name) continue;
    return Dimension{one.mass * exponent, one.length * exponent, one.time * exponent,
                     one.temperature * exponent};
  }
  return {};
}

}  // namespace

double scene_unit(UnitSystem units, const Dimension& dimension) {
  if (units == UnitSystem::reduced) return 1.0;
  const double mass = dimension.time == 0 ? power(kAtomicMassInMetal, dimension.mass) : 1.0;
  return mass * power(kBoltzmannInMetal, dimension.temperature);
}

std::string unit_symbol(UnitSystem units, const Dimension& dimension) {
  if (units == UnitSystem::reduced) return to_string(dimension);
  const bool of_atoms = dimension.time == 0;
  const int energy = of_atoms ? 0 : dimension.mass;  // mass = eV ps^2/A^2
  const std::pair<std::string_view, int> factors[] = {{"eV", energy},
                                                      {"u", of_atoms ? dimension.mass : 0},
                                                      {"A", dimension.length - 2 * energy},
                                                      {"ps", dimension.time + 2 * energy},
                                                      {"K", dimension.temperature}};
  return product_of_powers(factors);
}

std::string unit_in_tables(UnitSystem units, const Dimension& dimension) {
  if (units != UnitSystem::reduced) return unit_symbol(units, dimension);
  if (dimension == dimension::force) return "force";
  const bool is_energy = dimension == dimension::energy || dimension == dimension::temperature;
  return is_energy ? "energy" : to_string(dimension);
}

std::string unit_in_tables(UnitSystem units, const std::string& unit) {
  const auto dimension = dimension_named(unit);
  if (units == UnitSystem::reduced || !dimension) return unit;
  return unit_symbol(units, *dimension);
}

std::optional<Dimension> dimension_named(std::string_view text) {
  Dimension all;
  int sign = 1;
  for (;;) {
    const std::size_t end = std::min(text.find_first_of("*/"), text.size());
    const auto factor = factor_named(text.substr(0, end));
    if (!factor) return {};
    all.mass += sign * factor->mass;
    all.length += sign * factor->length;
    all.time += sign * factor->time;
    all.temperature += sign * factor->temperature;
    if (end == text.size()) return all;
    sign = text[end] == '/' ? -1 : 1;
    text.remove_prefix(end + 1);
  }
}

}  // namespace tomlin
