#include "framework/plot/sample_table.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/text/fault.hpp"
#include "tests/framework/output/temporary_folder.hpp"
#include "tests/support/faults.hpp"

namespace tomlin {
namespace {

constexpr const char* kTable =
    "time [time],driver.force.x [force],tip.velocity.x [length/time]\n"
    "0,0.10000000000000001,-1e-300\n"
    "5,-2.5,3\n";

class SampleTableTest : public testing::Test {
 protected:
  SampleTable table(const std::string& text) {
    test::write(file(), text);
    return SampleTable(file());
  }
  std::string file() const { return (folder_ / "observables.csv").string(); }

  /// The fault that reading all columns finds.
  std::vector<std::string> faults(const std::string& text) {
    try {
      table(text).read({0, 1, 2});
    } catch (const InputError& error) {
      EXPECT_EQ(error.faults().front().place.file, file());
      return test::briefs(error);
    }
    return {};
  }

  test::TemporaryFolder folder_;
};

TEST_F(SampleTableTest, ReadsTheHeader) {
  const SampleTable read = table(kTable);
  EXPECT_EQ(read.names(), (std::vector<std::string>{"time", "driver.force.x", "tip.velocity.x"}));
  EXPECT_EQ(read.columns()[2].unit, "length/time");
  EXPECT_EQ(read.find("driver.force.x"), 1U);
  EXPECT_FALSE(read.find("driver.force").has_value());
  EXPECT_EQ(table("time,b [x] [y]\n").columns()[0].unit, "");
  EXPECT_EQ(table("time,b [x] [y]\n").columns()[1].name, "b [x]");
}

TEST_F(SampleTableTest, ReadsTheColumnsAskedForInTheirOrder) {
  const auto columns = table(kTable).read({2, 0});
  ASSERT_EQ(columns.size(), 2U);
  EXPECT_EQ(columns[0], (std::vector<double>{-1e-300, 3.0}));
  EXPECT_EQ(columns[1], (std::vector<double>{0.0, 5.0}));
  EXPECT_EQ(table(kTable).read({1})[0][0], 0.1);
}

TEST_F(SampleTableTest, SaysWhereATableIsDamaged) {
  const std::string header = "time [time],a [x],b [y]\n";
  using Faults = std::vector<std::string>;
  EXPECT_EQ(faults(header + "0,1,2\n"), Faults{});
  EXPECT_EQ(faults(header + "0,1,2\n0,1\n"), Faults{"3:1 [file.damaged]"});
  EXPECT_EQ(faults(header + "0,1,2,3\n"), Faults{"2:1 [file.damaged]"});
  EXPECT_EQ(faults(header + "0,1.5x,2\n"), Faults{"2:3 1.5x [file.damaged]"});
  EXPECT_EQ(faults(header + "0,,2\n"), Faults{"2:3 \"\" [file.damaged]"});
  EXPECT_EQ(faults(header + "0,1,nan\n"), Faults{"2:5 nan [file.damaged]"});
  EXPECT_EQ(faults(header), Faults{"[plot.no_data]"});
  EXPECT_EQ(faults("x [length],y [length]\n"), Faults{"1:1 x [length],y [length] [file.invalid]"});
  EXPECT_EQ(faults(""), Faults{"1:1 [file.invalid]"});
}

TEST_F(SampleTableTest, AFileThatIsNotThereIsReported) {
  EXPECT_THROW(SampleTable{file()}, InputError);
  EXPECT_THROW(SampleTable{folder_.path().string()}, InputError);
}

TEST_F(SampleTableTest, ReadsTheTableOfASweep) {
  const auto read = [this](const std::string& text) {
    test::write(file(), text);
    return SampleTable(file(), SampleTable::Rows::points).read({1, 2});
  };
  const std::string header = "type,v,f.x [force],status,reason\n";
  const auto columns =
      read(header + "\"a, \"\"b\"\"\",1,,refused,\"no, never\"\na,2,3,finished,\n");
  EXPECT_EQ(columns[0], (std::vector<double>{1.0, 2.0}));
  EXPECT_TRUE(std::isnan(columns[1][0]));
  EXPECT_EQ(columns[1][1], 3.0);
  const auto refused = [&](const std::string& text) {
    try {
      read(text);
    } catch (const InputError& error) {
      return test::brief(error.faults().front());
    }
    return std::string();
  };
  EXPECT_EQ(refused(header + "a,1,x,finished,\n"), "2:5 x [file.damaged]");
  EXPECT_EQ(refused("time [time]\n0\n"), "1:1 time [time] [file.invalid]");
}

}  // namespace
}  // namespace tomlin
