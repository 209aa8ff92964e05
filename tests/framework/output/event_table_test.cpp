#include "framework/output/event_table.hpp"

#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/framework/output/temporary_folder.hpp"

namespace tomlin::test {
namespace {

RunLayout with_events() {
  RunLayout layout;
  layout.events = true;
  return layout;
}

TEST(EventTable, HasARowForEveryEvent) {
  const double none = std::nan("");
  const TemporaryFolder folder;
  EventTable table(folder / "e.csv");
  table.begin(with_events());
  table.event({EventKind::slip, "driver", 1.5, 0.25, 1.0, 0.1, 0.5});
  table.event({EventKind::turn, "ring \"2\", small", 2.0, none, -1.0, none, none});
  table.event({EventKind::driver_reversal, "driver", 3.0, none, none, none, none});
  table.finish();
  EXPECT_EQ(content(folder / "e.csv"),
            "time [time],event,name,duration [time],size,energy_lost [energy],peak_force [force]\n"
            "1.5,slip,driver,0.25,1,0.10000000000000001,0.5\n"
            "2,turn,\"ring \"\"2\"\", small\",,-1,,\n"
            "3,driver_reversal,driver,,,,\n");
}

TEST(EventTable, IsThereWithoutEventsButNotWhereNoneCanHappen) {
  const TemporaryFolder folder;
  EventTable none(folder / "none.csv");
  none.begin(RunLayout());
  none.finish();
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  EventTable table(folder / "e.csv");
  table.begin(with_events());
  EXPECT_FALSE(std::filesystem::exists(folder / "e.csv"));
  table.finish();
  EXPECT_TRUE(std::filesystem::exists(folder / "e.csv"));
}

}  // namespace
}  // namespace tomlin::test
