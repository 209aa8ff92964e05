#include "framework/scene/sweep_settings.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "framework/scene/scene_document.hpp"
#include "tests/framework/scene/scene_fixture.hpp"

namespace tomlin::test {
namespace {

SweepValues values_of(const std::string& text) {
  auto read = SweepValues::parse(text);
  if (auto* values = std::get_if<SweepValues>(&read)) return std::move(*values);
  ADD_FAILURE() << text << ": " << std::get<Wrong>(read).why;
  return SweepValues::listed({"0"});
}

std::vector<std::string> texts_in(const std::string& text) {
  const SweepValues values = values_of(text);
  std::vector<std::string> texts;
  for (std::size_t k = 0; k < values.size(); ++k) texts.push_back(values.text(k));
  return texts;
}

std::vector<double> numbers_in(const std::string& text) {
  const SweepValues values = values_of(text);
  EXPECT_TRUE(values.numeric()) << text;
  std::vector<double> numbers;
  for (std::size_t k = 0; k < values.size(); ++k) numbers.push_back(values.number(k));
  return numbers;
}

/// Decimal numbers where the exact value is one: what a person would have written.
TEST(SweepValues, GridsOfDecimals) {
  EXPECT_EQ(numbers_in("0:1:11"),
            (std::vector<double>{0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0}));
  EXPECT_EQ(numbers_in("1e-3:1e3:7:log"),
            (std::vector<double>{1e-3, 1e-2, 1e-1, 1.0, 10.0, 100.0, 1000.0}));
  EXPECT_EQ(numbers_in("5:1:3"), (std::vector<double>{5.0, 3.0, 1.0}));
  EXPECT_EQ(numbers_in("8:0.5:5:log"), (std::vector<double>{8.0, 4.0, 2.0, 1.0, 0.5}));
  EXPECT_EQ(numbers_in("-1:1:2:lin"), (std::vector<double>{-1.0, 1.0}));
}

TEST(SweepValues, EndsAreExactWhateverTheyAre) {
  for (const std::string text : {"0.1:0.7:13", "0.1:0.7:13:log", "1e-300:1e300:17:log",
                                 "1e308:-1e308:9", "4.9e-324:1:31:log", "1/3:2*pi:5"}) {
    const std::vector<double> x = numbers_in(text);
    const std::string from = text.substr(0, text.find(':'));
    EXPECT_EQ(x.front(), numbers_in(from).front()) << text;
    for (std::size_t k = 1; k + 1 < x.size(); ++k) {
      EXPECT_TRUE(std::isfinite(x[k]));
      EXPECT_TRUE((x[k - 1] < x[k]) == (x.front() < x.back())) << text << " " << k;
    }
  }
}

/// Each value is nearest to the exact one: a step of an ulp to either side is farther away. Long
/// doubles have 11 bits more, which decide all but one in a thousand.
TEST(SweepValues, AreTheNearestDoubles) {
  constexpr int n = 97;
  const std::vector<double> linear = numbers_in("0.1:0.7:98");
  const std::vector<double> logarithmic = numbers_in("0.01:70:98:log");
  const long double step = (std::log(70.0L) - std::log(static_cast<long double>(0.01))) / n;
  constexpr long double kHalf = 0.5L * (1.0L + 1e-2L);  // ulp, and what long doubles leave open
  for (int k = 0; k <= n; ++k) {
    const long double exact =
        ((n - k) * static_cast<long double>(0.1) + k * static_cast<long double>(0.7)) / n;
    const double ulp = std::nextafter(linear[k], 1e3) - linear[k];
    EXPECT_LE(std::fabs(linear[k] - exact), kHalf * ulp + 1e-17L) << k;
    const long double power = std::exp(std::log(static_cast<long double>(0.01)) + k * step);
    const double ulp_of_power = std::nextafter(logarithmic[k], 1e3) - logarithmic[k];
    EXPECT_LE(std::fabs(logarithmic[k] - power), kHalf * ulp_of_power + 1e-17L) << k;
  }
}

/// A text gives back the bits.
TEST(SweepValues, TextsAreTheNumbers) {
  const SweepValues values = values_of("0.1:70:31:log");
  for (std::size_t k = 0; k < values.size(); ++k) {
    EXPECT_EQ(std::stod(values.text(k)), values.number(k));
  }
  // Integer keys take them.
  EXPECT_EQ(texts_in("2:10:5"), (std::vector<std::string>{"2", "4", "6", "8", "10"}));
}

TEST(SweepValues, Lists) {
  EXPECT_EQ(texts_in("1, 2e-3 ,3"), (std::vector<std::string>{"1", "2e-3", "3"}));
  EXPECT_EQ(numbers_in("1,2*sqrt(4),pi"), (std::vector<double>{1.0, 4.0, std::acos(-1.0)}));
  EXPECT_EQ(texts_in("[1, 0],[2, 0]"), (std::vector<std::string>{"[1, 0]", "[2, 0]"}));
  EXPECT_EQ(texts_in("{ type = \"rk4\", dt = 1 },{ type = \"a,b\" }"),
            (std::vector<std::string>{"{ type = \"rk4\", dt = 1 }", "{ type = \"a,b\" }"}));
  EXPECT_EQ(texts_in("atan2(1, 2)"), (std::vector<std::string>{"atan2(1, 2)"}));
  EXPECT_FALSE(values_of("particles,rigid").numeric());
  EXPECT_FALSE(values_of("1,k").numeric());
}

/// However a value is written, results have it in one form; runs get what was written.
TEST(SweepValues, HaveOnePlainForm) {
  const auto plain = [](const std::string& text) {
    const SweepValues values = values_of(text);
    std::vector<std::string> texts;
    for (std::size_t k = 0; k < values.size(); ++k) texts.push_back(values.plain_text(k));
    return texts;
  };
  EXPECT_EQ(plain("1e-3,k/200"), (std::vector<std::string>{"0.001", "k/200"}));
  EXPECT_EQ(plain("rk4,\"rk4\",\"a,b\",\"1\""),
            (std::vector<std::string>{"rk4", "rk4", "a,b", "\"1\""}));
  EXPECT_EQ(values_of("1e-3,k").canonical(), values_of("0.001,k").canonical());
}

/// Beyond 2^53 doubles do not tell integers apart: lists keep what was written, grids are refused.
TEST(SweepValues, LargeIntegersKeepTheirDigits) {
  const std::string large = "9007199254740993,9007199254740992";
  EXPECT_FALSE(values_of(large).numeric());
  EXPECT_EQ(texts_in(large), (std::vector<std::string>{"9007199254740993", "9007199254740992"}));
  EXPECT_TRUE(std::holds_alternative<Wrong>(SweepValues::parse("1:9007199254740993:3")));
}

TEST(SweepValues, WhatIsNoAxisSaysWhy) {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"", "no values"},
      {"1,,2", "an empty value"},
      {"1:2", "two ends"},
      {"1:2:3:log:5", "two ends"},
      {"a:2:3", "\"a\""},
      {"1:nan:3", "\"nan\""},
      {"1:2:1", "\"1\""},
      {"1:2:2.5", "\"2.5\""},
      {"1:2:-3", "\"-3\""},
      {"0:2:3:log", "logarithm"},
      {"-1:2:3:log", "logarithm"},
      {"1:2:3:lg", "\"lg\""},
      {"1:2:99999999999999999999", "number of points"},
      {"1:2:200000000", "number of points"}};
  for (const auto& [text, why] : wrong) {
    auto read = SweepValues::parse(text);
    ASSERT_TRUE(std::holds_alternative<Wrong>(read)) << text;
    EXPECT_NE(std::get<Wrong>(read).why.find(why), std::string::npos)
        << text << ": " << std::get<Wrong>(read).why;
  }
  EXPECT_EQ(std::get<Wrong>(SweepValues::parse("1:2:3:lgo")).nearest, "log");
}

SweepSettings settings_over(const std::vector<std::pair<std::string, std::string>>& axes,
                            const std::vector<std::vector<std::string>>& zips = {}) {
  SweepSettings settings;
  for (const auto& [name, values] : axes) {
    settings.over.push_back({name, values_of(values), {"--over"}, values});
  }
  for (const auto& names : zips) settings.zips.push_back({names, {"--zip"}});
  return settings;
}

TEST(SweepDimensions, ZippedAxesAreOne) {
  std::vector<Fault> faults;
  const auto dimensions =
      sweep_dimensions(settings_over({{"a", "1,2"}, {"b", "1:3:3"}, {"c", "5,6"}, {"d", "1,2,3"}},
                                     {{"c", "a"}, {"b", "d"}}),
                       faults);
  EXPECT_TRUE(faults.empty());
  ASSERT_EQ(dimensions.size(), 2);
  EXPECT_EQ(dimensions[0].axes, (std::vector<std::size_t>{0, 2}));
  EXPECT_EQ(dimensions[0].count, 2);
  EXPECT_EQ(dimensions[1].axes, (std::vector<std::size_t>{1, 3}));
  EXPECT_EQ(dimensions[1].count, 3);
}

/// Faults of an axis have been reported already.
TEST(SweepDimensions, AxesThatAreWrongAreNoFaultOfAZip) {
  SweepSettings settings = settings_over({{"a", "1,2"}}, {{"a", "b"}});
  settings.unread = {"b"};
  std::vector<Fault> faults;
  sweep_dimensions(settings, faults);
  EXPECT_TRUE(faults.empty());
  settings.unread = {"c"};
  sweep_dimensions(settings, faults);
  EXPECT_EQ(faults.size(), 1);
}

TEST(SweepDimensions, AllFaultsTogether) {
  std::vector<Fault> faults;
  sweep_dimensions(settings_over({{"a", "1,2"}, {"b", "1,2,3"}, {"a", "4"}, {"c", "1,2"}},
                                 {{"a", "b"}, {"a", "c"}, {"bb", "c"}, {"b"}}),
                   faults);
  std::string codes;
  for (const Fault& fault : faults) codes += std::string(id_of(fault.code)) + "\n";
  EXPECT_EQ(codes,
            "scene.duplicate_key\nscene.wrong_count\nscene.conflict\nscene.unknown_name\n"
            "scene.conflict\nscene.wrong_count\nscene.conflict\n");
  faults.clear();
  sweep_dimensions(settings_over({{"a", "1:2:100000"}, {"b", "1:2:100000"}}), faults);
  ASSERT_EQ(faults.size(), 1);
  EXPECT_EQ(faults[0].code, FaultCode::scene_too_large);
}

const std::string kRun = std::string(kRing) + "\n[sweep]\n";

/// A run has no use for it, and its effective scene has none of it.
TEST(SweepTable, IsCheckedAndLeftOut) {
  const std::string sweep =
      "over = { k = \"1:2:3\", \"run.integrator.dt\" = [1e-4, 2e-4], R = [\"k\", 2] }\n"
      "zip = [\"k\", \"v\"]\nobservables = [\"driver.mean_force.x\"]\n";
  const std::string good =
      "over = { k = \"1:2:3\", run.integrator.dt = [1e-4, 2e-4], R = [1, 2] }\n"
      "zip = [[\"R\", \"run.integrator.dt\"]]\n"
      "refine = \"ring.turns=1/2\"\nrefine_along = \"k\"\nrefine_to = \"1e-3\"\n"
      "observables = [\"driver.mean_force.x\"]\n";
  EXPECT_EQ(faults_of(kRun + good), "");
  EXPECT_NE(faults_of(kRun + sweep), "");
  const SceneDocument document(kRun + good, "ring.toml");
  std::vector<Fault> found;
  const auto settings = document.sweep(found);
  EXPECT_TRUE(found.empty());
  ASSERT_TRUE(settings);
  ASSERT_EQ(settings->over.size(), 3);
  EXPECT_EQ(settings->over[1].name, "run.integrator.dt");
  EXPECT_EQ(settings->zips.size(), 1);
  EXPECT_FALSE(SceneDocument(kRing, "ring.toml").sweep(found));
}

TEST(SweepTable, ItsFaultsComeWithThoseOfTheScene) {
  const auto faults = [](const std::string& sweep) { return abridged(faults_of(kRun + sweep)); };
  EXPECT_NE(faults("ovre = { k = [1] }").find("[scene.unknown_key] did you mean over"),
            std::string::npos);
  EXPECT_EQ(faults("over = { kk = [1] }"), "ring.toml:37:15: kk = [1] [scene.unknown_key]\n");
  EXPECT_NE(faults("over = { body.rnig.radius = [1] }").find("did you mean ring"),
            std::string::npos);
  for (const std::string wrong :
       {"over = 1", "over = { k = 1.0 }", "over = { k = [] }", "over = { k = \"1:2\" }",
        "observables = \"x\"", "observables = [1]", "continue_from_neighbour = 1", "zip = 1",
        "zip = [\"k\", \"v\"]", "over = { sweep.x = [1] }", "refine_to = 1.0", "refine = 1",
        "over = { k = [1, 2] }\nrefine = \"x=y\"", "over = { k = [1] }\nrefine = \"x\"",
        "over = { k = [1, 2] }\nrefine = \"x\"\nrefine_to = 0",
        "over = { k = [1, 2] }\nrefine = \"x\"\nrefine_along = \"v\""}) {
    EXPECT_NE(faults(wrong).find("ring.toml:"), std::string::npos) << wrong << "\n"
                                                                   << faults(wrong);
  }
}

}  // namespace
}  // namespace tomlin::test
