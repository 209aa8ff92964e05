#pragma once

#include <complex>
#include <memory>
#include <string>
#include <vector>

#include "framework/core/body.hpp"
#include "framework/core/registry.hpp"

/// Integrators as the registry knows them; what they see of a bound scene stands in
/// framework/core/system.hpp.
namespace tomlin {

template <class Real>
class Integrator;
template <class Real>
struct System;

struct IntegratorRecord : ComponentRecord {
  int order = 0;          ///< global order in the positions, velocity-dependent forces included
  bool adaptive = false;  ///< chooses its own steps
  int evaluations_per_step = 0;  ///< of all forces, per accepted step

  /// Growth factor |R(z)| on y' = lambda y, z = h lambda; stable where it does not exceed 1.
  double (*growth)(std::complex<double> z) = nullptr;
  /// The fixed step; 0 for an adaptive scheme.
  double (*step)(const void* description) = nullptr;
  /// Faults across keys; empty when sound.
  std::vector<Complaint> (*complaints)(const void* description) = nullptr;

  std::unique_ptr<Integrator<double>> (*bind)(const void* description,
                                              System<double>& system) = nullptr;
};

}  // namespace tomlin
