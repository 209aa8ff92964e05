#include "tests/support/conformance.hpp"

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "tests/forcefields/formula_laws.hpp"

// Every force of the registry against what it declares, by the suite of `tomlin check`. What
// depends on a single force's formula has a test of its own elsewhere.

namespace tomlin::test {
namespace {

using Broken = std::map<std::string, std::string>;

constexpr std::uint64_t kSeeds[] = {20240611, 7, 424242};

/// Notes which ways to pair particles and to attach springs have come up, by dimension.
void note_kinds(const ForceRecord& record, const void* description, int dimension,
                std::set<std::string>& seen) {
  for (const Parameter& row : record.parameters) {
    const ParameterValue value = row.read(description);
    const std::string kind = std::to_string(dimension) + row.key;
    if (const auto* pairs = std::get_if<PairSelection>(&value)) {
      seen.insert(kind + std::to_string(static_cast<int>(pairs->kind)));
    }
    if (const auto* attach = std::get_if<Attachment>(&value)) {
      seen.insert(kind + std::to_string(static_cast<int>(attach->kind)));
    }
  }
}

/// Formulas are further below; a sheet that is fixed is in sheet_field_test.cpp.
bool has_scenes_of_its_own(const ForceRecord& record) {
  return record.name == "expression" || record.name == "sheet_field";
}

TEST(Conformance, EveryForceHasItsVerifiedProperties) {
  std::set<std::string> kinds;
  for (const auto& record : standard().forces()) {
    SCOPED_TRACE(record->name);
    EXPECT_NE(record->bind.in_quadruple, nullptr);
    Conformance check(*record);
    for (const std::uint64_t seed : kSeeds) check.examine_example(seed);
    EXPECT_EQ(check.examined(), 3);
    if (!has_scenes_of_its_own(*record)) {
      for (const std::uint64_t seed : kSeeds) {
        check.examine_everywhere(seed, {1, 2, 3, 5},
                                 [&](const void* description, const Arrangement& arrangement) {
                                   note_kinds(*record, description, arrangement.dimension, kinds);
                                 });
      }
      // One in three arrangements is in space.
      EXPECT_GT(check.examined(), record->name == "tersoff" ? 30 : 100);
    }
    EXPECT_EQ(check.broken(), Broken{});
  }
  // All, neighbours and lists; the centre of mass, each particle and one: in three dimensions.
  EXPECT_EQ(kinds.size(), 18u);
}

/// Every remainder of a group of eight, some after a whole group; sanitizers see each once, or it
/// takes minutes.
#ifdef __has_feature
#define TOMLIN_HAS_FEATURE(name) __has_feature(name)
#else
#define TOMLIN_HAS_FEATURE(name) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || TOMLIN_HAS_FEATURE(address_sanitizer)
const std::vector<std::size_t> kBodies = {1, 2, 3, 4, 5, 6, 7, 8, 9};
#else
const std::vector<std::size_t> kBodies = {1, 2, 3, 4, 5, 6, 7, 8, 9, 12, 15, 16, 17};
#endif

TEST(Conformance, BodiesOfEverySize) {
  for (const auto& record : standard().forces()) {
    if (has_scenes_of_its_own(*record)) continue;
    SCOPED_TRACE(record->name);
    Conformance check(*record);
    check.examine_everywhere(99, kBodies);
    const bool in_space_alone = record->name == "tersoff";
    constexpr int kOfEach = 7;  // scenes of so many particles at least, of a dozen arrangements
    constexpr int kOfEachInSpace = 4;  // all of those in three dimensions
    EXPECT_GE(check.examined(),
              (in_space_alone ? kOfEachInSpace : kOfEach) * static_cast<int>(kBodies.size()));
    Broken broken = check.broken();
    if (in_space_alone) {
      // Particles at distances of 1, 2, 3: at R + D = 3.0 of silicon second derivatives jump.
      broken.erase("hessian");
      broken.erase("number types");
    }
    EXPECT_EQ(broken, Broken{});
  }
}

/// Formulas of every kind: what one declares follows from its text.
TEST(Conformance, FormulasHaveTheirVerifiedProperties) {
  ASSERT_EQ(formula_texts().size(), kFormulas);
  std::set<Element> elements;
  for (std::size_t k = 0; k < kFormulas; ++k) {
    const ForceRecord record = formula_record(k);
    const FormulaText& text = formula_texts()[k];
    SCOPED_TRACE(*text.energy != '\0' ? text.energy : text.force[0]);
    elements.insert(record.element_of(record.make_description().get()));
    Conformance check(record);
    check.examine_everywhere(kSeeds[k % 3], {1, 3, 9});  // a group of particles and one more
    EXPECT_GT(check.examined(), 5);
    EXPECT_EQ(check.broken(), Broken{});
  }
  EXPECT_EQ(elements.size(), 4u);  // particles, centres, pairs and angles
}

}  // namespace
}  // namespace tomlin::test
