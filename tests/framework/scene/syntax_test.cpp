#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/scene/units.hpp"
#include "tests/framework/scene/scene_fixture.hpp"

/// Files that are no TOML: one fault with the sentence of the TOML library, the line, a caret, and
/// what would be right where the text shows it.
namespace tomlin::test {
namespace {

struct Slip {
  std::string old_text;  ///< in kRing
  std::string new_text;
  std::string expected;  ///< a part of what would be right; empty: the text does not show it
  FaultCode code = FaultCode::scene_syntax;
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
  const std::string type = R"(type = "loop")";
  const std::string dt = R"(integrator = { type = "euler", dt = 1e-4 })";
  const FaultCode twice = FaultCode::scene_duplicate_key;
  return {
      {type, R"(type = "loop)", "closing \""},
      {type, R"(type = 'loop")", "closing '"},
      {type, "type = loop", "in quotes"},
      {type, R"(type = "a" "b")", ""},
      {type, "type = \"a\x01\"", "escape", FaultCode::scene_encoding},
      {R"(radius = "R")", "radius = 2 * R", "in quotes"},
      {R"(radius = "R")", "radius = sqrt(2)", "in quotes"},
      {R"(radius = "R")", "radius = True", "true"},
      {R"([0.0, "R"])", "[0.0, R]", "in quotes"},
      {R"([0.0, "R"])", R"([0.0, "R")", ""},
      {"N = 8", "N = .5", "0.5"},
      {"N = 8", "N = 1,5", "0.5"},
      {"N = 8", "N = 99999999999999999999", "1e23", FaultCode::scene_out_of_range},
      {"N = 8", "N = -99999999999999999999", "1e23", FaultCode::scene_out_of_range},
      {"N = 8", "N = 2.5 nm", "2.5; numbers have no units"},
      {"N = 8", "N =", ""},
      {"N = 8", "N 8", ""},
      {"N = 8", "N = 8; M = 9", "#"},
      {"N = 8", "// all\nN = 8", "#"},
      {"N = 8", "N = 8\nN = 9", "line 4", twice},
      {"N = 8", "N = 8\nN.M = 9", "line 4", twice},
      {"[measure]", "[run]", "line 25", twice},
      {"[measure]", "[body]", "line 8", twice},
      {"[[force]]", "[force]", "line 15", twice},
      {"[measure]", "[measure", ""},
      {dt, R"(integrator = { type = "euler", dt = 1e-4)", "closing }"},
      {dt, R"(integrator = { type = "euler", dt = 1e-4 s })", "1e-4; numbers have no units"},
  };
}

TEST(Syntax, SlipsAreReportedWithTheirLineAndWhatWouldBeRight) {
  for (const Slip& slip : slips()) {
    SCOPED_TRACE(slip.old_text + " -> " + slip.new_text);
    const Fault fault = only_fault(replaced(slip.old_text, slip.new_text));
    EXPECT_EQ(fault.code, slip.code);
    EXPECT_EQ(fault.admissible.empty(), slip.expected.empty()) << fault.admissible;
    EXPECT_NE(fault.admissible.find(slip.expected), std::string::npos) << fault.admissible;
    EXPECT_TRUE(fault.why.starts_with("no valid TOML: ")) << fault.why;
    const bool is_shown = fault.code != FaultCode::scene_encoding;
    EXPECT_EQ(to_string(fault).ends_with("^"), is_shown) << to_string(fault);
  }
}

TEST(Syntax, ACaretIsBelowTheColumn) {
  const std::string text = to_string(only_fault("[run]\n\tduration = \"\xC3\xA4\" 3\n"));
  EXPECT_TRUE(text.starts_with("ring.toml:2:17: error: ")) << text;
  EXPECT_TRUE(text.ends_with("[scene.syntax]\n  \tduration = \"\xC3\xA4\" 3\n  \t               ^"))
      << text;
  // A long line is not shown.
  const std::string longer = to_string(only_fault("a = \"" + std::string(300, 'b') + "\" c\n"));
  EXPECT_TRUE(longer.ends_with(" [scene.syntax]")) << longer;
}

TEST(Syntax, KeysOfOtherElementsAreNotGivenTwice) {
  const std::string elements = "[[force]]\ntype = \"a\"\n[force.sub]\nx = 1\n";
  const Fault fault = only_fault(elements + "[[force]]\ntype = b\n");
  EXPECT_EQ(brief(fault), "6:8  = type = b [scene.syntax]");
  EXPECT_EQ(only_fault(elements + "[[force]]\n[force.sub] x\n").code, FaultCode::scene_syntax);
  EXPECT_EQ(only_fault(elements + "[force.sub]\n").code, FaultCode::scene_duplicate_key);
  // Rows of lists are no tables.
  const std::string rows = "[[force]]\npairs = [\n[0, 1],\n[1, 2]]\n";
  EXPECT_EQ(only_fault(rows + "k = 1\n" + rows + "k = b\n").code, FaultCode::scene_syntax);
  EXPECT_EQ(only_fault(rows + "k = 1\nk = 2\n").code, FaultCode::scene_duplicate_key);
}

/// Whatever is cut out or put in, at whatever position: one fault, within the file, or none.
TEST(Syntax, AnyByteMayBeMissingOrDoubled) {
  const std::string valid = kRing;
  const auto lines = std::count(valid.begin(), valid.end(), '\n');
  for (std::size_t at = 0; at < valid.size(); ++at) {
    for (const std::string& byte : {std::string(), std::string(2, valid[at]), std::string("\""),
                                    std::string("["), std::string("}"), std::string("=")}) {
      const std::string spoilt = valid.substr(0, at) + byte + valid.substr(at + 1);
      try {
        (void)parsed(spoilt);
      } catch (const InputError& error) {
        for (const Fault& fault : error.faults()) {
          EXPECT_EQ(fault.location.file, "ring.toml");
          EXPECT_GE(fault.location.line, 1) << to_string(fault);
          EXPECT_LE(fault.location.line, lines + 2) << to_string(fault);
          EXPECT_GE(fault.location.column, 1) << to_string(fault);
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
