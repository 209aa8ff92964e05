#include "framework/scene/motion.hpp"

#include <limits>
#include <optional>
#include <string_view>
#include <variant>

namespace tomlin {

double TimeFunction::operator()(double t) const {
  if (is_constant()) return constant;
  const auto value_of = [this, t](std::string_view name) -> std::optional<double> {
    for (const auto& [parameter, value] : parameters) {
      if (parameter == name) return value;
    }
    return t;  // the only other name that it may use
  };
  const auto result = expression->evaluate(value_of);
  const double* value = std::get_if<double>(&result);
  return value ? *value : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace tomlin
