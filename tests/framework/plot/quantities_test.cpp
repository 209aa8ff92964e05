#include "framework/plot/quantities.hpp"

#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/text/fault.hpp"
#include "tests/framework/output/temporary_folder.hpp"
#include "tests/support/faults.hpp"

namespace tomlin {
namespace {

constexpr const char* kRing =
    "time [time],driver.force.x [force],driver.force.y [force],driver.position.x [length],"
    "ring.centre_of_mass.x [length],ring.centre_of_mass.y [length],ring.velocity.x [length/time],"
    "ring.velocity.y [length/time],ring.rotation [rad]\n0,0,0,0,0,0,0,0,0\n";

class Quantities : public testing::Test {
 protected:
  SampleTable table(const std::string& header) {
    const auto file = folder_ / "observables.csv";
    test::write(file, header);
    return SampleTable(file.string());
  }

  static Fault refusal(const SampleTable& table, const std::string& name,
                       const Owners& owners = {}) {
    try {
      find_series(table, name, owners, "--y");
    } catch (const InputError& error) {
      EXPECT_EQ(error.faults().front().place.file, table.file());
      return error.faults().front();
    }
    throw std::logic_error("it is found");
  }

  test::TemporaryFolder folder_;
};

TEST_F(Quantities, HaveDifferentNamesAndEveryFigureKnowsItsTwo) {
  std::set<std::string_view> names;
  for (const Quantity& quantity : quantities()) EXPECT_TRUE(names.insert(quantity.name).second);
  std::set<std::string_view> kinds;
  for (const FigureKind& kind : figure_kinds()) {
    EXPECT_TRUE(kinds.insert(kind.name).second);
    EXPECT_NE(find_quantity(kind.x), nullptr) << kind.name;
    EXPECT_NE(find_quantity(kind.y), nullptr) << kind.name;
  }
  EXPECT_EQ(find_quantity("frce"), nullptr);
  EXPECT_EQ(find_figure_kind("time"), nullptr);
}

TEST_F(Quantities, EveryOneIsFoundInTheTableOfARing) {
  const SampleTable ring = table(kRing);
  for (const Quantity& quantity : quantities()) {
    const Series series = find_series(ring, std::string(quantity.name), {}, "--y");
    EXPECT_FALSE(series.columns.empty());
    EXPECT_FALSE(series.unit.empty());
  }
  EXPECT_EQ(find_series(ring, "force", {}, "--y").columns, std::vector<std::size_t>{1});
  EXPECT_EQ(find_series(ring, "force_size", {}, "--y").columns, (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(find_series(ring, "speed", {}, "--y").unit, "length/time");
  EXPECT_EQ(find_series(ring, "height", {}, "--y").columns, std::vector<std::size_t>{5});
  EXPECT_EQ(find_series(ring, "rotation", {}, "--y").unit, "rad");
  EXPECT_EQ(find_series(ring, "ring.velocity.y", {}, "--y").columns, std::vector<std::size_t>{7});
}

TEST_F(Quantities, WhatIsNotThereIsAnsweredByWhatIs) {
  const SampleTable tip =
      table("time [time],driver.force.x [force],tip.velocity.x [length/time]\n");
  const Fault none = refusal(tip, "height");
  EXPECT_EQ(test::brief(none), "[plot.no_data]");
  EXPECT_TRUE(none.why.ends_with(" centre_of_mass.y")) << none.why;
  EXPECT_TRUE(none.admissible.starts_with("time, driver.force.x, tip.velocity.x;"));
  const Fault misspelt = refusal(tip, "driver.froce.x");
  EXPECT_EQ(test::brief(misspelt), "--y driver.froce.x [plot.no_data] did you mean driver.force.x");
  EXPECT_EQ(misspelt.admissible,
            "time, driver.force.x, tip.velocity.x, driver_position, force, force_size, position, "
            "height, rotation, speed");
}

TEST_F(Quantities, OneOfSeveralMustBeNamed) {
  const SampleTable two =
      table("time [time],left.force.x [force],right.force.x [force],b.rotation [rad]\n");
  const Fault several = refusal(two, "force");
  EXPECT_EQ(test::brief(several), "[command.missing_argument]");
  EXPECT_EQ(several.admissible, "--driver left, --driver right");
  EXPECT_EQ(test::brief(refusal(two, "force", {"rigth", ""})),
            "--driver rigth [plot.no_data] did you mean right");
  EXPECT_EQ(find_series(two, "force", {"right", ""}, "--y").columns, std::vector<std::size_t>{2});
  EXPECT_EQ(find_series(two, "rotation", {"right", "b"}, "--y").columns,
            std::vector<std::size_t>{3});
}

TEST_F(Quantities, TheSizeOfAForceHasTheSignOfItsXComponent) {
  const std::vector<double> back = {-3.0, 4.0};
  EXPECT_EQ(value_of(Measure::component, back), -3.0);
  EXPECT_EQ(value_of(Measure::size, back), 5.0);
  EXPECT_EQ(value_of(Measure::signed_size, back), -5.0);
  const std::vector<double> forward = {3.0, -4.0};
  EXPECT_EQ(value_of(Measure::signed_size, forward), 5.0);
}

}  // namespace
}  // namespace tomlin
