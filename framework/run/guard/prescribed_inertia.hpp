#pragma once

#include <vector>

#include "framework/model/model.hpp"

/// The inertia of prescribed bodies: what it takes to accelerate them is part of their force and
/// work. Without inertia, and in quasistatic dynamics, there is none of it.
namespace tomlin {

class MeasureWindow;

/// m v^2/2 and I omega^2/2 of all prescribed bodies.
double prescribed_kinetic_energy(const Model& model, double time);

/// Whether a driver is a prescribed body with inertia whose velocity changes.
bool is_accelerated(const Model& model, const Model::Driver& driver);

/// Returns what a driver's running integrals lack to the integrals of its force on each axis and of
/// its power between two times, `gained` being the integrals' own changes: a scheme's sums over
/// accelerations in place of changes of momentum and energy, which are exact and see jumps. Zeros
/// for a driver that is no accelerated body.
std::vector<double> inertia_lacking(const Model& model, const Model::Driver& driver,
                                    const double* from_integrals, const double* to_integrals,
                                    double from, double to);

/// Returns inertia_lacking() over the window.
std::vector<double> inertia_lacking_in(const Model& model, const Model::Driver& driver,
                                       const MeasureWindow& window);

}  // namespace tomlin
