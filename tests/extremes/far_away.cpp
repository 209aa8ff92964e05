#include "tests/extremes/scenes.hpp"

namespace tomlin::test {
namespace {

/// Everything is the same after whole periods, to the last bit.
ExtremeCase same_as_near(const std::string& name, const std::string& extreme,
                         const std::string& position, const std::string& near,
                         const Setting& scheme, std::vector<FaultCode> warnings = {}) {
  return finishes(kTip, name, extreme, {{"x0", position}, scheme},
                  {is_that_of("drivers.driver.mean_force.x", kTip, {{"x0", near}, scheme}, 0.0,
                              "the same run near zero")},
                  std::move(warnings));
}

}  // namespace

Subject far_away() {
  const std::string centre = "bodies.tip.centre_of_mass.x";
  return {"far_away",
          "Far away",
          {same_as_near("e12", "1e12 periods from zero", "1e12 + 0.5", "0.5", rk4(0.01),
                        {FaultCode::run_few_slips}),
           same_as_near("e12_backwards", "1e12 periods before zero", "-1e12 + 0.5", "0.5",
                        rk4(0.01), {FaultCode::run_few_slips}),
           same_as_near("e12_adaptive", "1e12 periods from zero, adaptive", "1e12 + 0.5", "0.5",
                        dopri5(1e-9), {FaultCode::run_few_slips}),
           same_as_near("e18", "1e18 periods from zero", "1e18", "0", rk4(0.01)),
           finishes(kTip, "e12_place", "1e12 periods from zero: the place itself",
                    {{"x0", "1e12 + 0.5"}, {"V0", "0"}},
                    {is(centre, 1e12 + 0.5 + 0.99, 2e-4,
                        "the driver less its lag; 1e12 rounds to "
                        "1.2e-4")}),
           fails(kTip, "e19", "2^63 periods from zero", {{"x0", "1e19"}},
                 {"positions along x are too far from zero"}),
           fails(kTip, "e300", "1e300 periods from zero", {{"x0", "1e300"}},
                 {"positions along x are too far from zero"})}};
}

}  // namespace tomlin::test
