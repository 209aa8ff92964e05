#include "framework/output/table.hpp"

#include <clocale>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/framework/output/disk_limit.hpp"
#include "tests/framework/output/temporary_folder.hpp"

namespace tomlin::test {
namespace {

namespace fs = std::filesystem;

RunLayout table_of(std::vector<SampleColumn> columns) {
  RunLayout layout;
  layout.columns = std::move(columns);
  return layout;
}

const RunLayout kColumns = table_of({{"time", "time"}, {"driver.force.x", "force"}});

TEST(Table, HasAHeaderWithUnitsAndOneRowPerSample) {
  const TemporaryFolder folder;
  TableWriter table(folder / "t.csv");
  table.begin(kColumns);
  table.sample({0.0, -0.5});
  table.sample({1.0, 2e-300});
  table.finish();
  EXPECT_EQ(content(folder / "t.csv"),
            "time [time],driver.force.x [force]\n0,-0.5\n1,2.0000000000000001e-300\n");
}

TEST(Table, NumbersReadBackAsTheSameBits) {
  const std::vector<double> numbers = {0.1,
                                       1.0 / 3.0,
                                       -0.0,
                                       5e-324,
                                       std::numeric_limits<double>::max(),
                                       std::nextafter(1.0, 2.0),
                                       123456789012345678.0};
  const TemporaryFolder folder;
  TableWriter table(folder / "t.csv");
  table.begin(table_of({{"x", "1"}}));
  for (const double x : numbers) table.sample({x});
  table.finish();

  std::string text = content(folder / "t.csv");
  text.erase(0, text.find('\n') + 1);
  for (const double x : numbers) {
    const double read = std::strtod(text.c_str(), nullptr);
    EXPECT_EQ(read, x);
    EXPECT_EQ(std::signbit(read), std::signbit(x));
    text.erase(0, text.find('\n') + 1);
  }
  EXPECT_EQ(text, "");
}

TEST(Table, IsTheSameInEveryLocale) {
  const char* changed = nullptr;
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"}) {
    if (changed == nullptr) changed = std::setlocale(LC_ALL, name);
  }
  if (changed == nullptr) GTEST_SKIP() << "no locale with a decimal comma is installed";
  const TemporaryFolder folder;
  TableWriter table(folder / "t.csv");
  table.begin(table_of({{"x", "1"}}));
  table.sample({0.5});
  table.finish();
  std::setlocale(LC_ALL, "C");
  EXPECT_EQ(content(folder / "t.csv"), "x [1]\n0.5\n");
}

TEST(Table, HasItsNameOnlyWhenItIsComplete) {
  const TemporaryFolder folder;
  {
    TableWriter table(folder / "t.csv");
    EXPECT_TRUE(fs::is_empty(folder.path()));
    table.begin(kColumns);
    table.sample({0.0, 1.0});
    EXPECT_FALSE(fs::exists(folder / "t.csv"));
    EXPECT_TRUE(fs::exists(folder / "t.csv.part"));
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(Table, LeavesOutThePositionsOfParticles) {
  const TemporaryFolder folder;
  TableWriter table(folder / "t.csv");
  RunLayout layout = kColumns;
  layout.dimension = 1;
  layout.bodies = {{"tip", {1.0, 1.0}}};
  table.begin(layout);
  table.sample({0.0, 1.0, 7.0, 8.0});
  table.finish();
  EXPECT_EQ(content(folder / "t.csv"), "time [time],driver.force.x [force]\n0,1\n");
}

TEST(Table, ThatNeverBeganLeavesNothing) {
  const TemporaryFolder folder;
  TableWriter table(folder / "t.csv");
  table.finish();
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(Table, NeverWritesWhatIsNotFinite) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()}) {
    const TemporaryFolder folder;
    TableWriter table(folder / "t.csv");
    table.begin(kColumns);
    table.sample({0.0, 1.0});
    const std::string message = output_error([&] { table.sample({1.0, bad}); });
    EXPECT_NE(message.find("sample 1: driver.force.x"), std::string::npos) << message;
    table.finish();
    EXPECT_EQ(content(folder / "t.csv"), "time [time],driver.force.x [force]\n0,1\n");
  }
}

TEST(Table, RefusesASampleOfAnotherLength) {
  const TemporaryFolder folder;
  TableWriter table(folder / "t.csv");
  table.begin(kColumns);
  EXPECT_THROW(table.sample({0.0}), OutputError);
}

TEST(Table, ReportsAFullDisk) {
  const TemporaryFolder folder;
  TableWriter table(folder / "t.csv");
  table.begin(kColumns);
  const DiskLimit limit(100000);
  std::size_t taken = 0;
  const std::string message = output_error([&] {
    for (; taken < 100000; ++taken) table.sample({0.1 * static_cast<double>(taken), 1.0 / 3.0});
  });
  EXPECT_NE(message.find((folder / "t.csv.part").string()), std::string::npos) << message;
  EXPECT_NE(message.find("File too large"), std::string::npos) << message;
  EXPECT_GT(taken, 1000U);
  EXPECT_FALSE(fs::exists(folder / "t.csv"));
}

TEST(Table, ReportsAFolderThatHasGone) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "run");
  TableWriter table(folder.path() / "run" / "t.csv");
  table.begin(kColumns);
  fs::remove_all(folder / "run");
  EXPECT_THROW(table.finish(), OutputError);

  TableWriter late(folder.path() / "run" / "t.csv");
  EXPECT_THROW(late.begin(kColumns), OutputError);
}

}  // namespace
}  // namespace tomlin::test
