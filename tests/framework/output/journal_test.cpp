#include "framework/output/journal.hpp"

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/framework/output/disk_limit.hpp"
#include "tests/framework/output/journal_fixture.hpp"
#include "tests/framework/output/temporary_folder.hpp"

namespace tomlin::test {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kFew = 8;

/// Why reading the file failed, empty when it did not; what came before that is in `compared`.
std::string failure_of(const fs::path& file, Compared& compared) {
  try {
    JournalReader journal(file);
    journal.play(compared);
    return "";
  } catch (const DamagedFile& error) {
    return error.what();
  }
}

TEST(Journal, ComesBackAsItWasWritten) {
  const TemporaryFolder folder;
  const JournalMark end = write_small_journal(folder / "j", kFew);
  JournalReader journal(folder / "j");
  EXPECT_EQ(journal.header().program_version, "1.2.3");
  EXPECT_EQ(journal.header().scene, "a scene\nof two lines\n");
  const RunLayout& layout = journal.header().layout;
  EXPECT_EQ(layout.columns[1].name, "driver.force.x");
  EXPECT_EQ(layout.columns[1].unit, "force");
  EXPECT_EQ(layout.bodies[1].name, "chain");
  EXPECT_EQ(layout.bodies[1].mass, (std::vector<double>{0.5, 0.25}));
  EXPECT_EQ(layout.species, (std::vector<std::string>{"C", "H"}));
  EXPECT_EQ(layout.bodies[0].species, std::vector<std::int32_t>());
  EXPECT_EQ(layout.bodies[1].species, (std::vector<std::int32_t>{1, 0}));
  EXPECT_EQ(layout.dimension, 1);
  EXPECT_EQ(layout.box, std::vector<double>{8.0});
  EXPECT_EQ(layout.periodic, std::vector<bool>{true});
  EXPECT_TRUE(layout.events);
  EXPECT_EQ(layout.state, "position 3, clock 2");
  Compared compared;
  journal.play(compared);
  EXPECT_EQ(compared.begun, 1);
  EXPECT_EQ(compared.rows, kFew);
  EXPECT_EQ(compared.events, kFew);
  EXPECT_EQ(compared.wrong, 0);
  EXPECT_EQ(journal.mark(), end);
  EXPECT_EQ(journal.size(), end.bytes);
}

TEST(Journal, HoldsMoreThanABlock) {
  constexpr std::uint64_t kMany = 20000;
  const TemporaryFolder folder;
  {
    JournalWriter journal(folder / "j", own_journal(folder / "j", Absent::make_it), small_header());
    for (std::uint64_t k = 0; k < kMany; ++k) {
      journal.row(small_row(k));
      journal.event(small_event(k));
    }
    journal.flush();
  }
  Compared compared;
  EXPECT_EQ(failure_of(folder / "j", compared), "");
  EXPECT_EQ(compared.rows, kMany);
  EXPECT_EQ(compared.events, kMany);
  EXPECT_EQ(compared.wrong, 0);
}

TEST(Journal, HoldsRowsLargerThanABlock) {
  const TemporaryFolder folder;
  JournalHeader header = small_header();
  header.layout.bodies = {{"crowd", std::vector<double>(100000, 1.0)}};
  const std::vector<double> row(header.layout.row(), 0.1);
  {
    JournalWriter journal(folder / "j", own_journal(folder / "j", Absent::make_it), header);
    for (int k = 0; k < 3; ++k) journal.row(row);
    EXPECT_THROW(journal.row(std::vector<double>(3, 0.0)), OutputError);
    journal.flush();
  }
  JournalReader journal(folder / "j");
  Compared counted;
  journal.play(counted);
  EXPECT_EQ(counted.rows, 3U);
}

TEST(Journal, GoesOnBehindAMarkAndDropsTheRest) {
  const TemporaryFolder folder;
  const fs::path file = folder / "j";
  JournalMark kept;
  {
    JournalWriter journal(file, own_journal(file, Absent::make_it), small_header());
    kept = write_on(journal, 0, 4);
    write_on(journal, 100, 110);  // what must not come back
  }
  {
    JournalWriter journal(file, own_journal(file, Absent::leave_it), small_layout(), kept);
    write_on(journal, 4, kFew);
  }
  Compared compared;
  EXPECT_EQ(failure_of(file, compared), "");
  EXPECT_EQ(compared.rows, kFew);
  EXPECT_EQ(compared.events, kFew);
  EXPECT_EQ(compared.wrong, 0);
}

TEST(Journal, PlaysUpToAMark) {
  const TemporaryFolder folder;
  const fs::path file = folder / "j";
  JournalWriter writer(file, own_journal(file, Absent::make_it), small_header());
  const JournalMark half = write_on(writer, 0, 4);
  write_on(writer, 4, kFew);
  JournalReader journal(file);
  Compared compared;
  journal.play(compared, half.bytes);
  EXPECT_EQ(journal.mark(), half);
  EXPECT_EQ(compared.rows, 4U);
}

TEST(Journal, BelongsToOneWriter) {
  const TemporaryFolder folder;
  const fs::path file = folder / "j";
  EXPECT_FALSE(own_journal(file, Absent::leave_it).open());
  const Descriptor owned = own_journal(file, Absent::make_it);
  EXPECT_TRUE(owned.open());
  EXPECT_THROW(own_journal(file, Absent::make_it), JournalInUse);
  EXPECT_THROW(own_journal(file, Absent::leave_it), JournalInUse);
}

TEST(Journal, IsNoLink) {
  const TemporaryFolder folder;
  write(folder / "precious", "mine");
  fs::create_symlink(folder / "precious", folder / "j");
  EXPECT_THROW(own_journal(folder / "j", Absent::make_it), OutputError);
  EXPECT_EQ(content(folder / "precious"), "mine");
}

TEST(Journal, TakesNothingMoreOnceTheDiskWasFull) {
  const TemporaryFolder folder;
  const fs::path file = folder / "j";
  {
    JournalWriter journal(file, own_journal(file, Absent::make_it), small_header());
    const JournalMark good = write_on(journal, 0, kFew);
    {
      const DiskLimit limit(good.bytes + 10);
      journal.row(small_row(kFew));
      EXPECT_THROW(journal.flush(), OutputError);
    }
    EXPECT_THROW(journal.flush(), OutputError);  // there is room now, but half a record
  }
  Compared compared;
  EXPECT_NE(failure_of(file, compared), "");
  EXPECT_EQ(compared.rows, kFew);
  EXPECT_EQ(compared.wrong, 0);
}

TEST(Journal, TornAnywhereGivesTheGoodRecordsOnly) {
  const TemporaryFolder folder;
  std::uint64_t length = write_small_journal(folder / "torn", kFew).bytes;
  std::uint64_t most = 0;
  while (length-- > 0) {
    fs::resize_file(folder / "torn", length);
    Compared compared;
    const std::string why = failure_of(folder / "torn", compared);
    EXPECT_EQ(compared.wrong, 0) << length;
    EXPECT_LE(compared.rows, kFew);
    // Between two records nothing shows that more was to come; the checkpoint knows.
    if (!why.empty()) {
      EXPECT_NE(why.find("truncated"), std::string::npos) << length << ": " << why;
    }
    most = std::max(most, compared.rows + compared.events);
  }
  EXPECT_GE(most, 2 * kFew - 3);
}

TEST(Journal, EveryFlippedBitIsNoticed) {
  const TemporaryFolder folder;
  const JournalMark end = write_small_journal(folder / "changed", kFew);
  const std::string whole = content(folder / "changed");
  std::fstream file(folder / "changed", std::ios::in | std::ios::out | std::ios::binary);
  const auto put = [&file](std::size_t offset, char byte) {
    file.seekp(static_cast<std::streamoff>(offset)).put(byte).flush();
  };
  for (std::size_t k = 0; k < 8 * whole.size(); ++k) {
    put(k / 8, static_cast<char>(whole[k / 8] ^ (1 << k % 8)));
    if (k >= 8 && k % 8 == 0) put(k / 8 - 1, whole[k / 8 - 1]);
    Compared compared;
    EXPECT_NE(failure_of(folder / "changed", compared), "") << k;
    EXPECT_EQ(compared.wrong, 0) << k;
    EXPECT_LT(compared.rows + compared.events, end.rows + end.events) << k;
  }
}

/// Records stand in a chain: each is good only behind the one that it was written behind.
TEST(Journal, RecordsOfAnotherPlaceOrFileAreNoticed) {
  const TemporaryFolder folder;
  JournalMark first;
  JournalMark second;
  {
    JournalWriter journal(folder / "j", own_journal(folder / "j", Absent::make_it), small_header());
    first = journal.flush();
    journal.row(small_row(0));
    second = journal.flush();
    journal.row(small_row(0));
    journal.flush();
  }
  const std::string whole = content(folder / "j");
  const std::string head = whole.substr(0, first.bytes);
  const std::string one = whole.substr(first.bytes, second.bytes - first.bytes);
  const std::string two = whole.substr(second.bytes);
  ASSERT_EQ(one.size(), two.size());
  Compared compared;
  for (const std::string& other : {head + two, head + one + one, head + two + one}) {
    write(folder / "other", other);
    EXPECT_NE(failure_of(folder / "other", compared), "");
  }
}

TEST(Journal, OtherFilesAreRefused) {
  const TemporaryFolder folder;
  Compared compared;
  EXPECT_NE(failure_of(folder / "absent", compared), "");
  EXPECT_NE(failure_of(folder.path(), compared), "");
  write(folder / "text", std::string(1000, 'x'));
  EXPECT_NE(failure_of(folder / "text", compared).find("a record is missing"), std::string::npos);
  write(folder / "swapped", "RMOT" + std::string(1000, '\0'));
  EXPECT_NE(failure_of(folder / "swapped", compared).find("byte order"), std::string::npos);
  // A length that no memory could hold.
  write(folder / "huge",
        std::string("TOMR\1\0\0\0\xff\xff\xff\xff\xff\xff\xff\x7f", 16) + std::string(1000, '\0'));
  EXPECT_NE(failure_of(folder / "huge", compared).find("truncated"), std::string::npos);
}

}  // namespace
}  // namespace tomlin::test
