#include <cmath>

#include "tests/extremes/scenes.hpp"

namespace tomlin::test {
namespace {

/// A pair apart by 1 on a bond without a length swings through itself.
Value swings_through() {
  const double apart = std::cos(std::sqrt(2.0) * 10.0);
  return is("energy.potential", 0.5 * apart * apart, 1e-7, "its closed form");
}

NamedScene in_a_box(const NamedScene& scene, const std::string& length) {
  return {scene.name + " with `[box] lengths = [" + length + "], periodic = [true]`", "",
          scene.text + "\n[box]\nlengths = [" + length + "]\nperiodic = [true]\n"};
}

}  // namespace

Subject degenerate() {
  return {"degenerate",
          "Degenerate scenes",
          {fails(kPair, "coincident", "two bonded particles in one place", {{"d", "0"}},
                 {"coincide", "no direction"}),
           finishes(kPair, "coincident_without_length", "the same, the bond without a length",
                    {{"d", "0"}, {"l0", "0"}},
                    {is("energy.kinetic", 0.0, 0.0, "nothing moves"),
                     is("bodies.pair.centre_of_mass.x", 0.0, 0.0, "nothing moves")}),
           fails(kPair, "nearly_coincident", "1e-200 apart", {{"d", "1e-200"}},
                 {"coincide", "no direction"}),
           fails(kLine, "coincident_on_a_line", "two bonded particles in one place of a line",
                 {{"d", "0"}}, {"coincide", "no direction"}),
           fails(kLine, "coincident_on_a_line_fixed", "the same with fixed steps",
                 {{"d", "0"}, rk4(1e-2)}, {"coincide", "no direction"}),
           finishes(kLine, "at_rest_on_a_line", "the same, the bond without a length",
                    {{"d", "0"}, {"l0", "0"}},
                    {is("energy.kinetic", 0.0, 0.0, "nothing moves"),
                     is("bodies.pair.centre_of_mass.x", 0.0, 0.0, "nothing moves")}),
           finishes(kPair, "bond_without_length", "a bond of no length in the plane", {{"l0", "0"}},
                    {swings_through()}),
           finishes(kLine, "bond_without_length_on_a_line", "a bond of no length on a line",
                    {{"l0", "0"}}, {swings_through()}),
           refused(kPair, "bond_of_negative_length", "a bond of negative length", {{"l0", "-1"}},
                   {"negative"}),
           finishes(in_a_box(kChain, "1.0"), "one_in_a_box", "one particle in a box of its own",
                    {{"N", "1"}, {"V0", "0"}},
                    {is("drivers.driver.final_force.x", 0.1 * std::sin(1.0), 1e-9,
                        "one mass on the driver's spring")},
                    {FaultCode::run_window_not_whole}),
           refused(in_a_box(kChain, "1.5"), "box_of_no_period", "a box that no whole periods fill",
                   {{"N", "1"}}, {"period"}),
           refused(kTip, "period_0", "a period of 0", {{"a", "0"}, {"x0", "0"}}, {"period", "> 0"}),
           refused(kTip, "expression_overflow", "a number that overflows as it is read",
                   {{"V0", "1e400"}}, {"V0"})}};
}

}  // namespace tomlin::test
