#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/described.hpp"
#include "framework/cli/diagnostics.hpp"
#include "framework/cli/explanation.hpp"
#include "framework/cli/sections.hpp"
#include "framework/core/numbers/constants.hpp"
#include "framework/core/text/axis_names.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/output/trajectory.hpp"
#include "framework/scene/natural_units.hpp"
#include "framework/scene/title.hpp"

namespace tomlin {
namespace {

using Json = nlohmann::ordered_json;

/// Both forms of an explanation: what is added to one is added to the other beside it.
struct Forms {
  Json& json;  ///< numbers that are not finite are null
  Sections& text;
};

/// over/x; null where there is none.
Json inverse(double over, double x) { return x > 0.0 ? Json(over / x) : Json(); }

Json positive(double x) { return x > 0.0 ? Json(x) : Json(); }

Json word(const std::string& text) { return text.empty() ? Json() : Json(text); }

std::string counted(std::size_t n, const char* one, const char* many) {
  return fmt::format("{} {}", n, n == 1 ? one : many);
}

std::string motion_of(const Explanation::Body& body) {
  const bool flexible = body.coordinates == Coordinates::particles;
  return flexible ? "each particle moves" : to_string(body.coordinates);
}

void add_bodies(Forms& forms, const Explanation& e) {
  const bool metal = e.scene->units == UnitSystem::metal;
  forms.json["bodies"] = Json::array();
  for (const Explanation::Body& body : e.bodies) {
    forms.json["bodies"].push_back(Json{{"name", body.name},
                                        {"type", body.type},
                                        {"coordinates", to_string(body.coordinates)},
                                        {"particles", body.particles},
                                        {"mass", body.mass},
                                        {"coordinate_count", body.coordinate_count},
                                        {"degrees_of_freedom", body.degrees_of_freedom},
                                        {"rolling_radius", positive(body.rolling_radius)}});
    if (!body.note.empty()) forms.json["bodies"].back()["note"] = body.note;
    forms.text.row(
        body.name,
        fmt::format("{}: {}, mass {:.4g}{}, {}: {}, {}", body.type,
                    counted(body.particles, "particle", "particles"), body.mass, metal ? " u" : "",
                    motion_of(body), counted(body.coordinate_count, "coordinate", "coordinates"),
                    counted(body.degrees_of_freedom, "degree of freedom", "degrees of freedom")));
    if (!body.note.empty()) forms.text.row("", body.note);
  }
}

/// Adds the neighbours of the force that was added last.
void add_neighbours(Forms& forms, const NeighbourCount& count) {
  forms.json["forces"].back()["neighbours"] = Json{
      {"mean", count.mean}, {"most", count.most}, {"pairs", count.pairs}, {"bytes", count.bytes}};
  forms.text.row("", fmt::format("{:.4g} neighbours of a particle within cutoff and skin, at most "
                                 "{}; {} pairs, lists of {}",
                                 count.mean, count.most, count.pairs,
                                 bytes_text(static_cast<double>(count.bytes))));
}

void add_forces(Forms& forms, const Explanation& e) {
  forms.json["forces"] = Json::array();
  for (const Explanation::Force& force : e.forces) {
    const std::string acts_on = to_string(force.element);
    forms.json["forces"].push_back(Json{{"name", force.name},
                                        {"type", force.type},
                                        {"bodies", force.bodies},
                                        {"acts_on", acts_on}});
    if (!force.note.empty()) forms.json["forces"].back()["note"] = force.note;
    forms.text.row(force.name, fmt::format("{} on {}: acts on {}", force.type,
                                           fmt::join(force.bodies, ", "), acts_on));
    if (!force.note.empty()) forms.text.row("", force.note);
    if (force.neighbours) add_neighbours(forms, *force.neighbours);
  }
}

void add_built(Forms& forms, const Explanation& e) {
  forms.text.section("built");
  add_bodies(forms, e);
  add_forces(forms, e);
  std::size_t freedoms = 0;
  for (const Explanation::Body& body : e.bodies) freedoms += body.degrees_of_freedom;
  forms.text.row("in all",
                 fmt::format("{}, {}, {}", counted(e.bodies.size(), "body", "bodies"),
                             counted(e.forces.size(), "force", "forces"),
                             counted(freedoms, "degree of freedom", "degrees of freedom")));
  forms.json["left_out"] = Json::array();
  forms.json["parts"] = Json::array();
  for (const Explanation::Part& part : e.parts) {
    forms.json["parts"].push_back(
        Json{{"name", part.name}, {"built", part.built}, {"note", part.note}});
    if (part.built) forms.text.row(part.name, part.note);
  }
  forms.text.section("left out of this scene's forces");
  for (const auto& [force, why] : e.left_out) {
    forms.json["left_out"].push_back(Json{{"force", force}, {"why", why}});
    forms.text.row(force, why);
  }
  forms.text.section("available, but off");
  for (const Explanation::Part& part : e.parts) {
    if (!part.built) forms.text.row(part.name, part.note);
  }
}

std::string oscillation(double frequency) {
  return fmt::format("omega = {:.4g}, period 2 pi/omega = {:.4g}", frequency, kTau / frequency);
}

Json scales_json(const Explanation& e) {
  const Scales& scales = e.scales;
  const NaturalUnits units = natural_units(*e.scene);
  Json forces = Json::array();
  for (const ForceScale& force : scales.forces) {
    forces.push_back(Json{{"name", force.force},
                          {"frequency", force.frequency},
                          {"period", inverse(kTau, force.frequency)},
                          {"damping_rate", force.damping_rate},
                          {"damping_rate_at_rest", force.rate_at_rest},
                          {"internal", force.internal},
                          {"between", force.between}});
  }
  const Damping& damping = scales.damping;
  const bool oscillates = damping.regime != Regime::no_oscillation;
  return Json{{"frequency", scales.frequency},
              {"relaxation_rate", scales.relaxation_rate},
              {"period", inverse(kTau, scales.frequency)},
              {"damping_rate", scales.damping_rate},
              {"length", units.length},
              {"time", units.time},
              {"shortest_time", positive(scales.shortest_time)},
              {"stiffest_force", word(scales.stiffest_force)},
              {"forces", std::move(forces)},
              {"regime", to_string(damping.regime)},
              {"critical_damping_rate", oscillates ? Json(damping.critical) : Json()},
              {"damping_ratio", oscillates ? Json(damping.rate / damping.critical) : Json()},
              {"oscillator", oscillates ? Json(damping.oscillator) : Json()}};
}

void add_relaxation(Sections& sections, const Scales& scales) {
  sections.section("relaxation rate, curvature / friction coefficient");
  if (!(scales.relaxation_rate > 0.0)) return;
  sections.row("fastest of all",
               fmt::format("{:.4g}, relaxation time {:.4g}, a bound on all together",
                           scales.relaxation_rate, 1.0 / scales.relaxation_rate));
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
  bool dry = false;  // friction that is not linear
  for (const ForceScale& force : scales.forces) {
    if (force.damping_rate > 0.0) {
      sections.row(force.force, fmt::format("{:.4g}, decay time {:.4g}", force.damping_rate,
                                            1.0 / force.damping_rate));
    }
    if (!(force.rate_at_rest > 0.0)) continue;
    dry = true;
    sections.row(force.force, fmt::format("not linear: up to {:.4g} near rest, decay time {:.4g}",
                                          force.rate_at_rest, 1.0 / force.rate_at_rest));
  }
  const Damping& damping = scales.damping;
  if (damping.regime == Regime::no_oscillation) return;
  std::string ratio;
  if (damping.regime != Regime::undamped) {
    ratio = fmt::format(
        ": damping ratio {:.4g}, the rate over the critical one, 2 omega = {:.4g} of {}",
        damping.rate / damping.critical, damping.critical, damping.oscillator);
  }
  if (dry) {
    ratio += damping.regime == Regime::undamped ? " but for friction that is not linear"
                                                : "; without friction that is not linear";
  }
  sections.row("regime", to_string(damping.regime) + ratio);
}

/// The parts that particles out of phase add cancel, but for rounding.
bool nothing_but_rounding(const Sliding& sliding) {
  constexpr double kRoundingOfSum = 1e-9;  // of the sum of all parts in phase
  return sliding.curvature_as_placed < kRoundingOfSum * sliding.curvature;
}

std::string verdict(double s) {
  return s < 1.0 ? "s < 1: smooth sliding" : "s > 1: stick-slip possible";
}

/// Begins both forms of what a driver pulls over a substrate.
Json pulled_over(Forms& forms, const Sliding& sliding) {
  const char* axis = kAxisNames[sliding.axis];
  forms.text.section(fmt::format("{}: {} pulls over {} along {}", sliding.body, sliding.driver,
                                 sliding.substrate, axis));
  return Json{{"body", sliding.body},
              {"driver", sliding.driver},
              {"substrate", sliding.substrate},
              {"axis", axis}};
}

void add_sliding(Forms& forms, const Explanation& e) {
  Json& list = forms.json["sliding"] = Json::array();
  Sections& text = forms.text;
  for (const Sliding& sliding : e.scales.sliding) {
    const bool alone = sliding.particles == 1;
    const bool bonded = !sliding.bond.empty();
    const double s = sliding.stick_slip();
    const double frequency = sliding.washboard_frequency;
    const double revolution = kTau * sliding.rolling_radius / sliding.period;
    list.push_back(pulled_over(forms, sliding));
    list.back().update(Json{{"period", sliding.period},
                            {"stiffness", sliding.stiffness},
                            {"driver_stiffness", sliding.driver_stiffness},
                            {"bond", word(sliding.bond)},
                            {"bond_stiffness", bonded ? Json(sliding.bond_stiffness) : Json()},
                            {"curvature", sliding.curvature},
                            {"stick_slip", s},
                            {"stick_slip_is_upper_bound", sliding.particles > 1},
                            {"stick_slip_as_placed", sliding.stick_slip_as_placed()},
                            {"washboard_frequency", frequency},
                            {"period_duration", inverse(kTau, frequency)},
                            {"circumference_in_periods", positive(revolution)}});
    text.row("stick-slip parameter",
             fmt::format("s {} {:.4g} = substrate curvature {:.4g} / {} stiffness {:.4g}; {}",
                         alone ? "=" : "<=", s, sliding.curvature, bonded ? "series" : "driver",
                         sliding.stiffness, verdict(s)));
    if (bonded) {
      text.row("", fmt::format("the series of {}, {:.4g}, and {}, {:.4g}", sliding.driver,
                               sliding.driver_stiffness, sliding.bond, sliding.bond_stiffness));
    }
    if (!alone) {
      text.row("", "an upper bound: all particles in phase");
      text.row(
          "as placed",
          fmt::format("s = {:.4g} for the body as it is placed, moved without a change of shape",
                      nothing_but_rounding(sliding) ? 0.0 : sliding.stick_slip_as_placed()));
    }
    text.row("washboard",
             fmt::format("2 pi v/a = {:.4g}; one period a = {:.4g} takes {:.4g}, the run {:.4g}",
                         frequency, sliding.period, kTau / frequency,
                         e.scene->run.duration * frequency / kTau));
    if (revolution > 0.0) {
      text.row("circumference",
               fmt::format("2 pi R/a = {:.4g} periods to a turn when rolling", revolution));
    }
  }
}

/// Adds what is known where a force has no period or its curvature no bound.
void add_sliding_as_placed(Forms& forms, const Scales& scales) {
  Json& list = forms.json["sliding_as_placed"] = Json::array();
  for (const Sliding& sliding : scales.sliding_as_placed) {
    const double s = sliding.stick_slip_as_placed();
    list.push_back(pulled_over(forms, sliding));
    list.back().update(Json{{"period", positive(sliding.period)},
                            {"stiffness", sliding.stiffness},
                            {"stick_slip_as_placed", s}});
    forms.text.row(
        "stick-slip parameter",
        fmt::format("s = {:.4g} = substrate curvature {:.4g} / driver stiffness {:.4g}; {}", s,
                    sliding.curvature_as_placed, sliding.stiffness, verdict(s)));
    forms.text.row("", "for the body as it is placed, moved without a change of shape; " +
                           (sliding.period > 0.0
                                ? "the curvature depends on where it is"
                                : std::string("no period along ") + kAxisNames[sliding.axis]));
  }
}

void add_transmissions(Forms& forms, const Scales& scales) {
  Json& list = forms.json["transmissions"] = Json::array();
  for (const Transmission& one : scales.transmissions) {
    const char* axis = kAxisNames[one.axis];
    list.push_back(Json{{"body", one.body},
                        {"driver", one.driver},
                        {"substrate", one.substrate},
                        {"sliding_body", one.sliding_body},
                        {"axis", axis}});
    forms.text.section(fmt::format("{}: {} pulls along {}", one.body, one.driver, axis));
    forms.text.row("stick-slip parameter",
                   fmt::format("not known: {} acts on {}, and between {} and {} there is more than "
                               "one linear spring",
                               one.substrate, one.sliding_body, one.driver, one.sliding_body));
  }
}

void add_misfits(Forms& forms, const Scales& scales) {
  Json& list = forms.json["misfits"] = Json::array();
  for (const Misfit& misfit : scales.misfits) {
    const char* axis = kAxisNames[misfit.axis];
    const auto fraction = as_fraction(misfit.ratio());
    list.push_back(Json{{"body", misfit.body},
                        {"substrate", misfit.substrate},
                        {"axis", axis},
                        {"spacing", misfit.spacing},
                        {"period", misfit.period},
                        {"ratio", misfit.ratio()},
                        {"misfit", misfit.misfit()},
                        {"fraction", fraction ? Json{fraction->p, fraction->q} : Json()}});
    forms.text.section(fmt::format("{} on {} along {}", misfit.body, misfit.substrate, axis));
    forms.text.row("spacing/period",
                   fmt::format("{:.10g}, of {:.4g} and {:.4g}; misfit {:.4g}", misfit.ratio(),
                               misfit.spacing, misfit.period, misfit.misfit()));
    forms.text.row("commensurability",
                   fraction ? fmt::format("commensurate, {}/{}", fraction->p, fraction->q)
                            : "incommensurate: no fraction with a denominator up to 1000 is close");
  }
}

/// How the integrator's steps are chosen.
std::pair<std::string, std::string> row_of(const Explanation::Step& step) {
  if (step.accuracy) {
    return {"accuracy", fmt::format("{:g}: run tries all integrators and picks one; the cost "
                                    "below is of {} with its defaults",
                                    *step.accuracy, step.type)};
  }
  if (step.adaptive) return {step.type, "adaptive: chooses its own steps"};
  const std::string dt = fmt::format("dt = {:.4g}", step.dt);
  if (std::isinf(step.stable_step)) return {step.type, dt + "; nothing limits it"};
  return {step.type,
          fmt::format("{}, {:.4g} of the stable step {:.4g}{}", dt, step.part_of_stable_step(),
                      step.stable_step, step.stable ? "" : ": NOT STABLE")};
}

void add_step(Forms& forms, const Explanation& e) {
  const Explanation::Step& step = e.step;
  forms.json["integrator"] =
      Json{{"type", step.type},
           {"adaptive", step.adaptive},
           {"accuracy", step.accuracy ? Json(*step.accuracy) : Json()},
           {"dt", step.adaptive ? Json() : Json(step.dt)},
           {"stable_step", step.stable_step},
           {"part_of_stable_step", step.adaptive ? Json() : Json(step.part_of_stable_step())},
           {"stable", step.stable}};
  Sections& text = forms.text;
  text.section("time step");
  const auto [label, content] = row_of(step);
  text.row(label, content);
  if (e.scales.shortest_time > 0.0) {
    text.row("shortest time scale",
             fmt::format("{:.4g}, the least of 1/omega, 1/damping rate and a/(2 pi v)",
                         e.scales.shortest_time));
  }
  if (!e.scales.stiffest_force.empty()) text.row("stiffest force", e.scales.stiffest_force);
  if (!step.adaptive) return;
  const NaturalUnits units = natural_units(*e.scene);
  text.row("tolerances in", fmt::format("length {:.4g}, {}; time {:.4g}, {}", units.length,
                                        units.length_of, units.time, units.time_of));
}

/// A time of about this many seconds, as people say it.
std::string seconds_text(double seconds) {
  if (seconds < 120.0) return fmt::format("{:.2g} s", seconds);
  if (seconds < 2.0 * 3600.0) return fmt::format("{:.2g} min", seconds / 60.0);
  if (seconds < 48.0 * 3600.0) return fmt::format("{:.2g} h", seconds / 3600.0);
  return fmt::format("{:.2g} days", seconds / 86400.0);
}

std::string count_text(double count) {
  constexpr double kLargestInFull = 1e7;  // a count of more digits is rounded
  return count < kLargestInFull ? fmt::format("{:.0f}", count) : fmt::format("{:.3g}", count);
}

void add_cost(Forms& forms, const Explanation& e) {
  Sections& text = forms.text;
  text.section("cost");
  Json& json = forms.json["cost"];
  if (!e.cost) {
    text.row("not known", "no step could be tried");
    return;
  }
  const Explanation::Cost& cost = *e.cost;
  json = Json{{"steps", cost.steps},     {"force_evaluations", cost.evaluations},
              {"seconds", cost.seconds}, {"exact", cost.exact},
              {"tried_part", cost.part}, {"instruction_set", cost.instruction_set}};
  // Fixed steps are counted, all else is estimated.
  const std::string about = cost.exact ? "" : "about ";
  text.row("steps", (e.step.adaptive ? about : "") + count_text(cost.steps));
  text.row("force evaluations", about + count_text(cost.evaluations));
  const std::string trial =
      cost.exact ? "the trial ran all of it"
                 : fmt::format("from a trial of {:.2g} % of the run", 100.0 * cost.part);
  text.row("time on this machine", fmt::format("about {}, {}, {}", seconds_text(cost.seconds),
                                               cost.instruction_set, trial));
  if (e.scene->output.every) text.row("", "samples come on top of it");
}

void add_output(Forms& forms, const Explanation& e) {
  const OutputSettings& asked = e.scene->output;
  const OutputSize& size = e.output.size;
  forms.json["output"] = Json{{"rows", size.rows},
                              {"table_bytes", size.table},
                              {"trajectory_bytes", size.trajectory},
                              {"journal_bytes", size.journal},
                              {"checkpoint_bytes", size.checkpoint},
                              {"store_bytes", size.store},
                              {"most_events", e.output.events ? kMostEvents : 0},
                              {"room_bytes", e.output.room}};
  Sections& text = forms.text;
  text.section("output, at most");
  if (asked.every) {
    text.row(kTableFile, fmt::format("{} rows, {}", count_text(size.rows), bytes_text(size.table)));
  }
  if (asked.every && asked.trajectory) {
    text.row(trajectory_file_name(asked.trajectory_format),
             fmt::format("{} frames, {}", count_text(size.rows), bytes_text(size.trajectory)));
  }
  if (e.output.events) {
    text.row(kEventsFile, fmt::format("a row for each of the first {} events", kMostEvents));
  }
  std::string journal;
  std::string store;
  if (size.store > 0.0) store = fmt::format(", {} {} likewise", kStoreFile, bytes_text(size.store));
  if (size.journal > 0.0) journal = fmt::format("{} {}, ", kJournalFile, bytes_text(size.journal));
  text.row("temporary files", fmt::format("{}{} {} and the next beside it{}", journal,
                                          kCheckpointFile, bytes_text(size.checkpoint), store));
  text.row("free disk space", std::isfinite(e.output.room)
                                  ? bytes_text(e.output.room) + " in the current folder"
                                  : std::string("not known"));
}

void add_all(Forms& forms, const Explanation& e) {
  const Scene& scene = *e.scene;
  forms.json["scene"] = Json{{"file", scene.file},
                             {"name", scene.name},
                             {"dimension", scene.dimension},
                             {"dynamics", to_string(scene.run.dynamics)},
                             {"number_type", to_string(scene.run.number_type)},
                             {"units", to_string(scene.units)},
                             {"duration", scene.run.duration}};
  add_built(forms, e);
  forms.json["scales"] = scales_json(e);
  add_frequencies(forms.text, e.scales);
  add_sliding(forms, e);
  add_sliding_as_placed(forms, e.scales);
  add_transmissions(forms, e.scales);
  add_misfits(forms, e.scales);
  add_step(forms, e);
  add_cost(forms, e);
  add_output(forms, e);
  forms.json["warnings"] = texts_of(e.warnings);
  forms.json["warning_codes"] = codes_of(e.warnings);
  forms.text.section("warnings");
  for (const Warning& warning : e.warnings) forms.text.row(warning.key, to_string(warning));
}

}  // namespace

std::string explanation_text(const Explanation& e) {
  const Scene& scene = *e.scene;
  Json json;
  Sections text;
  Forms forms{json, text};
  add_all(forms, e);
  return fmt::format(
             "{}: {} dimension{}, {} dynamics, {} precision, {}\n\n", title_of(scene),
             scene.dimension, scene.dimension == 1 ? "" : "s", to_string(scene.run.dynamics),
             to_string(scene.run.number_type),
             scene.units == UnitSystem::metal ? "metal units (eV, A, ps, u, K)" : "reduced units") +
         text.text();
}

std::string explanation_json(const Explanation& e) {
  Json json;
  Sections text;
  Forms forms{json, text};
  add_all(forms, e);
  return json_text(json);
}

}  // namespace tomlin
