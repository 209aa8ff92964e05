#include "framework/plot/sample_table.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/text/fault.hpp"
#include "tests/framework/output/temporary_folder.hpp"

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

  /// What reading all columns complains about, without the file's name.
  std::string complaint(const std::string& text) {
    try {
      const SampleTable read = table(text);
      read.read({0, 1, 2});
    } catch (const InputError& error) {
      return std::string(error.what()).substr(file().size());
    }
    return "";
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
  EXPECT_EQ(complaint(header + "0,1,2\n"), "");
  EXPECT_EQ(complaint(header + "0,1,2\n0,1\n"), ":3:1: error: 2 fields in a table of 3 columns");
  EXPECT_EQ(complaint(header + "0,1,2,3\n"), ":2:1: error: 4 fields in a table of 3 columns");
  EXPECT_EQ(complaint(header + "0,1.5x,2\n"), ":2:3: error: 1.5x: not a finite number");
  EXPECT_EQ(complaint(header + "0,,2\n"), ":2:3: error: \"\": not a finite number");
  EXPECT_EQ(complaint(header + "0,1,nan\n"), ":2:5: error: nan: not a finite number");
  EXPECT_EQ(complaint(header), ": error: there are no samples in it");
  EXPECT_EQ(complaint("x [length],y [length]\n"),
            ":1:1: error: x [length],y [length]: this is not a table of observables; admissible: "
            "a header that begins with \"time [time]\"");
  EXPECT_NE(complaint(""), "");
}

TEST_F(SampleTableTest, AFileThatIsNotThereIsReported) {
  EXPECT_THROW(SampleTable{file()}, InputError);
  EXPECT_THROW(SampleTable{folder_.path().string()}, InputError);
}

}  // namespace
}  // namespace tomlin
