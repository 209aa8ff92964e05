#include "framework/core/text/citation.hpp"

#include <gtest/gtest.h>

namespace tomlin::test {
namespace {

TEST(Citation, IsAWorkAndAPlaceInIt) {
  const auto works = citations("A. Author, J. 1 (1999) 2, doi:10.1/x(3), eqs. (4) to (6)");
  ASSERT_EQ(works.size(), 1U);
  EXPECT_EQ(works[0].work, "A. Author, J. 1 (1999) 2, doi:10.1/x(3)");
  EXPECT_EQ(works[0].passage, "eqs. (4) to (6)");
}

TEST(Citation, WorksAreParted) {
  const auto works = citations(
      "B. Other (1901) 435; A. Author, doi:10.1/x;  C. Third, doi:10.2/y, "
      "table 3, SRKN^b_6 ; ");
  ASSERT_EQ(works.size(), 3U);
  EXPECT_EQ(works[0].work, "B. Other (1901) 435");
  EXPECT_EQ(works[0].passage, "");
  EXPECT_EQ(works[1].work, "A. Author, doi:10.1/x");
  EXPECT_EQ(works[1].passage, "");
  EXPECT_EQ(works[2].work, "C. Third, doi:10.2/y");
  EXPECT_EQ(works[2].passage, "table 3, SRKN^b_6");
}

TEST(Citation, OfNothingIsNone) {
  for (const char* source : {"", " ", "; ", " ;  ; "}) EXPECT_TRUE(citations(source).empty());
}

TEST(Citation, IsKnownByItsDoiWhateverItsWords) {
  const auto works = citations(
      "A. Author, J. 1, doi:10.1016/J.CPC.2014, eq. (1); author (1999), "
      "doi:10.1016/j.cpc.2014; author (1999); Author (1999)");
  ASSERT_EQ(works.size(), 4U);
  EXPECT_EQ(identity_of(works[0]), identity_of(works[1]));
  EXPECT_NE(identity_of(works[1]), identity_of(works[2]));
  EXPECT_NE(identity_of(works[2]), identity_of(works[3]));
}

}  // namespace
}  // namespace tomlin::test
