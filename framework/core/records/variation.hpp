#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "framework/core/records/parameter.hpp"

/// Parameters of a force that differ between the particles of its body: quenched disorder.
namespace tomlin {

/// A row whose value differs from particle to particle.
struct Variation {
  const Parameter* row = nullptr;  ///< of the record, which outlives it
  ParameterValue values;  ///< PerParticle of a number, PerParticleVector of a vector; one for each
};

/// Whether a row is of a kind that can differ between particles: a number, or a vector.
bool can_vary(const Parameter& row);

/// How many particles it has values for.
std::size_t count_of(const Variation& variation);

/// Gives a description the values of one particle.
void assign_particle(std::span<const Variation> variations, std::size_t particle,
                     void* description);

/// The value that stands for all where one is asked for: the number of largest size, which bounds
/// and scales follow from; of vectors the first.
ParameterValue representative(const Variation& variation);

}  // namespace tomlin
