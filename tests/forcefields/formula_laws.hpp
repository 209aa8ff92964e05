#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "forcefields/expression.hpp"
#include "framework/core/records/force.hpp"

/// Formulas of every kind, as records of their own: what a formula is evaluated on and what it
/// declares depend on its description, and no such description can be drawn at random.
namespace tomlin::test {

struct FormulaText {
  const char* energy;
  std::vector<const char*> force = {};
  std::vector<double> period = {};
};

/// One per kind of element and of number of dimensions, with every sort of dependence.
inline const std::vector<FormulaText>& formula_texts() {
  static const std::vector<FormulaText> all = {
      {"0.7*cos(2*pi*x/1.3)", {}, {1.3}},
      {"0.2*x^4 - 0.3*x^2*cos(t)"},
      {"0.7*exp(-0.4*y^2)*cos(2*pi*x/1.3)", {}, {1.3}},
      {"0.5*x*y + sqrt(1 + x^2 + y^2)"},
      {"0.3*x*y*z + log(3 + x^2 + z^2)*sin(y)"},
      {"0.4*tanh(1.7*x - 0.2*y) + 0.3/cosh(0.8*y)"},
      {"0.6*(xc - 0.2*t)^2"},
      {"0.4*cos(xc)*sin(yc) + 0.1*yc^2"},
      {"0.4*cos(xc)*sin(yc) + zc^3/7"},
      {"1.2*(1 - exp(-0.8*(r - 1.1)))^2"},
      {"0.3*(1.1/r)^6*(1 + 0.2*sin(t))"},
      {"0.5*(theta - pi)^2"},
      {"0.5*(theta - pi)^2*(1 + 0.1*t)"},
      {"", {"-x - 0.3*vx + cos(t)"}},
      {"", {"-0.7*tanh(vx/0.2) - 0.1*sign(vx) + 0.2*step(x - 0.3)"}},
      {"", {"-y + 0.1*vy", "x - 0.2*vx*vx"}},
      {"", {"0.3*y*z", "-0.7*x", "0.1*vz*x"}},
      {"0.7*(1 + 0.2*normal(7, i))*cos(2*pi*(x/1.3 + random(3, i)))", {}, {1.3}},
      {"0.5*(1 + i/count)*x*y*cos(t + i) + random(2, i)*sqrt(1 + x^2 + y^2)"},
      {"", {"-(1 + 0.1*i)*x - 0.3*random(1, i)*vx + cos(t + normal(2, i))"}},
  };
  return all;
}

inline constexpr std::size_t kFormulas = 20;

template <std::size_t k>
std::shared_ptr<void> make_formula() {
  auto description = std::make_shared<ExpressionDescription>();
  const FormulaText& law = formula_texts()[k];
  if (*law.energy != '\0') description->energy = {law.energy, {}};
  for (const char* component : law.force) description->force.components.push_back({component, {}});
  description->period.numbers = law.period;
  return description;
}

template <std::size_t... k>
constexpr auto formula_makers(std::index_sequence<k...>) {
  return std::array<std::shared_ptr<void> (*)(), sizeof...(k)>{&make_formula<k>...};
}

/// The record of formulas with one law for every scene; pairs and angles are drawn, the law stays.
inline ForceRecord formula_record(std::size_t k) {
  ForceRecord record = expression_record();
  record.make_description = formula_makers(std::make_index_sequence<kFormulas>())[k];
  std::erase_if(record.parameters, [](const Parameter& row) { return row.key != "pairs"; });
  const std::string_view energy = formula_texts()[k].energy;
  if (energy.find("r") == std::string_view::npos) record.most_bodies = 1;
  const auto description = record.make_description();
  if (!record.traits_of(description.get()).internal) record.most_bodies = 1;
  return record;
}

}  // namespace tomlin::test
