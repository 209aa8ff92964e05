#include "framework/core/text/words.hpp"

#include <gtest/gtest.h>

#include "framework/core/records/parameter.hpp"

namespace tomlin::test {
namespace {

enum class Side { left, right, other };

constexpr auto word_table(Side) {
  return std::to_array<Word<Side>>(
      {{Side::left, "left"}, {Side::right, "right"}, {Side::other, nullptr}});
}

struct Door {
  Side hinge = Side::other;
};

TEST(Words, AreReadBothWays) {
  EXPECT_STREQ(to_string(Side::right), "right");
  EXPECT_EQ(value_named<Side>("left"), Side::left);
  EXPECT_EQ(value_named<Side>("Left"), std::nullopt);
  EXPECT_EQ(value_named<Side>(""), std::nullopt);
}

TEST(Words, AValueNeedsNone) {
  EXPECT_EQ(to_string(Side::other), nullptr);
  EXPECT_EQ(words_of<Side>(), (std::vector<std::string>{"left", "right"}));
}

// A table that lacks a value, or has one at the position of another, fails to compile.
TEST(Words, ATableHasEveryValueInOrder) {
  static_assert(is_enumerator<Side::other>());
  static_assert(!is_enumerator<static_cast<Side>(3)>());
  static_assert(is_in_order(word_table(Side::left)));
  static_assert(
      !is_in_order(std::to_array<Word<Side>>({{Side::right, "right"}, {Side::left, "left"}})));
  static_assert(
      !is_in_order(std::to_array<Word<Side>>({{Side::left, "left"}, {Side::left, "right"}})));
}

TEST(Words, AreTheChoicesOfAParameter) {
  const Parameter row =
      parameter("hinge", &Door::hinge, dimension::none, "where it hangs").by_default(Side::right);
  EXPECT_EQ(row.choices, words_of<Side>());
  EXPECT_EQ(row.standard, ParameterValue(std::string("right")));
  Door door;
  EXPECT_EQ(row.read(&door), ParameterValue(std::string()));
  row.assign(&door, std::string("left"));
  EXPECT_EQ(door.hinge, Side::left);
  EXPECT_EQ(row.read(&door), ParameterValue(std::string("left")));
}

}  // namespace
}  // namespace tomlin::test
