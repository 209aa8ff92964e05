#include "framework/output/resumption.hpp"

#include <string>

#include <gtest/gtest.h>

#include "framework/output/checkpoint.hpp"
#include "tests/framework/output/journal_fixture.hpp"
#include "tests/framework/output/temporary_folder.hpp"

namespace tomlin::test {
namespace {

/// A folder as a run of `small_header()` leaves it when it is killed.
void leave_a_run(const TemporaryFolder& folder) {
  Checkpoint checkpoint;
  checkpoint.program_version = small_header().program_version;
  checkpoint.scene = scene_fingerprint(small_header().scene);
  checkpoint.journal = write_small_journal(folder / kJournalFile, 4);
  checkpoint.state = {std::byte{1}, std::byte{2}};
  write_checkpoint(folder / kCheckpointFile, checkpoint);
}

Scene small_scene() {
  Scene scene;
  scene.effective_toml = small_header().scene;
  return scene;
}

std::string refusal(const TemporaryFolder& temporary, const Scene& scene,
                    const std::string& version) {
  try {
    find_resumption(RunFolder(temporary.path(), Occupied::go_on), scene, version);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(Resumption, FindsTheCheckpoint) {
  const TemporaryFolder folder;
  leave_a_run(folder);
  const Resumption found =
      find_resumption(RunFolder(folder.path(), Occupied::go_on), small_scene(), "1.2.3");
  EXPECT_EQ(found.kind, Resumption::Kind::go_on);
  EXPECT_EQ(found.mark.rows, 4U);
  EXPECT_EQ(found.state.size(), 2U);
  EXPECT_EQ(found.layout.state, small_layout().state);
  EXPECT_TRUE(found.journal.open());
}

TEST(Resumption, OfAnotherVersionIsRefused) {
  const TemporaryFolder folder;
  leave_a_run(folder);
  const std::string why = refusal(folder, small_scene(), "1.2.4");
  EXPECT_NE(why.find("written by version 1.2.3"), std::string::npos) << why;
  EXPECT_NE(why.find("this is version 1.2.4"), std::string::npos) << why;
}

TEST(Resumption, OfAnotherSceneSaysWhatDiffers) {
  const TemporaryFolder folder;
  leave_a_run(folder);
  Scene scene = small_scene();
  scene.effective_toml = "a scene\nof three\nlines\n";
  const std::string why = refusal(folder, scene, "1.2.3");
  EXPECT_NE(why.find("line 2 of the effective scene was \"of two lines\" and is \"of three\""),
            std::string::npos)
      << why;
}

/// Each good in itself, but not of one run.
TEST(Resumption, OfFilesThatDoNotBelongTogetherIsRefused) {
  const TemporaryFolder folder;
  leave_a_run(folder);
  {
    const auto file = folder / kJournalFile;
    JournalWriter journal(file, own_journal(file, Absent::leave_it), small_header());
    write_on(journal, 1, 9);
  }
  const std::string why = refusal(folder, small_scene(), "1.2.3");
  EXPECT_NE(why.find("run.journal"), std::string::npos) << why;
}

TEST(Resumption, OfARunThatWasKilledAtOnceIsTheStart) {
  const TemporaryFolder folder;
  write_small_journal(folder / kJournalFile, 0);
  const auto kind = [&] {
    return find_resumption(RunFolder(folder.path(), Occupied::go_on), small_scene(), "1.2.3").kind;
  };
  EXPECT_EQ(kind(), Resumption::Kind::from_start);
  std::filesystem::resize_file(folder / kJournalFile, 40);
  EXPECT_EQ(kind(), Resumption::Kind::from_start);
  write_small_journal(folder / kJournalFile, 4);
  EXPECT_NE(refusal(folder, small_scene(), "1.2.3").find("4 samples"), std::string::npos);
}

}  // namespace
}  // namespace tomlin::test
