#include "framework/output/references.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tomlin::test {
namespace {

/// A scene of a body, two forces and an integrator that say what they are taken from.
class References : public testing::Test {
 protected:
  References() {
    name(ring_, "ring", "A. Author, J. 1 (1999) 2, doi:10.1/ring, eq. (2)");
    name(bonds_, "bonds", "A. Author, J. 1 (1999) 2, doi:10.1/ring, eq. (3); B. Old (1901)");
    name(drag_, "drag", "B. Old (1901)");
    name(scheme_, "scheme", "C. Third, doi:10.1/scheme");
    name(other_scheme_, "other_scheme", "D. Fourth, doi:10.1/other");
    scene_.bodies.resize(2);
    for (SceneBody& body : scene_.bodies) body.record = &ring_;
    scene_.forces.resize(2);
    scene_.forces[0].record = &bonds_;
    scene_.forces[1].record = &drag_;
    scene_.run.integrator.record = &scheme_;
  }

  static void name(ComponentRecord& record, const char* name, const char* source) {
    record.name = name;
    record.source = source;
  }

  /// "work: for, for", without tomlin's own, which must come last.
  static std::vector<std::string> lines(const std::vector<CitedWork>& works) {
    std::vector<std::string> result;
    for (const CitedWork& work : works) {
      std::string users;
      for (const std::string& user : work.used_for) users += (users.empty() ? "" : ", ") + user;
      result.push_back(work.work + ": " + users);
    }
    EXPECT_FALSE(result.empty());
    EXPECT_EQ(result.back().substr(0, 26), "The tomlin authors, tomlin");
    result.pop_back();
    return result;
  }

  BodyRecord ring_;
  ForceRecord bonds_, drag_;
  IntegratorRecord scheme_, other_scheme_;
  Scene scene_;
};

using Lines = std::vector<std::string>;

TEST_F(References, HaveEachWorkOnceWithAllThatItIsFor) {
  EXPECT_EQ(lines(references(scene_)),
            (Lines{"A. Author, J. 1 (1999) 2, doi:10.1/ring: ring, bonds",
                   "B. Old (1901): bonds, drag", "C. Third, doi:10.1/scheme: scheme"}));
}

TEST_F(References, HaveTheScenesOwn) {
  scene_.source = "Author, doi:10.1/RING, Fig. 5; E. Fifth, doi:10.1/fifth";
  const auto found = lines(references(scene_));
  ASSERT_EQ(found.size(), 4U);
  EXPECT_EQ(found[0], "A. Author, J. 1 (1999) 2, doi:10.1/ring: ring, bonds, scene");
  EXPECT_EQ(found[3], "E. Fifth, doi:10.1/fifth: scene");
}

TEST_F(References, AreOfTheIntegratorThatRan) {
  scene_.run.accuracy = 1e-4;
  EXPECT_EQ(lines(references(scene_)).size(), 2U);  // not known yet
  AccuracyResult accuracy;
  accuracy.scheme = &other_scheme_;
  EXPECT_EQ(lines(references(scene_, &accuracy)).back(), "D. Fourth, doi:10.1/other: other_scheme");
  accuracy.companion_scheme = &scheme_;
  EXPECT_EQ(lines(references(scene_, &accuracy)).back(), "C. Third, doi:10.1/scheme: scheme");
}

TEST_F(References, AreOfFormatsAndRandomNumbersWhereTheyAreUsed) {
  const std::size_t plain = lines(references(scene_)).size();
  scene_.output.trajectory = true;
  ASSERT_EQ(lines(references(scene_)).size(), plain + 1);
  EXPECT_NE(lines(references(scene_)).back().find("H5MD"), std::string::npos);
  scene_.output.trajectory_format = TrajectoryFormat::xyz;
  EXPECT_EQ(lines(references(scene_)).size(), plain);
  scene_.run.perturb.emplace();
  ASSERT_EQ(lines(references(scene_)).size(), plain + 1);
  EXPECT_NE(lines(references(scene_)).back().find("andom numbers"), std::string::npos);
  scene_.draws_random = true;
  ASSERT_EQ(lines(references(scene_)).size(), plain + 1);
  EXPECT_NE(lines(references(scene_)).back().find(": random numbers of the scene, perturb"),
            std::string::npos);
}

}  // namespace
}  // namespace tomlin::test
