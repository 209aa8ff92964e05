#pragma once

#include <cstdint>

#include "framework/core/numbers/random.hpp"
#include "framework/core/system/stage.hpp"

/// Operators: parts of the dynamics that a scheme takes by their exact flow over a time, in place
/// of the forces that they stand for. Friction, and what a thermostat does, are such parts.
///
///   (v, u) -> (v', u'), heat     h >= 0, positions x and all other forces at rest
///
///   v     velocities of the coordinates that are free; the others stay what they are
///   u     variables of the force's own
///   heat  (K + U)(v, u) - (K + U)(v', u'): the energy that it has taken, K the kinetic energy and
///         U what the force stores; of the numbers as they are, so that the energy ledger closes
///
/// Exact for every h, however large: flows of h1 and h2 make the one of h1 + h2 (of random ones the
/// distributions do), and one of 0 changes nothing. Schemes apply all operators in order and, as
/// the counterpart within the same step, in the opposite order: a symmetric composition. What is
/// written depends on the stage and h alone; random numbers are those of the stage's key at {step,
/// part, coordinate, which} (random.hpp), so that neither the order of calls nor resumption changes
/// a bit. A step that an event cuts short keeps its number.
///
/// Source: R. I. McLachlan and G. R. W. Quispel, Acta Numerica 11 (2002) 341,
/// doi:10.1017/S0962492902000053; B. Leimkuhler and C. Matthews, Molecular Dynamics (2015),
/// doi:10.1007/978-3-319-16375-8, chapter 7.
namespace tomlin {

/// Arguments of a flow.
template <class Real>
struct FlowStage {
  const Real* position = nullptr;      ///< generalised coordinates, relative to the scene's origin
  const Real* inverse_mass = nullptr;  ///< zero where nothing moves, and in the padding
  Real* velocity = nullptr;
  Real* own = nullptr;     ///< variables of forces' own
  RandomKey key;           ///< of the scene's seed and the operator
  std::uint64_t step = 0;  ///< number of the step in the run
  std::uint64_t part = 0;  ///< which of an operator's flows in the step
  bool heat = false;       ///< false: what is returned does not matter
  /// Linear friction by the implicit midpoint rule in place of its exact flow: a coordinate keeps
  /// (1 - h gamma/2)/(1 + h gamma/2) of its velocity. Flows that forces hand out ignore it.
  bool midpoint = false;
};

template <class Real>
struct Flow {
  /// Returns the heat. Neither allocates nor throws.
  Real (*run)(const void* arguments, const FlowStage<Real>& stage, Real h) = nullptr;
  /// The operator as a force, for what lies within a step: adds it to stage.force, writes rates of
  /// its internal variables, returns the power that it takes. Null: there is none, as of noise.
  Real (*drag)(const void* arguments, const Stage<Real>& stage) = nullptr;
  const void* arguments = nullptr;
  RandomKey key;  ///< for the stage; given by the model
};

/// Noise without inertia, where there are no velocities for an operator: independent normal numbers
/// of mean 0 and variance 1, by which a scheme displaces coordinates.
template <class Real>
struct Noise {
  /// Writes those of the step to numbers[i] for each coordinate i of its body, padding included.
  void (*fill)(const void* arguments, const RandomKey& key, std::uint64_t step,
               Real* numbers) = nullptr;
  const void* arguments = nullptr;
  RandomKey key;
};

}  // namespace tomlin
