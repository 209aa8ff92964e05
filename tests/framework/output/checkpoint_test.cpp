#include "framework/output/checkpoint.hpp"

#include <cstddef>
#include <string>

#include <gtest/gtest.h>

#include "tests/framework/output/disk_limit.hpp"
#include "tests/framework/output/temporary_folder.hpp"

namespace tomlin::test {
namespace {

namespace fs = std::filesystem;

Checkpoint small_checkpoint() {
  Checkpoint checkpoint;
  checkpoint.program_version = "1.2.3";
  checkpoint.scene = scene_fingerprint("a scene");
  checkpoint.journal = {1000, 0x1234567890abcdef, 7, 3};
  for (int k = 0; k < 100; ++k) checkpoint.state.push_back(static_cast<std::byte>(k));
  return checkpoint;
}

std::string failure_of(const fs::path& file) {
  try {
    read_checkpoint(file);
    return "";
  } catch (const DamagedFile& error) {
    return error.what();
  }
}

TEST(Checkpoint, ComesBackAsItWasWritten) {
  const TemporaryFolder folder;
  const Checkpoint written = small_checkpoint();
  write_checkpoint(folder / "c", written);
  const Checkpoint read = read_checkpoint(folder / "c");
  EXPECT_EQ(read.program_version, written.program_version);
  EXPECT_EQ(read.scene, written.scene);
  EXPECT_EQ(read.journal, written.journal);
  EXPECT_EQ(read.state, written.state);
  EXPECT_FALSE(fs::exists(folder / "c.part"));
}

TEST(Checkpoint, IsReplacedWholeOrNotAtAll) {
  const TemporaryFolder folder;
  Checkpoint checkpoint = small_checkpoint();
  write_checkpoint(folder / "c", checkpoint);
  checkpoint.journal.rows = 8;
  {
    const DiskLimit limit(50);
    EXPECT_THROW(write_checkpoint(folder / "c", checkpoint), OutputError);
  }
  EXPECT_EQ(read_checkpoint(folder / "c").journal.rows, 7U);
  write_checkpoint(folder / "c", checkpoint);
  EXPECT_EQ(read_checkpoint(folder / "c").journal.rows, 8U);
}

TEST(Checkpoint, TornAnywhereIsRefused) {
  const TemporaryFolder folder;
  write_checkpoint(folder / "c", small_checkpoint());
  const std::string whole = content(folder / "c");
  for (std::size_t length = 0; length < whole.size(); ++length) {
    write(folder / "torn", whole.substr(0, length));
    EXPECT_NE(failure_of(folder / "torn"), "") << length;
  }
  write(folder / "longer", whole + '\0');
  EXPECT_NE(failure_of(folder / "longer"), "");
}

TEST(Checkpoint, EveryFlippedBitIsRefused) {
  const TemporaryFolder folder;
  write_checkpoint(folder / "c", small_checkpoint());
  const std::string whole = content(folder / "c");
  for (std::size_t k = 0; k < 8 * whole.size(); ++k) {
    std::string changed = whole;
    changed[k / 8] = static_cast<char>(changed[k / 8] ^ (1 << k % 8));
    const auto bytes = std::as_bytes(std::span(changed));
    EXPECT_THROW(parse_checkpoint("changed", bytes), DamagedFile) << k;
  }
}

TEST(Checkpoint, ReasonsSayWhatIsWrong) {
  const TemporaryFolder folder;
  write_checkpoint(folder / "c", small_checkpoint());
  std::string bytes = content(folder / "c");
  write(folder / "short", bytes.substr(0, bytes.size() - 1));
  EXPECT_NE(failure_of(folder / "short").find("truncated"), std::string::npos);
  bytes[40] ^= 1;
  write(folder / "changed", bytes);
  EXPECT_NE(failure_of(folder / "changed").find("checksum"), std::string::npos);
  EXPECT_NE(failure_of(folder / "absent").find("No such file"), std::string::npos);
  EXPECT_NE(failure_of(folder.path()).find("not a file"), std::string::npos);
}

}  // namespace
}  // namespace tomlin::test
