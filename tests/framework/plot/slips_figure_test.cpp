#include "framework/plot/slips_figure.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/framework/plot/figure_folder.hpp"
#include "tests/support/faults.hpp"

namespace tomlin {
namespace {

constexpr const char* kSlipColumns =
    "time [time],event,name,duration [time],size,energy_lost [energy],peak_force [force]\n";

class SlipsFigure : public testing::Test {
 protected:
  SlipsFigure() : folder_("time [time]\n0\n") {
    folder_.add("events.csv", std::string(kSlipColumns) +
                                  "1,slip,d,0.1,1,0.5,0.6\n2,slip,d,0.1,2,,0.6\n"
                                  "2.5,reversal,d,0.1,100,,\n3,slip,d,0.1,2,0.7,0.6\n"
                                  "4,turn,\"a, b\",0,1,,\n5,slip,d,0.1,5,0.9,0.7\n");
  }

  Figure drawn() { return slips_figure({folder_.run()}, {""}, request_, notes_); }
  /// Heights of the bars.
  std::vector<double> heights() {
    const Polyline line = drawn().panels[0].curves[0].pieces[0];
    std::vector<double> result;
    for (std::size_t k = 1; k + 1 < line.size(); k += 2) result.push_back(line[k].y);
    return result;
  }

  test::RunFolderOfTexts folder_;
  SlipsRequest request_;
  std::vector<std::string> notes_;
};

TEST_F(SlipsFigure, CountsSlipsAndNothingElse) {
  request_.bins = 4;
  EXPECT_EQ(heights(), (std::vector<double>{1.0, 2.0, 0.0, 1.0}));  // edges at 1, 2, 3, 4, 5
  EXPECT_EQ(drawn().x_label.text, "size of a slip");
  request_.measure = SlipMeasure::energy;
  request_.bins = 2;
  EXPECT_EQ(heights(), (std::vector<double>{1.0, 2.0}));  // one has no energy
  request_.measure = SlipMeasure::peak_force;
  EXPECT_EQ(heights(), (std::vector<double>{3.0, 1.0}));
}

TEST_F(SlipsFigure, LogarithmicBinsHaveEqualRatios) {
  request_.bins = 2;
  request_.log_x = true;
  const Polyline line = drawn().panels[0].curves[0].pieces[0];
  EXPECT_DOUBLE_EQ(line[2].x / line[1].x, line[4].x / line[3].x);
  EXPECT_EQ(heights(), (std::vector<double>{3.0, 1.0}));
}

TEST_F(SlipsFigure, SeveralDriversAreToldApart) {
  folder_.add("events.csv",
              std::string(kSlipColumns) + "1,slip,d,0.1,1,0.5,0.6\n2,slip,e,0.1,2,,0.6\n");
  EXPECT_EQ(test::brief(test::refusal_of([&] { drawn(); })), "[command.missing_argument]");
  request_.driver = "e";
  EXPECT_EQ(drawn().panels[0].curves.size(), 1U);
  request_.driver = "f";
  EXPECT_EQ(test::brief(test::refusal_of([&] { drawn(); })), "[plot.no_data]");
}

TEST_F(SlipsFigure, RefusesWhatIsNoTableOfEvents) {
  folder_.add("events.csv", "a,b\n1,2\n");
  EXPECT_EQ(test::refusal_of([&] { drawn(); }).code, FaultCode::file_invalid);
  folder_.add("events.csv", std::string(kSlipColumns) + "1,slip,d\n");
  EXPECT_EQ(test::refusal_of([&] { drawn(); }).code, FaultCode::file_damaged);
  folder_.add("events.csv", std::string(kSlipColumns) + "1,slip,d,0.1,x,0.5,0.6\n");
  const Fault fault = test::refusal_of([&] { drawn(); });
  EXPECT_EQ(fault.code, FaultCode::file_damaged);
  EXPECT_EQ(fault.place.line, 2);
}

}  // namespace
}  // namespace tomlin
