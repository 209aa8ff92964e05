#include "framework/output/run_folder.hpp"

#include <optional>
#include <string>

#include <gtest/gtest.h>
#include <sys/types.h>
#include <unistd.h>

#include "tests/framework/output/disk_limit.hpp"
#include "tests/framework/output/temporary_folder.hpp"
#include "tests/support/faults.hpp"

namespace tomlin::test {
namespace {

namespace fs = std::filesystem;

/// The fault of the folder, if it has one.
std::optional<Fault> fault_of(const fs::path& path, Occupied occupied = Occupied::refuse) {
  try {
    RunFolder folder(path, occupied);
    folder.create();
  } catch (const InputError& error) {
    EXPECT_EQ(error.faults().size(), 1U);
    EXPECT_EQ(error.faults()[0].location.file, "-o");
    return error.faults()[0];
  }
  return std::nullopt;
}

/// In brief; empty when the folder is not refused.
std::string refusal(const fs::path& path, Occupied occupied = Occupied::refuse) {
  const auto fault = fault_of(path, occupied);
  return fault ? brief(*fault) : "";
}

/// Whether the message has the option among what is admissible.
bool suggests(const fs::path& path, const std::string& option) {
  return fault_of(path).value().admissible.find(option) != std::string::npos;
}

TEST(RunFolder, IsMadeWithAllAboveIt) {
  const TemporaryFolder temporary;
  RunFolder folder(temporary.path() / "a" / "b" / "", Occupied::refuse);
  EXPECT_TRUE(fs::is_empty(temporary.path()));  // looking makes nothing
  folder.create();
  folder.write_file("summary.json", "{}");
  EXPECT_EQ(content(temporary.path() / "a" / "b" / "summary.json"), "{}");
}

TEST(RunFolder, DisappearsWhenNothingWasWritten) {
  const TemporaryFolder temporary;
  {
    RunFolder folder(temporary.path() / "a" / "b", Occupied::refuse);
    folder.create();
    EXPECT_TRUE(fs::is_directory(temporary.path() / "a" / "b"));
  }
  EXPECT_TRUE(fs::is_empty(temporary.path()));
}

TEST(RunFolder, StaysWhenItWasThereBefore) {
  const TemporaryFolder temporary;
  EXPECT_EQ(refusal(temporary.path()), "");
  EXPECT_TRUE(fs::is_directory(temporary.path()));
}

TEST(RunFolder, MustBeEmpty) {
  const TemporaryFolder temporary;
  write(temporary / ".hidden", "");
  EXPECT_EQ(refusal(temporary.path()), temporary.path().string() + " [file.exists]");
  EXPECT_TRUE(suggests(temporary.path(), "--force"));
  EXPECT_FALSE(suggests(temporary.path(), "--resume"));
}

TEST(RunFolder, OfARunThatWasStoppedSaysHowToGoOn) {
  for (const char* name : {"run.journal", "run.checkpoint"}) {
    const TemporaryFolder temporary;
    write(temporary / name, "x");
    EXPECT_EQ(refusal(temporary.path()), temporary.path().string() + " [file.exists]") << name;
    EXPECT_TRUE(suggests(temporary.path(), "--resume")) << name;
  }
}

TEST(RunFolder, ToGoOnInHoldsARunOrNothing) {
  const TemporaryFolder temporary;
  EXPECT_EQ(refusal(temporary.path(), Occupied::go_on), "");
  write(temporary / "notes.txt", "mine");
  EXPECT_EQ(refusal(temporary.path(), Occupied::go_on),
            temporary.path().string() + " [file.exists]");
  write(temporary / "scene.toml.part", "");
  EXPECT_EQ(refusal(temporary.path(), Occupied::go_on), "");
}

TEST(RunFolder, ForceReplacesWhatARunLeftAndNothingElse) {
  const TemporaryFolder temporary;
  for (const char* name : {"summary.json", "observables.csv", "scene.toml", "scene.toml.part"}) {
    write(temporary / name, "earlier");
  }
  write(temporary / "notes.txt", "mine");
  {
    RunFolder folder(temporary.path(), Occupied::replace_results);
    EXPECT_EQ(content(temporary / "scene.toml.part"), "earlier");
    folder.create();
    EXPECT_EQ(content(temporary / "summary.json"), "earlier");  // until there is something better
    folder.remove_results();
    folder.write_file(kSceneFile, "new");
  }
  EXPECT_EQ(content(temporary / "scene.toml"), "new");
  EXPECT_EQ(content(temporary / "notes.txt"), "mine");
  EXPECT_FALSE(fs::exists(temporary / "summary.json"));
  EXPECT_FALSE(fs::exists(temporary / "observables.csv"));
  EXPECT_FALSE(fs::exists(temporary / "scene.toml.part"));
}

TEST(RunFolder, ForceReplacesALinkAndNotWhereItLeads) {
  const TemporaryFolder temporary;
  fs::create_directory(temporary / "run");
  write(temporary / "precious", "mine");
  fs::create_symlink(temporary / "precious", temporary.path() / "run" / "summary.json");
  RunFolder folder(temporary / "run", Occupied::replace_results);
  folder.create();
  folder.remove_results();
  folder.write_file(kSummaryFile, "{}");
  EXPECT_EQ(content(temporary / "precious"), "mine");
  EXPECT_EQ(content(temporary.path() / "run" / "summary.json"), "{}");
}

TEST(RunFolder, RefusesWhatIsNoFolder) {
  const TemporaryFolder temporary;
  write(temporary / "file", "");
  fs::create_symlink("nowhere", temporary / "link");
  fs::create_directories(temporary.path() / "run" / "summary.json");
  const std::string here = temporary.path().string() + "/";
  EXPECT_EQ(refusal(""), "\"\" [command.invalid_value]");
  EXPECT_EQ(refusal(here + "file"), here + "file [file.invalid]");
  for (const std::string& name :
       {std::string("file/run"), std::string("link"), std::string(300, 'x')}) {
    EXPECT_EQ(refusal(here + name), here + name + " [file.cannot_write]");
  }
  EXPECT_EQ(refusal(here + "run", Occupied::replace_results),
            here + "run/summary.json [file.cannot_write]");
}

TEST(RunFolder, RefusesWhereNothingCanBeMade) {
  if (!fs::is_directory("/proc/self")) GTEST_SKIP() << "there is no /proc here";
  EXPECT_EQ(refusal("/proc/tomlin.out"), "/proc/tomlin.out [file.cannot_write]");
}

TEST(RunFolder, RefusesAFolderThatMayNotBeWritten) {
  const TemporaryFolder temporary;
  fs::permissions(temporary.path(), fs::perms::owner_read | fs::perms::owner_exec);
  // Root may write everywhere, so it becomes somebody else for a moment.
  constexpr uid_t kNobody = 65534;
  const bool root = ::geteuid() == 0;
  if (root && (::chown(temporary.path().c_str(), kNobody, static_cast<gid_t>(-1)) != 0 ||
               ::seteuid(kNobody) != 0)) {
    GTEST_SKIP() << "root may write everywhere, and cannot become somebody else here";
  }
  const std::string inside = refusal(temporary.path());
  const std::string below = refusal(temporary / "run");
  if (root) {
    ASSERT_EQ(::seteuid(0), 0);
  }
  EXPECT_EQ(inside, temporary.path().string() + " [file.cannot_write]");
  EXPECT_EQ(below, (temporary / "run").string() + " [file.cannot_write]");
}

TEST(RunFolder, AFileAppearsWholeOrNotAtAll) {
  const TemporaryFolder temporary;
  RunFolder folder(temporary.path(), Occupied::refuse);
  folder.create();
  folder.write_file(kSummaryFile, "first");
  const DiskLimit limit(1000);
  EXPECT_THROW(folder.write_file(kSummaryFile, std::string(2000, 'x')), OutputError);
  EXPECT_EQ(content(temporary / "summary.json"), "first");
}

TEST(RunFolder, HasOneOwner) {
  const TemporaryFolder temporary;
  RunFolder first(temporary / "run", Occupied::refuse);
  RunFolder second(temporary / "run", Occupied::refuse);
  first.own();
  EXPECT_TRUE(first.in_place());
  RunFolder forced(temporary / "run", Occupied::replace_results);
  for (RunFolder* other : {&second, &forced}) {
    EXPECT_EQ(briefs_of([&] { other->own(); }),
              std::vector<std::string>{(temporary / "run").string() + " [folder.in_use]"});
  }
}

/// A run that came and went between the look at the folder and its being owned is not replaced.
TEST(RunFolder, IsLookedAtAgainOnceItIsOwned) {
  for (const Occupied occupied : {Occupied::refuse, Occupied::go_on, Occupied::replace_results}) {
    const TemporaryFolder temporary;
    RunFolder folder(temporary / "run", occupied);
    fs::create_directory(temporary / "run");
    write(temporary.path() / "run" / "summary.json", "{}");
    if (occupied == Occupied::replace_results) {
      EXPECT_NO_THROW(folder.own());
      continue;
    }
    EXPECT_THROW(folder.own(), InputError);
    EXPECT_EQ(content(temporary.path() / "run" / "summary.json"), "{}");
  }
}

TEST(RunFolder, AnEmptyJournalIsInNobodysWay) {
  const TemporaryFolder temporary;
  {
    RunFolder folder(temporary / "run", Occupied::refuse);
    folder.own();
    EXPECT_TRUE(fs::exists(temporary.path() / "run" / kJournalFile));
  }
  EXPECT_TRUE(fs::is_empty(temporary.path()));  // nothing came of it
  // A program that is killed before it had anything to keep leaves an empty journal.
  fs::create_directory(temporary / "run");
  write(temporary.path() / "run" / kJournalFile, "");
  EXPECT_EQ(refusal(temporary / "run"), "");
  write(temporary.path() / "run" / kJournalFile, "x");
  EXPECT_TRUE(suggests(temporary / "run", "--resume"));
}

TEST(RunFolder, NoticesThatItWasMovedAway) {
  const TemporaryFolder temporary;
  RunFolder folder(temporary / "run", Occupied::refuse);
  folder.own();
  fs::rename(temporary / "run", temporary / "away");
  EXPECT_FALSE(folder.in_place());
  fs::create_directory(temporary / "run");
  write(temporary.path() / "run" / kJournalFile, "");
  EXPECT_FALSE(folder.in_place());
  EXPECT_TRUE(fs::exists(temporary.path() / "run" / kJournalFile));
}

// ---- files that are not complete yet

TEST(OutputFile, TakesThePlaceOfOneThatWasLeft) {
  const TemporaryFolder temporary;
  write(temporary / "a.part", "left by a program that was killed");
  OutputFile file(temporary / "a");
  file.append("new");
  file.publish();
  EXPECT_EQ(content(temporary / "a"), "new");
  EXPECT_FALSE(fs::exists(temporary / "a.part"));
  write(temporary / "precious", "mine");
  fs::create_symlink(temporary / "precious", temporary / "a.part");
  OutputFile again(temporary / "a");
  again.append("newer");
  again.publish();
  EXPECT_EQ(content(temporary / "a"), "newer");
  EXPECT_EQ(content(temporary / "precious"), "mine");
}

TEST(OutputFile, IsWrittenByOneAtATime) {
  const TemporaryFolder temporary;
  OutputFile first(temporary / "a");
  first.append("first");
  EXPECT_THROW(OutputFile(temporary / "a"), OutputError);
  EXPECT_TRUE(fs::exists(temporary / "a.part"));
  first.publish();
  EXPECT_EQ(content(temporary / "a"), "first");
}

/// In a folder that was moved away and made anew.
TEST(OutputFile, TouchesNoOtherFileOfItsName) {
  const TemporaryFolder temporary;
  fs::create_directory(temporary / "run");
  {
    OutputFile mine(temporary.path() / "run" / "a");
    OutputFile other(temporary.path() / "run" / "b");
    fs::rename(temporary / "run", temporary / "away");
    fs::create_directory(temporary / "run");
    for (const char* name : {"a.part", "b.part"}) write(temporary.path() / "run" / name, "theirs");
    EXPECT_THROW(mine.publish(), OutputError);
  }
  EXPECT_FALSE(fs::exists(temporary.path() / "run" / "a"));
  EXPECT_EQ(content(temporary.path() / "run" / "a.part"), "theirs");
  EXPECT_EQ(content(temporary.path() / "run" / "b.part"), "theirs");
}

}  // namespace
}  // namespace tomlin::test
