#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/scene/units.hpp"
#include "tests/framework/scene/scene_fixture.hpp"

/// Slips of the pen that make a file no TOML: each has one message, at the slip, in plain words,
/// with what would be right.
namespace tomlin::test {
namespace {

struct Slip {
  std::string old_text;  ///< in kRing
  std::string new_text;
  int line;
  int column;
  std::string key;                 ///< of the fault; empty: none
  std::vector<std::string> words;  ///< of the reason
  std::string cure;                ///< in what is admissible, or in the reason
};

Fault only_fault(const std::string& text) {
  try {
    (void)parsed(text);
  } catch (const InputError& error) {
    EXPECT_EQ(error.faults().size(), 1U) << error.what();
    return error.faults().front();
  }
  ADD_FAILURE() << "the scene is sound";
  return {};
}

std::vector<Slip> slips() {
  const std::string radius = R"(radius = "R")";
  const std::string dt = R"(integrator = { type = "euler", dt = 1e-4 })";
  return {
      // Quotes.
      {R"(type = "loop")", R"(type = "loop)", 10, 8, "type", {"closing \"", "missing"}, ""},
      {R"(type = "loop")", R"(type = 'loop")", 10, 8, "type", {"closing '", "missing"}, ""},
      {R"(type = "loop")", R"(type = """loop)", 10, 8, "type", {"\"\"\"", "end"}, ""},
      {R"(centre = [0.0, "R"])", R"(centre = [0.0, "R])", 14, 16, "", {"closing \""}, ""},
      {R"(type = "loop")", "type = loop", 10, 8, "type", {"in quotes"}, "\"loop\""},
      {R"(type = "loop")", "type = a ring", 10, 8, "type", {"in quotes"}, "\"a ring\""},
      {R"(type = "loop")", R"(type = "a \q")", 10, 12, "", {"backslash"}, "single quotes"},
      {R"(type = "loop")", R"(type = "a" "b")", 10, 12, "type", {"ended"}, "single quotes"},
      {R"(type = "euler")", "type = euler", 27, 23, "type", {"in quotes"}, "\"euler\""},
      {R"([0.0, "R"])", "[0.0, R]", 14, 16, "", {"in quotes"}, "\"R\""},
      {R"(type = "loop")", "type = \xE2\x80\x9Cloop\xE2\x80\x9D", 10, 8, "", {"straight"}, "\""},
      {"N = 8",
       "N = \xE2\x88\x92"
       "8",
       4,
       5,
       "",
       {"minus"},
       "-"},
      {"N = 8", "\xCE\xBE = 8", 4, 1, "", {"beyond ASCII"}, "in quotes"},
      // Expressions and words.
      {radius, "radius = 2 * R", 12, 10, "radius", {"expression", "quotes"}, "\"2 * R\""},
      {radius, "radius = sqrt(2)", 12, 10, "radius", {"in quotes"}, "\"sqrt(2)\""},
      {radius, "radius = (2 + R)", 12, 10, "radius", {"expression"}, "\"(2 + R)\""},
      {radius, "radius = 10^3", 12, 10, "radius", {"expression"}, "\"10^3\""},
      {radius, "radius = 10/v", 12, 10, "radius", {"expression"}, "\"10/v\""},
      {radius, "radius = -R", 12, 10, "radius", {"in quotes"}, "\"-R\""},
      {R"([0.0, "R"])", "(0.0, 1.0)", 14, 10, "centre", {"brackets"}, "[0.0, 1.0]"},
      {radius, "radius = True", 12, 10, "radius", {"small letters"}, "true"},
      {radius, "radius = yes", 12, 10, "radius", {"true"}, "true"},
      {radius, "radius = None", 12, 10, "radius", {"no such value"}, "leave the key out"},
      // Numbers.
      {"N = 8", "N = 08", 4, 5, "N", {"zero"}, "8"},
      {"N = 8", "N = .5", 4, 5, "N", {"before its point"}, "0.5"},
      {"N = 8", "N = 5.", 4, 5, "N", {"behind its point"}, "5.0"},
      {"N = 8", "N = 1e", 4, 5, "N", {"exponent"}, "digits"},
      {"N = 8", "N = 1d3", 4, 5, "N", {"exponent"}, "1e3"},
      {"N = 8", "N = 1,5", 4, 5, "N", {"point"}, "1.5"},
      {"N = 8", "N = 1_000_", 4, 5, "N", {"underscore"}, ""},
      {"N = 8", "N = 99999999999999999999", 4, 5, "N", {"too large"}, "exponent"},
      {"N = 8", "N = 2.5 nm", 4, 9, "N", {"no units"}, "2.5"},
      {"N = 8", "N = 2.5nm", 4, 8, "N", {"no units"}, "2.5"},
      {"N = 8", "N = 3 N/m", 4, 7, "N", {"no units"}, "3"},
      {"N = 8", "N = 8 9", 4, 7, "N", {"ended"}, "in quotes"},
      // Keys and values.
      {"N = 8", "N =", 4, 4, "N", {"value is missing"}, ""},
      {"N = 8", "N 8", 4, 1, "N", {"="}, "N = 8"},
      {"N = 8", "N : 8", 4, 1, "N", {"="}, "N = 8"},
      {"N = 8", "N == 8", 4, 4, "N", {"one ="}, ""},
      {"N = 8", "= 8", 4, 1, "", {"key", "missing"}, "KEY = VALUE"},
      {"N = 8", "number of = 8", 4, 1, "", {"no spaces"}, "number_of"},
      {"N = 8", "N", 4, 1, "", {"KEY = VALUE"}, "N = VALUE"},
      {"N = 8", "N = 8 M = 9", 4, 7, "", {"line of its own"}, "N = 8"},
      {"N = 8", "N = 8; M = 9", 4, 6, "", {"comment begins with #"}, ""},
      {"N = 8", "// all\nN = 8", 4, 1, "", {"comment begins with #"}, ""},
      {"N = 8", "N = 8 // all", 4, 7, "", {"comment begins with #"}, ""},
      {"N = 8", "N = 8\nN = 9", 5, 1, "N", {"twice", "line 4"}, "one of the two"},
      // Tables.
      {"[measure]", "[run]", 29, 1, "run", {"twice", "line 25"}, "one header"},
      {"[measure]", "[body]", 29, 1, "body", {"[[body]]", "line 8"}, "[[body]]"},
      {"[[force]]", "[force]", 19, 1, "force", {"[[force]]", "line 15"}, "[[force]]"},
      {"[measure]", "[measure", 29, 1, "", {"not closed"}, "[measure]"},
      {"[[body]]", "[[body]", 8, 1, "", {"not closed"}, "[[body]]"},
      {"[measure]", "measure]", 29, 1, "", {"not opened"}, "[measure]"},
      {"[measure]", "[measure] from = 1", 29, 11, "", {"line of its own"}, "[measure]"},
      {"[measure]", "[my window]", 29, 1, "", {"no spaces"}, "[my_window]"},
      // Lists, and tables in braces.
      {R"([0.0, "R"])", R"([0.0, "R")", 14, 10, "centre", {"closing ]"}, ""},
      {R"([0.0, "R"])", R"([0.0 "R"])", 14, 15, "centre", {"comma"}, ""},
      {R"([0.0, "R"])", R"([0.0, , "R"])", 14, 16, "centre", {"missing before this comma"}, ""},
      {dt, R"(integrator = { type = "euler", dt = 1e-4)", 27, 14, "integrator", {"closing }"}, "{"},
      {dt, R"(integrator = { type = "euler" dt = 1e-4 })", 27, 31, "integrator", {"comma"}, ""},
      {dt, R"(integrator = { type = "euler", dt = 1e-4, })", 27, 43, "integrator", {"comma"}, ""},
      {dt, "integrator = {\n type = \"euler\", dt = 1e-4 }", 27, 14, "integrator", {"line"}, "{"},
      {dt, R"(integrator = { type = "euler", dt = 1e-4 s })", 27, 42, "dt", {"no units"}, "1e-4"},
  };
}

TEST(Syntax, SlipsAreExplainedWhereTheyAre) {
  for (const Slip& slip : slips()) {
    SCOPED_TRACE(slip.old_text + " -> " + slip.new_text);
    const Fault fault = only_fault(replaced(slip.old_text, slip.new_text));
    EXPECT_EQ(fault.place.line, slip.line) << to_string(fault);
    EXPECT_EQ(fault.place.column, slip.column) << to_string(fault);
    EXPECT_EQ(fault.key, slip.key) << to_string(fault);
    for (const std::string& word : slip.words) {
      EXPECT_NE(fault.why.find(word), std::string::npos) << word << " in " << to_string(fault);
    }
    EXPECT_NE((fault.why + fault.admissible).find(slip.cure), std::string::npos)
        << to_string(fault);
    // Not the library's.
    EXPECT_EQ(fault.why.find("TOML"), std::string::npos) << to_string(fault);
    EXPECT_EQ(fault.why.find("saw"), std::string::npos) << to_string(fault);
  }
}

/// Whatever is cut out or put in, at whatever place: one fault, within the file, or none.
TEST(Syntax, AnyByteMayBeMissingOrDoubled) {
  const std::string sound = kRing;
  const auto lines = std::count(sound.begin(), sound.end(), '\n');
  for (std::size_t at = 0; at < sound.size(); ++at) {
    for (const std::string& byte : {std::string(), std::string(2, sound[at]), std::string("\""),
                                    std::string("["), std::string("}"), std::string("=")}) {
      const std::string spoilt = sound.substr(0, at) + byte + sound.substr(at + 1);
      try {
        (void)parsed(spoilt);
      } catch (const InputError& error) {
        for (const Fault& fault : error.faults()) {
          EXPECT_EQ(fault.place.file, "ring.toml");
          EXPECT_GE(fault.place.line, 1) << to_string(fault);
          EXPECT_LE(fault.place.line, lines + 2) << to_string(fault);
          EXPECT_GE(fault.place.column, 1) << to_string(fault);
          EXPECT_NE(fault.why, "");
        }
      }
    }
  }
}

TEST(Units, AreSeenBehindNumbers) {
  for (const char* text : {"2.5 nm", "2.5nm", "1 N/m", "0.3 eV/A^2", "-1e-10 m", "300 K", " 5 fs ",
                           "1 \xC2\xB5m", "1.4 \xC3\x85", "2 N m^-1", "3 kg*m/s^2", "10 (m/s)"}) {
    EXPECT_TRUE(unit_in(text)) << text;
  }
  for (const char* text : {"2.5", "2 * m", "2 / s", "2 x", "2 k", "m", "m 2", "", "2 R0", "1e",
                           "2 apples", "2 + 3 nm", "sqrt(2) m", "2 nm + 1 R"}) {
    EXPECT_FALSE(unit_in(text)) << text;
  }
  EXPECT_EQ(unit_in("2.5 nm")->column, 4U);
  EXPECT_EQ(unit_in("2.5 nm")->number, "2.5");
}

TEST(Units, AreExplainedWhereverANumberIsExpected) {
  struct Place {
    const char* old_text;
    const char* key;
    const char* new_text;
    int line;
    int column;
  };
  for (const Place& place :
       {Place{R"(radius = "R")", "body.ring.radius", R"(radius = "2.5 nm")", 12, 15},
        Place{"R = 1.0", "parameters.R", R"(R = "1 N/m")", 5, 8},
        Place{R"(centre = [0.0, "R"])", "body.ring.centre", R"(centre = [0.0, "3 nm"])", 14, 19},
        Place{"duration = 1e4", "run.duration", R"(duration = "10 ns")", 26, 16},
        Place{"count = \"N\"", "body.ring.count", R"(count = "8 m")", 11, 12},
        Place{"velocity = [1e-3, 0.0]", "force.driver.velocity", R"(velocity = ["1 m/s", 0])", 24,
              16}}) {
    const Fault fault = only_fault(replaced(place.old_text, place.new_text));
    EXPECT_EQ(fault.key, place.key);
    EXPECT_EQ(fault.place.line, place.line) << to_string(fault);
    EXPECT_EQ(fault.place.column, place.column) << to_string(fault);
    EXPECT_NE(fault.why.find("no units"), std::string::npos) << to_string(fault);
  }
  // A product with something that is not there.
  const Fault fault = only_fault(replaced(R"(radius = "R")", R"(radius = "2.5 * nm")"));
  EXPECT_NE(fault.why.find("[parameters]"), std::string::npos) << to_string(fault);
}

}  // namespace
}  // namespace tomlin::test
