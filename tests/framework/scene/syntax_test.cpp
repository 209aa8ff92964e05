#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/scene/units.hpp"
#include "tests/framework/scene/scene_fixture.hpp"

/// Slips of the pen that make a file no TOML: each is one fault, at the slip, with what would be
/// right, and not in the words of the TOML library.
namespace tomlin::test {
namespace {

struct Slip {
  std::string old_text;  ///< in kRing
  std::string new_text;
  std::string place;  ///< and the key, if the fault has one
  std::string shown;  ///< in the message: what is missing, where it was first, what would be right
  std::string code = "scene.syntax";
};

Fault only_fault(const std::string& text) {
  try {
    (void)parsed(text);
  } catch (const InputError& error) {
    EXPECT_EQ(error.faults().size(), 1U) << error.what();
    return error.faults().front();
  }
  ADD_FAILURE() << "the scene is sound";
  return Fault(FaultCode::scene_syntax);
}

std::vector<Slip> slips() {
  const std::string radius = R"(radius = "R")";
  const std::string dt = R"(integrator = { type = "euler", dt = 1e-4 })";
  const std::string twice = "scene.duplicate_key";
  return {
      // Quotes.
      {R"(type = "loop")", R"(type = "loop)", "10:8 type", "\""},
      {R"(type = "loop")", R"(type = 'loop")", "10:8 type", "'"},
      {R"(type = "loop")", R"(type = """loop)", "10:8 type", "\"\"\""},
      {R"(centre = [0.0, "R"])", R"(centre = [0.0, "R])", "14:16", "\""},
      {R"(type = "loop")", "type = loop", "10:8 type", "\"loop\""},
      {R"(type = "loop")", "type = a ring", "10:8 type", "\"a ring\""},
      {R"(type = "loop")", R"(type = "a \q")", "10:12", "\\\\"},
      {R"(type = "loop")", R"(type = "a" "b")", "10:12 type", "\\\""},
      {R"(type = "euler")", "type = euler", "27:23 type", "\"euler\""},
      {R"([0.0, "R"])", "[0.0, R]", "14:16", "\"R\""},
      {R"(type = "loop")", "type = \xE2\x80\x9Cloop\xE2\x80\x9D", "10:8", "\""},
      {"N = 8",
       "N = \xE2\x88\x92"
       "8",
       "4:5", "-"},
      {"N = 8", "\xCE\xBE = 8", "4:1", ""},
      // Expressions and words.
      {radius, "radius = 2 * R", "12:10 radius", "\"2 * R\""},
      {radius, "radius = sqrt(2)", "12:10 radius", "\"sqrt(2)\""},
      {radius, "radius = (2 + R)", "12:10 radius", "\"(2 + R)\""},
      {radius, "radius = 10^3", "12:10 radius", "\"10^3\""},
      {radius, "radius = 10/v", "12:10 radius", "\"10/v\""},
      {radius, "radius = -R", "12:10 radius", "\"-R\""},
      {R"([0.0, "R"])", "(0.0, 1.0)", "14:10 centre", "[0.0, 1.0]"},
      {radius, "radius = True", "12:10 radius", "true"},
      {radius, "radius = yes", "12:10 radius", "true"},
      {radius, "radius = None", "12:10 radius", ""},
      // Numbers.
      {"N = 8", "N = 08", "4:5 N", "8"},
      {"N = 8", "N = .5", "4:5 N", "0.5"},
      {"N = 8", "N = 5.", "4:5 N", "5.0"},
      {"N = 8", "N = 1e", "4:5 N", ""},
      {"N = 8", "N = 1d3", "4:5 N", "1e3"},
      {"N = 8", "N = 1,5", "4:5 N", "1.5"},
      {"N = 8", "N = 1_000_", "4:5 N", ""},
      {"N = 8", "N = 99999999999999999999", "4:5 N", "1e23", "scene.out_of_range"},
      {"N = 8", "N = 2.5 nm", "4:9 N", "2.5"},
      {"N = 8", "N = 2.5nm", "4:8 N", "2.5"},
      {"N = 8", "N = 3 N/m", "4:7 N", "3"},
      {"N = 8", "N = 8 9", "4:7 N", ""},
      // Keys and values.
      {"N = 8", "N =", "4:4 N", ""},
      {"N = 8", "N 8", "4:1 N", "N = 8"},
      {"N = 8", "N : 8", "4:1 N", "N = 8"},
      {"N = 8", "N == 8", "4:4 N", "="},
      {"N = 8", "= 8", "4:1", "KEY = VALUE"},
      {"N = 8", "number of = 8", "4:1", "number_of"},
      {"N = 8", "N", "4:1", "N = VALUE"},
      {"N = 8", "N = 8 M = 9", "4:7", "N = 8"},
      {"N = 8", "N = 8; M = 9", "4:6", "#"},
      {"N = 8", "// all\nN = 8", "4:1", "#"},
      {"N = 8", "N = 8 // all", "4:7", "#"},
      {"N = 8", "N = 8\nN = 9", "5:1 N", "line 4", twice},
      // Tables.
      {"[measure]", "[run]", "29:1 run", "line 25", twice},
      {"[measure]", "[body]", "29:1 body", "line 8", twice},
      {"[[force]]", "[force]", "19:1 force", "line 15", twice},
      {"[measure]", "[measure", "29:1", "[measure]"},
      {"[[body]]", "[[body]", "8:1", "[[body]]"},
      {"[measure]", "measure]", "29:1", "[measure]"},
      {"[measure]", "[measure] from = 1", "29:11", "[measure]"},
      {"[measure]", "[my window]", "29:1", "[my_window]"},
      // Lists, and tables in braces.
      {R"([0.0, "R"])", R"([0.0, "R")", "14:10 centre", "]"},
      {R"([0.0, "R"])", R"([0.0 "R"])", "14:15 centre", "]"},
      {R"([0.0, "R"])", R"([0.0, , "R"])", "14:16 centre", ""},
      {dt, R"(integrator = { type = "euler", dt = 1e-4)", "27:14 integrator", "}"},
      {dt, R"(integrator = { type = "euler" dt = 1e-4 })", "27:31 integrator", ""},
      {dt, R"(integrator = { type = "euler", dt = 1e-4, })", "27:43 integrator", "}"},
      {dt, "integrator = {\n type = \"euler\", dt = 1e-4 }", "27:14 integrator", "}"},
      {dt, R"(integrator = { type = "euler", dt = 1e-4 s })", "27:42 dt", "1e-4"},
  };
}

TEST(Syntax, SlipsAreReportedWhereTheyAre) {
  for (const Slip& slip : slips()) {
    SCOPED_TRACE(slip.old_text + " -> " + slip.new_text);
    Fault fault = only_fault(replaced(slip.old_text, slip.new_text));
    const std::string message = fault.why + "; " + fault.admissible;
    EXPECT_NE(message.find(slip.shown), std::string::npos) << message;
    // Not the library's.
    EXPECT_EQ(message.find("TOML"), std::string::npos) << message;
    EXPECT_EQ(message.find("saw"), std::string::npos) << message;
    fault.value.clear();
    EXPECT_EQ(brief(fault), slip.place + " [" + slip.code + "]") << message;
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
  struct Case {
    const char* old_text;
    const char* new_text;
    const char* fault;
  };
  for (const Case& one :
       {Case{R"(radius = "R")", R"(radius = "2.5 nm")", R"(12:15 body.ring.radius = "2.5 nm")"},
        Case{"R = 1.0", R"(R = "1 N/m")", R"(5:8 parameters.R = "1 N/m")"},
        Case{R"(centre = [0.0, "R"])", R"(centre = [0.0, "3 nm"])",
             R"(14:19 body.ring.centre = "3 nm")"},
        Case{"duration = 1e4", R"(duration = "10 ns")", R"(26:16 run.duration = "10 ns")"},
        Case{"count = \"N\"", R"(count = "8 m")", R"(11:12 body.ring.count = "8 m")"},
        Case{"velocity = [1e-3, 0.0]", R"(velocity = ["1 m/s", 0])",
             R"(24:16 force.driver.velocity = "1 m/s")"}}) {
    const Fault fault = only_fault(replaced(one.old_text, one.new_text));
    EXPECT_EQ(brief(fault), std::string(one.fault) + " [expression.syntax]");
    EXPECT_TRUE(fault.why.starts_with(kNumbersHaveNoUnits)) << to_string(fault);
  }
  // A product with something that is not there.
  const Fault fault = only_fault(replaced(R"(radius = "R")", R"(radius = "2.5 * nm")"));
  EXPECT_EQ(fault.code, FaultCode::expression_unknown_name);
  EXPECT_NE(fault.why.find("[parameters]"), std::string::npos) << to_string(fault);
}

}  // namespace
}  // namespace tomlin::test
