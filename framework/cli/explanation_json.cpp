#include <cmath>

#include <nlohmann/json.hpp>

#include "framework/cli/component_text.hpp"
#include "framework/cli/explanation.hpp"
#include "framework/core/numbers/constants.hpp"
#include "framework/scene/natural_units.hpp"

namespace tomlin {
namespace {

using Json = nlohmann::ordered_json;

/// JSON has no infinity.
Json number(double x) { return std::isfinite(x) ? Json(x) : Json(); }

/// over/x, where there is any.
Json inverse(double over, double x) { return x > 0.0 ? Json(over / x) : Json(); }

Json bodies_json(const Explanation& e) {
  Json list = Json::array();
  for (const Explanation::Body& body : e.bodies) {
    list.push_back(
        Json{{"name", body.name},
             {"type", body.type},
             {"coordinates", body.coordinates},
             {"particles", body.particles},
             {"mass", body.mass},
             {"coordinate_count", body.coordinate_count},
             {"degrees_of_freedom", body.degrees_of_freedom},
             {"rolling_radius", body.rolling_radius > 0.0 ? Json(body.rolling_radius) : Json()}});
  }
  return list;
}

Json forces_json(const Explanation& e) {
  Json list = Json::array();
  for (const Explanation::Force& force : e.forces) {
    list.push_back(Json{{"name", force.name},
                        {"type", force.type},
                        {"bodies", force.bodies},
                        {"acts_on", to_string(force.element)}});
  }
  return list;
}

Json left_out_json(const Explanation& e) {
  Json list = Json::array();
  for (const auto& [force, why] : e.left_out) {
    list.push_back(Json{{"force", force}, {"why", why}});
  }
  return list;
}

Json parts_json(const Explanation& e) {
  Json list = Json::array();
  for (const Explanation::Part& part : e.parts) {
    list.push_back(Json{{"name", part.name}, {"built", part.built}, {"note", part.note}});
  }
  return list;
}

Json scales_json(const Scales& scales, const Scene& scene) {
  Json json;
  json["frequency"] = scales.frequency;
  json["relaxation_rate"] = scales.relaxation_rate;
  json["period"] = inverse(kTau, scales.frequency);
  json["damping_rate"] = scales.damping_rate;
  const NaturalUnits units = natural_units(scene);
  json["length"] = units.length;
  json["time"] = units.time;
  json["shortest_time"] = scales.shortest_time > 0.0 ? Json(scales.shortest_time) : Json();
  json["stiffest_force"] = scales.stiffest_force.empty() ? Json() : Json(scales.stiffest_force);
  json["forces"] = Json::array();
  for (const ForceScale& force : scales.forces) {
    json["forces"].push_back(Json{{"name", force.force},
                                  {"frequency", force.frequency},
                                  {"period", inverse(kTau, force.frequency)},
                                  {"damping_rate", force.damping_rate},
                                  {"internal", force.internal},
                                  {"between", force.between}});
  }
  const Damping& damping = scales.damping;
  const bool oscillates = damping.regime != Regime::no_oscillation;
  json["regime"] = to_string(damping.regime);
  json["critical_damping_rate"] = oscillates ? Json(damping.critical) : Json();
  json["damping_ratio"] = oscillates ? Json(damping.rate / damping.critical) : Json();
  json["oscillator"] = oscillates ? Json(damping.oscillator) : Json();
  return json;
}

Json sliding_json(const Scales& scales) {
  Json list = Json::array();
  for (const Sliding& sliding : scales.sliding) {
    list.push_back(
        Json{{"body", sliding.body},
             {"driver", sliding.driver},
             {"substrate", sliding.substrate},
             {"axis", axis_name(sliding.axis)},
             {"period", sliding.period},
             {"stiffness", sliding.stiffness},
             {"driver_stiffness", sliding.driver_stiffness},
             {"bond", sliding.bond.empty() ? Json() : Json(sliding.bond)},
             {"bond_stiffness", sliding.bond.empty() ? Json() : Json(sliding.bond_stiffness)},
             {"curvature", sliding.curvature},
             {"stick_slip", sliding.stick_slip()},
             {"stick_slip_is_upper_bound", sliding.particles > 1},
             {"stick_slip_as_placed", sliding.stick_slip_as_placed()},
             {"washboard_frequency", sliding.washboard_frequency},
             {"period_duration", inverse(kTau, sliding.washboard_frequency)},
             {"circumference_in_periods", sliding.rolling_radius > 0.0
                                              ? Json(kTau * sliding.rolling_radius / sliding.period)
                                              : Json()}});
  }
  return list;
}

Json transmissions_json(const Scales& scales) {
  Json list = Json::array();
  for (const Transmission& one : scales.transmissions) {
    list.push_back(Json{{"body", one.body},
                        {"driver", one.driver},
                        {"substrate", one.substrate},
                        {"sliding_body", one.sliding_body},
                        {"axis", axis_name(one.axis)}});
  }
  return list;
}

Json misfits_json(const Scales& scales) {
  Json list = Json::array();
  for (const Misfit& misfit : scales.misfits) {
    const auto fraction = as_fraction(misfit.ratio());
    list.push_back(Json{{"body", misfit.body},
                        {"substrate", misfit.substrate},
                        {"axis", axis_name(misfit.axis)},
                        {"spacing", misfit.spacing},
                        {"period", misfit.period},
                        {"ratio", misfit.ratio()},
                        {"misfit", misfit.misfit()},
                        {"fraction", fraction ? Json{fraction->p, fraction->q} : Json()}});
  }
  return list;
}

Json step_json(const Explanation::Step& step) {
  Json json;
  json["type"] = step.type;
  json["adaptive"] = step.adaptive;
  json["accuracy"] = step.accuracy ? Json(*step.accuracy) : Json();
  json["dt"] = step.adaptive ? Json() : Json(step.dt);
  json["stable_step"] = number(step.stable_step);
  json["part_of_stable_step"] = step.adaptive ? Json() : number(step.part_of_stable_step());
  json["stable"] = step.stable;
  return json;
}

Json cost_json(const std::optional<Explanation::Cost>& cost) {
  if (!cost) return {};
  return Json{{"steps", cost->steps},     {"force_evaluations", cost->evaluations},
              {"seconds", cost->seconds}, {"exact", cost->exact},
              {"tried_part", cost->part}, {"instruction_set", cost->instruction_set}};
}

Json output_json(const Explanation::Output& output) {
  const OutputSize& size = output.size;
  return Json{{"rows", size.rows},
              {"table_bytes", size.table},
              {"trajectory_bytes", size.trajectory},
              {"journal_bytes", size.journal},
              {"checkpoint_bytes", size.checkpoint},
              {"store_bytes", size.store},
              {"most_events", output.events ? kMostEvents : 0},
              {"room_bytes", number(output.room)}};
}

}  // namespace

std::string explanation_json(const Explanation& e) {
  const Scene& scene = *e.scene;
  Json json;
  json["scene"] = Json{{"file", scene.file},
                       {"name", scene.name},
                       {"dimension", scene.dimension},
                       {"dynamics", scene.run.dynamics},
                       {"number_type", scene.run.number_type},
                       {"units", scene.units},
                       {"duration", scene.run.duration}};
  json["bodies"] = bodies_json(e);
  json["forces"] = forces_json(e);
  json["left_out"] = left_out_json(e);
  json["parts"] = parts_json(e);
  json["scales"] = scales_json(e.scales, *e.scene);
  json["sliding"] = sliding_json(e.scales);
  json["transmissions"] = transmissions_json(e.scales);
  json["misfits"] = misfits_json(e.scales);
  json["integrator"] = step_json(e.step);
  json["cost"] = cost_json(e.cost);
  json["output"] = output_json(e.output);
  json["warnings"] = texts_of(e.warnings);
  json["warning_codes"] = codes_of(e.warnings);
  // Names may hold anything, broken UTF-8 included.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace tomlin
