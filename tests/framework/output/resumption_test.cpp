#include "framework/output/resumption.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/output/checkpoint.hpp"
#include "tests/framework/output/journal_fixture.hpp"
#include "tests/framework/output/temporary_folder.hpp"
#include "tests/support/faults.hpp"

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

/// Refused at this file of the folder with this code, and with these in the message.
void expect_refused(const TemporaryFolder& temporary, const Scene& scene,
                    const std::string& version, const std::string& file, FaultCode code,
                    const std::vector<std::string>& named = {}) {
  const auto faults = thrown_faults(
      [&] { find_resumption(RunFolder(temporary.path(), Occupied::go_on), scene, version); });
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(brief(faults[0]), fmt::format("{} [{}]", (temporary / file).string(), id_of(code)));
  for (const std::string& name : named) {
    EXPECT_NE(faults[0].why.find(name), std::string::npos) << faults[0].why;
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
  expect_refused(folder, small_scene(), "1.2.4", kJournalFile, FaultCode::resume_other_version,
                 {"1.2.3", "1.2.4"});
}

TEST(Resumption, OfAnotherSceneSaysWhatDiffers) {
  const TemporaryFolder folder;
  leave_a_run(folder);
  Scene scene = small_scene();
  scene.effective_toml = "a scene\nof three\nlines\n";
  expect_refused(folder, scene, "1.2.3", kJournalFile, FaultCode::resume_other_scene,
                 {"line 2", "\"of two lines\"", "\"of three\""});
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
  expect_refused(folder, small_scene(), "1.2.3", kJournalFile, FaultCode::resume_other_scene);
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
  expect_refused(folder, small_scene(), "1.2.3", kCheckpointFile, FaultCode::resume_impossible,
                 {"4"});
}

}  // namespace
}  // namespace tomlin::test
