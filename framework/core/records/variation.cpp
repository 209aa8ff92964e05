#include "framework/core/records/variation.hpp"

#include <cmath>
#include <variant>

namespace tomlin {

bool can_vary(const Parameter& row) {
  return std::holds_alternative<double>(row.prototype) ||
         std::holds_alternative<SpaceVector>(row.prototype);
}

std::size_t count_of(const Variation& variation) {
  const auto* numbers = std::get_if<PerParticle>(&variation.values);
  return numbers ? numbers->values.size()
                 : std::get<PerParticleVector>(variation.values).values.size();
}

void assign_particle(std::span<const Variation> variations, std::size_t particle,
                     void* description) {
  for (const Variation& variation : variations) {
    if (const auto* numbers = std::get_if<PerParticle>(&variation.values)) {
      variation.row->assign(description, numbers->values[particle]);
    } else {
      variation.row->assign(description,
                            std::get<PerParticleVector>(variation.values).values[particle]);
    }
  }
}

ParameterValue representative(const Variation& variation) {
  const auto* numbers = std::get_if<PerParticle>(&variation.values);
  if (numbers == nullptr) return std::get<PerParticleVector>(variation.values).values.front();
  double largest = numbers->values.front();
  for (const double x : numbers->values) {
    if (std::abs(x) > std::abs(largest)) largest = x;
  }
  return largest;
}

}  // namespace tomlin
