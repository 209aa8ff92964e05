#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "tests/extremes/extreme_case.hpp"
#include "tests/extremes/observed.hpp"
#include "tests/extremes/page.hpp"
#include "tests/framework/output/temporary_folder.hpp"
#include "tests/support/paths.hpp"

/// Extreme scenes: right numbers, or a cause; never a NaN, a hang, a wrong number in silence.
namespace tomlin::test {

std::vector<Subject> subjects() {
  return {stiffness(), geometry(), driving(), damping(),   size(),
          far_away(),  steps(),    units(),   degenerate()};
}

namespace {

const std::string kPage = std::string(paths::source) + "/tests/EXTREMES.md";

void expect_words(const ExtremeCase& extreme, const std::string& text) {
  for (const std::string& word : extreme.words) {
    EXPECT_NE(text.find(word), std::string::npos) << '"' << word << "\" is not in: " << text;
  }
}

std::vector<std::string_view> ids_of(const std::vector<FaultCode>& codes) {
  std::vector<std::string_view> ids;
  for (const FaultCode code : codes) ids.push_back(id_of(code));
  return ids;
}

void expect_values(const ExtremeCase& extreme, const Observed& observed) {
  for (std::size_t k = 0; k < extreme.values.size(); ++k) {
    const Value& value = extreme.values[k];
    const double right = value.right();
    ASSERT_TRUE(std::isfinite(right)) << value.path;
    EXPECT_TRUE(std::abs(observed.values[k] - right) <= value.tolerance)
        << value.path << " is " << observed.values[k] << ", right is " << right << ", off by "
        << observed.values[k] - right << ", tolerance " << value.tolerance;
  }
}

void expect_as_it_must(const ExtremeCase& extreme, const Observed& observed) {
  EXPECT_FALSE(observed.hung) << "after " << extreme.seconds << " s";
  EXPECT_EQ(observed.not_finite, "");
  ASSERT_STREQ(to_string(observed.outcome), to_string(extreme.outcome)) << observed.message;
  if (extreme.outcome != Outcome::refused) {
    EXPECT_TRUE(observed.effective_reads);
  }
  if (extreme.outcome != Outcome::finished) {
    ASSERT_FALSE(extreme.words.empty()) << "a cause has words";
    expect_words(extreme, observed.message);
    return;
  }
  ASSERT_FALSE(extreme.values.empty()) << "a run that finishes has a right number";
  expect_values(extreme, observed);
  EXPECT_EQ(codes_of(observed.warnings), ids_of(extreme.warnings));
}

/// Outcomes of the cases that were run, for the page.
std::map<std::string, Observed>& all_observed() {
  static std::map<std::string, Observed> observed;
  return observed;
}

const Observed& observed_of(const ExtremeCase& extreme) {
  const auto found = all_observed().find(extreme.name);
  if (found != all_observed().end()) return found->second;
  return all_observed()[extreme.name] = observe(extreme);
}

std::string section_of(const Subject& subject) {
  std::vector<const Observed*> observed;
  for (const ExtremeCase& extreme : subject.cases) {
    observed.push_back(extreme.slow ? nullptr : &observed_of(extreme));
  }
  return page_section(subject, observed);
}

class Extreme : public testing::Test {
 public:
  explicit Extreme(ExtremeCase extreme) : extreme_(std::move(extreme)) {}
  void TestBody() override { expect_as_it_must(extreme_, observed_of(extreme_)); }

 private:
  ExtremeCase extreme_;
};

/// The page's section of a subject is the one that its cases make.
class Page : public testing::Test {
 public:
  explicit Page(Subject subject) : subject_(std::move(subject)) {}
  void TestBody() override {
    const std::string page = content(kPage);
    EXPECT_NE(page.find(section_of(subject_)), std::string::npos)
        << "tests/EXTREMES.md is not of these cases; write it anew: extremes_tests --write-page "
           "tests/EXTREMES.md";
    EXPECT_EQ(page.find(page_preface()), 0u);
  }

 private:
  Subject subject_;
};

/// Registers NAME.CASE, slow_NAME.CASE for a slow one, and NAME_page for the page's section.
void register_cases() {
  for (const Subject& subject : subjects()) {
    for (const ExtremeCase& extreme : subject.cases) {
      const std::string suite = (extreme.slow ? "slow_" : "") + subject.name;
      testing::RegisterTest(suite.c_str(), extreme.name.c_str(), nullptr, nullptr, __FILE__,
                            __LINE__, [extreme]() -> Extreme* { return new Extreme(extreme); });
    }
    testing::RegisterTest((subject.name + "_page").c_str(), "is_of_these_cases", nullptr, nullptr,
                          __FILE__, __LINE__, [subject]() -> Page* { return new Page(subject); });
  }
}

int write_page(const char* file) {
  std::ofstream page(file, std::ios::binary);
  page << page_preface();
  for (const Subject& subject : subjects()) page << section_of(subject);
  page.close();
  return page ? 0 : 1;
}

}  // namespace
}  // namespace tomlin::test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  if (argc == 3 && std::string(argv[1]) == "--write-page") return tomlin::test::write_page(argv[2]);
  if (argc > 1) {
    std::fputs("usage: extremes_tests [--write-page FILE] [--gtest_...]\n", stderr);
    return 2;
  }
  tomlin::test::register_cases();
  return RUN_ALL_TESTS();
}
