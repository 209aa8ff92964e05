#pragma once

#include <memory>

#include "framework/run/observers/run_observer.hpp"

/// The kinds of observers, each in a file of its name.
namespace tomlin::observers {

ObserverKind force_means();       ///< mean_force, along and across the pull
ObserverKind end_of_run();        ///< final_force; centre_of_mass, velocity, rotation of bodies
ObserverKind body_motion();       ///< turns, rolling, mean_velocity
ObserverKind extremes();          ///< max_force, min_force, max_speed
ObserverKind equilibrium();       ///< equilibrium; ties
ObserverKind pull_events();       ///< static_force, effective_stiffness; slips and reversals
ObserverKind window_check();      ///< warnings of windows that say little of sliding
ObserverKind work();              ///< work, work_per_distance, distance, dissipated_per_period
ObserverKind friction_loops();    ///< trace, retrace, loop_area of drivers that reverse
ObserverKind body_events();       ///< hops and turns
ObserverKind event_counts();      ///< events
ObserverKind energy_ledger();     ///< energy
ObserverKind force_deviation();   ///< force_deviation, where it is asked for
ObserverKind forces_on_bodies();  ///< forces, where they are asked for
ObserverKind temperature();       ///< temperature of bodies, where there is noise
ObserverKind mean_errors();       ///< statistical errors of means, where there is noise
ObserverKind long_bonds();        ///< a warning of bonds as long as half the box

}  // namespace tomlin::observers
