#include "framework/scene/edit.hpp"

#include <string>

#include <gtest/gtest.h>

#include "framework/core/text/fault.hpp"
#include "tests/support/text.hpp"

// Settings written into a scene's text: what a person has written besides stays.

namespace tomlin::test {
namespace {

constexpr const char* kScene = R"(# about it
[parameters]
v = 1e-3   # slow

[[body]]
name = "tip"   # the only one
type = "point"

[[force]]
type = "driving_spring"
velocity = ["v"]

[run]
  duration = 10.0  # long
  integrator = { type = "rk4", dt = 1e-2 }   # fixed
# the end
)";

std::string with(const std::vector<Setting>& settings, std::string text = kScene) {
  return edited(text, "test.toml", settings);
}

TEST(Edit, ReplacesValuesWhereTheyStand) {
  EXPECT_EQ(with({}), kScene);
  EXPECT_EQ(with({{"v", "2.5"}}), replaced(kScene, "1e-3", "2.5"));
  EXPECT_EQ(with({{"run.integrator", "{ type = \"rk4\", dt = 0.5 }"}}),
            replaced(kScene, "{ type = \"rk4\", dt = 1e-2 }", "{ type = \"rk4\", dt = 0.5 }"));
  EXPECT_EQ(with({{"run.integrator.dt", "0.5"}}), replaced(kScene, "1e-2", "0.5"));
  EXPECT_EQ(with({{"force.driving_spring.velocity", "[\"2 * v\"]"}}),
            replaced(kScene, "[\"v\"]", "[\"2 * v\"]"));
}

TEST(Edit, AnExpressionIsText) {
  EXPECT_EQ(with({{"run.duration", "10 / v"}}), replaced(kScene, "10.0", "\"10 / v\""));
}

TEST(Edit, WhatIsAbsentBecomesALine) {
  EXPECT_EQ(with({{"run.dynamics", "\"overdamped\""}}),
            replaced(kScene, "# fixed\n", "# fixed\n  dynamics = \"overdamped\"\n"));
  EXPECT_EQ(with({{"body.tip.coordinates", "rigid"}}),
            replaced(kScene, "type = \"point\"\n", "type = \"point\"\ncoordinates = \"rigid\"\n"));
  EXPECT_EQ(with({{"output.every", "0.5"}}), std::string(kScene) + "\n[output]\nevery = 0.5\n");
}

TEST(Edit, ATextMayEndWithoutALineBreak) {
  EXPECT_EQ(with({{"run.number_type", "\"quadruple\""}}, "[run]\nduration = 1.0"),
            "[run]\nduration = 1.0\nnumber_type = \"quadruple\"\n");
}

TEST(Edit, KeepsByteOrderMarkAndLetters) {
  const std::string mark = "\xEF\xBB\xBF";
  const std::string text = mark + "# \u03bb\n[run]\nname = \"\u03bb\" # \u03bb\nduration = 1.0\n";
  EXPECT_EQ(with({{"run.duration", "2.0"}}, text), replaced(text, "1.0", "2.0"));
  EXPECT_EQ(with({{"run.name", "\"x\""}}, text), replaced(text, "\"\u03bb\"", "\"x\""));
}

TEST(Edit, ATableWithAHeaderLosesNothing) {
  const std::string text = R"([run]
duration = 10.0
[run.integrator] # mine
type = "rk4"  # fourth order
dt = 1e-2     # small

[output]
every = 1.0
)";
  EXPECT_EQ(with({{"run.integrator", "{ type = \"dopri5\", relative_tolerance = 1e-3 }"}}, text),
            R"([run]
duration = 10.0
[run.integrator] # mine
type = "dopri5"  # fourth order
# dt = 1e-2     # small
relative_tolerance = 0.001

[output]
every = 1.0
)");
}

TEST(Edit, RefusesWhatItCannotPlace) {
  EXPECT_THROW(with({{"body.other.coordinates", "rigid"}}), InputError);
  EXPECT_THROW(with({{"run.integrator.more", "1"}}), InputError);
  EXPECT_THROW(with({{"v.w", "1"}}), InputError);
}

}  // namespace
}  // namespace tomlin::test
