#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "framework/cli/component_text.hpp"
#include "framework/cli/explanation.hpp"
#include "framework/cli/sections.hpp"
#include "framework/core/numbers/constants.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/scene/natural_units.hpp"
#include "framework/scene/title.hpp"

namespace tomlin {
namespace {

std::string text_of(double x) { return fmt::format("{:.4g}", x); }

std::string counted(std::size_t n, const char* one, const char* many) {
  return fmt::format("{} {}", n, n == 1 ? one : many);
}

std::string motion_of(const Explanation::Body& body) {
  if (body.coordinates == "particles") return "each particle moves";
  if (body.coordinates == "rigid") return "rigid";
  return body.coordinates;
}

void add_built(Sections& sections, const Explanation& e) {
  sections.section("built");
  std::size_t freedoms = 0;
  for (const Explanation::Body& body : e.bodies) {
    freedoms += body.degrees_of_freedom;
    sections.row(
        body.name,
        fmt::format("{}: {}, mass {}, {}: {}, {}", body.type,
                    counted(body.particles, "particle", "particles"), text_of(body.mass),
                    motion_of(body), counted(body.coordinate_count, "coordinate", "coordinates"),
                    counted(body.degrees_of_freedom, "degree of freedom", "degrees of freedom")));
  }
  for (const Explanation::Force& force : e.forces) {
    sections.row(force.name, fmt::format("{} on {}: acts on {}", force.type,
                                         fmt::join(force.bodies, ", "), to_string(force.element)));
  }
  sections.row("in all", fmt::format("{}, {}, {}", counted(e.bodies.size(), "body", "bodies"),
                                     counted(e.forces.size(), "force", "forces"),
                                     counted(freedoms, "degree of freedom", "degrees of freedom")));
  for (const Explanation::Part& part : e.parts) {
    if (part.built) sections.row(part.name, part.note);
  }
  sections.section("left out of this scene's forces");
  for (const auto& [force, why] : e.left_out) sections.row(force, why);
  sections.section("not built, since not asked for");
  for (const Explanation::Part& part : e.parts) {
    if (!part.built) sections.row(part.name, "off: " + part.note);
  }
}

std::string oscillation(double frequency) {
  return fmt::format("omega = {}, period 2 pi/omega = {}", text_of(frequency),
                     text_of(kTau / frequency));
}

void add_relaxation(Sections& sections, const Scales& scales) {
  sections.section("relaxation rate, curvature / friction coefficient");
  if (!(scales.relaxation_rate > 0.0)) return;
  sections.row("fastest of all",
               fmt::format("{}, relaxation time {}, a bound on all together",
                           text_of(scales.relaxation_rate), text_of(1.0 / scales.relaxation_rate)));
}

void add_frequencies(Sections& sections, const Scales& scales) {
  if (scales.damping.regime == Regime::no_inertia) return add_relaxation(sections, scales);
  sections.section("natural angular frequencies, omega = sqrt(stiffness or curvature / mass)");
  for (const ForceScale& force : scales.forces) {
    if (!(force.frequency > 0.0)) continue;
    std::string where = force.internal ? ", within the body" : "";
    if (!force.between.empty())
      where = fmt::format(", between {}", fmt::join(force.between, " and "));
    sections.row(force.force, oscillation(force.frequency) + where);
  }
  if (scales.frequency > 0.0) {
    sections.row("fastest of all", oscillation(scales.frequency) + ", a bound on all together");
  }
  sections.section("damping rates, coefficient / mass");
  for (const ForceScale& force : scales.forces) {
    if (!(force.damping_rate > 0.0)) continue;
    sections.row(force.force, fmt::format("{}, decay time {}", text_of(force.damping_rate),
                                          text_of(1.0 / force.damping_rate)));
  }
  const Damping& damping = scales.damping;
  if (damping.regime == Regime::no_oscillation) return;
  std::string ratio;
  if (damping.regime != Regime::undamped) {
    ratio = fmt::format(": {} times the critical damping 2 omega = {} of {}",
                        text_of(damping.rate / damping.critical), text_of(damping.critical),
                        damping.oscillator);
  }
  sections.row("regime", to_string(damping.regime) + ratio);
}

/// The parts that particles out of phase add cancel, but for rounding.
bool nothing_but_rounding(const Sliding& sliding) {
  constexpr double kRounding = 1e-9;
  return sliding.curvature_as_placed < kRounding * sliding.curvature;
}

std::string verdict(double s) {
  return s < 1.0 ? "s < 1: smooth sliding" : "s > 1: stick-slip possible";
}

void add_sliding(Sections& sections, const Explanation& e) {
  for (const Sliding& sliding : e.scales.sliding) {
    const bool alone = sliding.particles == 1;
    sections.section(fmt::format("{}: {} pulls over {} along {}", sliding.body, sliding.driver,
                                 sliding.substrate, axis_name(sliding.axis)));
    sections.row("stick-slip parameter",
                 fmt::format("s {} {} = substrate curvature {} / {} stiffness {}; {}",
                             alone ? "=" : "<=", text_of(sliding.stick_slip()),
                             text_of(sliding.curvature), sliding.bond.empty() ? "driver" : "series",
                             text_of(sliding.stiffness), verdict(sliding.stick_slip())));
    if (!sliding.bond.empty()) {
      sections.row("", fmt::format("the series of {}, {}, and {}, {}", sliding.driver,
                                   text_of(sliding.driver_stiffness), sliding.bond,
                                   text_of(sliding.bond_stiffness)));
    }
    if (!alone) {
      sections.row("", "an upper bound: all particles in phase");
      const double s = nothing_but_rounding(sliding) ? 0.0 : sliding.stick_slip_as_placed();
      sections.row("as placed", fmt::format("s = {} for the body as it is placed, moved without a "
                                            "change of shape",
                                            text_of(s)));
    }
    sections.row("washboard",
                 fmt::format("2 pi v/a = {}; one period a = {} takes {}, the run {}",
                             text_of(sliding.washboard_frequency), text_of(sliding.period),
                             text_of(kTau / sliding.washboard_frequency),
                             text_of(e.scene->run.duration * sliding.washboard_frequency / kTau)));
    if (sliding.rolling_radius > 0.0) {
      sections.row("circumference",
                   fmt::format("2 pi R/a = {} periods to a turn when rolling",
                               text_of(kTau * sliding.rolling_radius / sliding.period)));
    }
  }
}

void add_transmissions(Sections& sections, const Scales& scales) {
  for (const Transmission& one : scales.transmissions) {
    sections.section(
        fmt::format("{}: {} pulls along {}", one.body, one.driver, axis_name(one.axis)));
    sections.row("stick-slip parameter",
                 fmt::format("not known: {} acts on {}, and between {} and {} there is more than "
                             "one linear spring",
                             one.substrate, one.sliding_body, one.driver, one.sliding_body));
  }
}

void add_misfits(Sections& sections, const Scales& scales) {
  for (const Misfit& misfit : scales.misfits) {
    const auto fraction = as_fraction(misfit.ratio());
    sections.section(
        fmt::format("{} on {} along {}", misfit.body, misfit.substrate, axis_name(misfit.axis)));
    sections.row("spacing/period", fmt::format("{:.10g}, of {} and {}; misfit {}", misfit.ratio(),
                                               text_of(misfit.spacing), text_of(misfit.period),
                                               text_of(misfit.misfit())));
    sections.row("commensurability",
                 fraction ? fmt::format("commensurate, {}/{}", fraction->p, fraction->q)
                          : "incommensurate: no fraction with a denominator up to 1000 is close");
  }
}

void add_step(Sections& sections, const Explanation& e) {
  const Explanation::Step& step = e.step;
  sections.section("time step");
  if (step.accuracy) {
    sections.row("accuracy", fmt::format("{:g}: run tries all integrators and picks one; the cost "
                                         "below is of {} with its defaults",
                                         *step.accuracy, step.type));
  } else if (step.adaptive) {
    sections.row(step.type, "adaptive: chooses its own steps");
  } else if (std::isinf(step.stable_step)) {
    sections.row(step.type, fmt::format("dt = {}; nothing limits it", text_of(step.dt)));
  } else {
    sections.row(step.type,
                 fmt::format("dt = {}, {} of the stable step {}{}", text_of(step.dt),
                             text_of(step.part_of_stable_step()), text_of(step.stable_step),
                             step.stable ? "" : ": NOT STABLE"));
  }
  if (e.scales.shortest_time > 0.0) {
    sections.row(
        "shortest time scale",
        text_of(e.scales.shortest_time) + ", the least of 1/omega, 1/damping rate and a/(2 pi v)");
  }
  if (!e.scales.stiffest_force.empty()) sections.row("stiffest force", e.scales.stiffest_force);
  if (!step.adaptive) return;
  const NaturalUnits units = natural_units(*e.scene);
  sections.row("tolerances in", fmt::format("length {}, {}; time {}, {}", text_of(units.length),
                                            units.length_of, text_of(units.time), units.time_of));
}

/// A time of about this many seconds, as people say it.
std::string seconds_text(double seconds) {
  if (seconds < 120.0) return fmt::format("{:.2g} s", seconds);
  if (seconds < 2.0 * 3600.0) return fmt::format("{:.2g} min", seconds / 60.0);
  if (seconds < 48.0 * 3600.0) return fmt::format("{:.2g} h", seconds / 3600.0);
  return fmt::format("{:.2g} days", seconds / 86400.0);
}

std::string count_text(double count) {
  constexpr double kReadable = 1e7;
  return count < kReadable ? fmt::format("{:.0f}", count) : fmt::format("{:.3g}", count);
}

void add_cost(Sections& sections, const Explanation& e) {
  sections.section("cost");
  if (!e.cost) {
    sections.row("not known", "no step could be tried");
    return;
  }
  const Explanation::Cost& cost = *e.cost;
  // Fixed steps are counted, all else is estimated.
  const std::string about = cost.exact ? "" : "about ";
  sections.row("steps", (e.step.adaptive ? about : "") + count_text(cost.steps));
  sections.row("force evaluations", about + count_text(cost.evaluations));
  const std::string trial =
      cost.exact ? "the trial ran all of it"
                 : fmt::format("from a trial of {:.2g} % of the run", 100.0 * cost.part);
  sections.row("time on this machine", fmt::format("about {}, {}, {}", seconds_text(cost.seconds),
                                                   cost.instruction_set, trial));
  if (e.scene->output.every) sections.row("", "samples come on top of it");
}

void add_output(Sections& sections, const Explanation& e) {
  const OutputSettings& asked = e.scene->output;
  const OutputSize& size = e.output.size;
  sections.section("output, at most");
  if (asked.every) {
    sections.row(kTableFile,
                 fmt::format("{} rows, {}", count_text(size.rows), bytes_text(size.table)));
  }
  if (asked.every && asked.trajectory) {
    sections.row(asked.trajectory_format == "xyz" ? kXyzFile : kH5mdFile,
                 fmt::format("{} frames, {}", count_text(size.rows), bytes_text(size.trajectory)));
  }
  if (e.output.events) {
    sections.row(kEventsFile, fmt::format("a row for each of the first {} events", kMostEvents));
  }
  std::string journal;
  std::string store;
  if (size.store > 0.0) store = fmt::format(", {} {} likewise", kStoreFile, bytes_text(size.store));
  if (size.journal > 0.0) journal = fmt::format("{} {}, ", kJournalFile, bytes_text(size.journal));
  sections.row("on the way", fmt::format("{}{} {} and the next beside it{}", journal,
                                         kCheckpointFile, bytes_text(size.checkpoint), store));
  sections.row("room", std::isfinite(e.output.room)
                           ? bytes_text(e.output.room) + " in the current folder"
                           : std::string("not known"));
}

}  // namespace

std::string explanation_text(const Explanation& e) {
  const Scene& scene = *e.scene;
  const std::string title = title_of(scene);
  Sections sections;
  add_built(sections, e);
  add_frequencies(sections, e.scales);
  add_sliding(sections, e);
  add_transmissions(sections, e.scales);
  add_misfits(sections, e.scales);
  add_step(sections, e);
  add_cost(sections, e);
  add_output(sections, e);
  sections.section("warnings");
  for (const Warning& warning : e.warnings) sections.row(warning.key, to_string(warning));
  return fmt::format("{}: {} dimension{}, {} dynamics, {} numbers, {} units\n\n", title,
                     scene.dimension, scene.dimension == 1 ? "" : "s", scene.run.dynamics,
                     scene.run.number_type, scene.units) +
         sections.text();
}

}  // namespace tomlin
