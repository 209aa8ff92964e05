#include <cmath>

#include "tests/extremes/scenes.hpp"

namespace tomlin::test {
namespace {

const double kDragOfRing = 2.0 * std::sqrt(2.0) * 0.1;

/// Returns the corrugation on a ring of eight that cannot roll: its particles' mean phase.
double corrugation_of_ring(long double radius) {
  const long double pi = 3.141592653589793238462643383279503L;
  const long double side = radius / std::sqrt(2.0L);
  const long double turns = side - std::floor(side);
  const long double whole = radius - std::floor(radius);
  return static_cast<double>(
      0.1L * (2.0L * std::cos(2.0L * pi * whole) + 2.0L + 4.0L * std::cos(2.0L * pi * turns)) /
      8.0L);
}

/// Without decay a ring of mass 1 is a tip on the corrugation that its particles leave over.
ExtremeCase as_a_tip(const std::string& name, const std::string& extreme, double radius,
                     const std::string& coordinates) {
  const std::vector<Setting> tip = {
      {"V0", text_of(corrugation_of_ring(radius))},
      {"c", "2 * sqrt(2)"},
      {"x0", "0"},
      {"v", "0.1"},
      {"T", "10"},
  };
  return finishes(kRing, name, extreme,
                  {{"lambda", "0"},
                   {"R", text_of(radius)},
                   {"T", "10"},
                   {"body.ring.coordinates", coordinates}},
                  {is_that_of("drivers.driver.mean_force.x", kTip, tip, 1e-6,
                              "a tip on the mean corrugation of the particles"),
                   is("bodies.ring.rotation", 0.0, 1e-9, "symmetry: no torque")});
}

ExtremeCase off_the_substrate(const std::string& name, const std::string& extreme,
                              std::vector<Setting> settings, std::vector<FaultCode> warnings = {}) {
  return finishes(kRing, name, extreme, std::move(settings),
                  {is("drivers.driver.final_force.x", kDragOfRing, 1e-8,
                      "drag alone: the substrate's force underflows to 0")},
                  std::move(warnings));
}

}  // namespace

Subject geometry() {
  const std::vector<Setting> sharp = {{"lambda", "1e8"}, {"T", "0.3"}};
  std::vector<Setting> sharp_in_quadruple = sharp;
  sharp_in_quadruple.push_back({"run.number_type", "quadruple"});
  sharp_in_quadruple.push_back(dopri5(1e-12));
  return {
      "geometry",
      "Geometry: decay and radius of a ring",
      {as_a_tip("lambda_0", "lambda = 0, rigid", 1.0, "rigid"),
       as_a_tip("radius_1e_9", "a radius of 1e-9", 1e-9, "rigid"),
       as_a_tip("radius_1e6", "a radius of 1e6", 1e6, "rigid"),
       finishes(kRing, "lambda_1e8", "lambda = 1e8: a substrate 1e-4 high", sharp,
                {is_that_of("drivers.driver.mean_force.x", kRing, sharp_in_quadruple, 1e-6,
                            "quadruple precision and a tolerance of 1e-12")},
                {FaultCode::run_window_not_whole}),
       off_the_substrate("lambda_1e8_above", "lambda = 1e8, a tenth of a radius above it",
                         {{"lambda", "1e8"}, {"y0", "1.1 * R"}}),
       off_the_substrate("height_1e3", "a thousand radii above the substrate", {{"y0", "1e3 * R"}}),
       off_the_substrate("height_1e9", "1e9 radii above the substrate", {{"y0", "1e9 * R"}},
                         {FaultCode::number_type_coarse_positions}),
       fails(kRing, "height_1e300", "1e300 radii above the substrate", {{"y0", "1e300"}},
             {"positions along y are too far from zero"}),
       fails(kRing, "height_1e17_flexible", "1e17 radii above the substrate, flexible",
             {{"y0", "1e17"}, {"body.ring.coordinates", "particles"}},
             {"positions along y are too far from zero"}),
       refused(kRing, "radius_0", "a radius of 0", {{"R", "0"}, {"lambda", "0"}, {"y0", "1"}},
               {"radius", "> 0"}),
       fails(kRing, "radius_1e_160", "a rigid ring whose moment of inertia underflows",
             {{"R", "1e-160"}, {"lambda", "0"}}, {"moment of inertia", "other units"}),
       fails(kRing, "radius_1e160", "a rigid ring whose moment of inertia overflows",
             {{"R", "1e160"}, {"lambda", "0"}}, {"moment of inertia", "other units"}),
       fails(kRing, "radius_1e17", "a radius of 1e17 over a period of 1", {{"R", "1e17"}},
             {"positions along x are too far from zero"})}};
}

}  // namespace tomlin::test
