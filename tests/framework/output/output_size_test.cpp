#include "framework/output/output_size.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "framework/output/event_table.hpp"
#include "framework/output/run_recorder.hpp"
#include "framework/output/table.hpp"
#include "tests/framework/output/journal_fixture.hpp"
#include "tests/framework/output/temporary_folder.hpp"
#include "tests/framework/output/trajectory_fixture.hpp"
#include "tests/support/faults.hpp"
#include "tests/support/results.hpp"

namespace tomlin::test {
namespace {

namespace fs = std::filesystem;

/// No number has a longer text, so that every byte of a table is known.
constexpr double kLongest = -1.2345678901234567e-308;

Scene scene_with(std::optional<TrajectoryFormat> format) {
  Scene scene;
  scene.name = "a \"test\"";
  scene.effective_toml = "[run]\nduration = 1.0\n";
  scene.run.duration = 100.0;
  scene.output.every = 1.0;
  scene.output.trajectory = format.has_value();
  if (format) scene.output.trajectory_format = *format;
  scene.output.locations["every"] = {"scene.toml", 7, 9};
  return scene;
}

RunLayout with_samples(RunLayout layout, std::size_t samples) {
  layout.most_samples = static_cast<double>(samples);
  return layout;
}

double size_of(const fs::path& file) { return static_cast<double>(fs::file_size(file)); }

TEST(OutputSize, ATableIsAsLongAsItsLongestNumbers) {
  const TemporaryFolder folder;
  const RunLayout layout = with_samples(two_bodies(), 1000);
  TableWriter table(folder / kTableFile);
  table.begin(layout);
  for (int k = 0; k < 1000; ++k) table.sample(std::vector<double>(layout.row(), kLongest));
  table.finish();
  const double most = output_size(scene_with(std::nullopt), layout).table;
  EXPECT_LE(size_of(folder / kTableFile), most);
  // But for the line of names.
  EXPECT_GE(size_of(folder / kTableFile), 0.999 * most);
}

/// Frames of a few bytes and of more than a chunk, few and many.
TEST(OutputSize, ATrajectoryIsNotLarger) {
  for (const TrajectoryFormat format : {TrajectoryFormat::xyz, TrajectoryFormat::h5md}) {
    const Scene scene = scene_with(format);
    for (const auto& [bodies, frames] :
         {std::pair(two_bodies(), 1), std::pair(two_bodies(), 20'000), std::pair(line_of(3), 7),
          std::pair(line_of(60'000), 3), std::pair(line_of(1000), 300)}) {
      const TemporaryFolder folder;
      const RunLayout layout = with_samples(bodies, static_cast<std::size_t>(frames));
      const auto writer =
          trajectory_writer(format, folder / "t", layout, trajectory_facts(scene, ""));
      std::vector<double> row(layout.row(), kLongest);
      for (int k = 0; k < frames; ++k) writer->frame(row);
      writer->finish();
      const double most = output_size(scene, layout).trajectory;
      const double found = size_of(folder / "t");
      EXPECT_LE(found, most) << to_string(format) << " " << layout.particles() << " " << frames;
      // Each of the four series of HDF5 may end in a chunk of a megabyte that is nearly empty; its
      // structure is some kilobytes.
      const double slack = format == TrajectoryFormat::xyz ? 0.0 : 4.3e6;
      EXPECT_GE(found, most - slack)
          << to_string(format) << " " << layout.particles() << " " << frames;
    }
  }
}

TEST(OutputSize, AJournalIsNotLarger) {
  for (const RunLayout& bodies : {two_bodies(), line_of(20'000)}) {
    const TemporaryFolder folder;
    const RunLayout layout = with_samples(bodies, 400);
    JournalHeader header{"1.2.3", "a scene", layout};
    JournalWriter journal(folder / kJournalFile,
                          own_journal(folder / kJournalFile, Absent::make_it), header);
    const auto empty = static_cast<double>(journal.flush().bytes);
    for (int k = 0; k < 400; ++k) journal.row(std::vector<double>(layout.row(), kLongest));
    const double found = static_cast<double>(journal.flush().bytes) - empty;
    const double most = output_size(scene_with(TrajectoryFormat::h5md), layout).journal;
    EXPECT_LE(found, most + 32.0) << "the last record is not full";
    EXPECT_GE(found, 0.99 * most);
  }
}

std::optional<Fault> refusal(const Scene& scene, const OutputSize& size, double room) {
  return first_fault([&] { require_room(scene, size, room); });
}

OutputSize size_at(Scene& scene, double every) {
  scene.output.every = every;
  RunLayout layout = two_bodies();
  layout.most_samples = std::floor(scene.run.duration / every + 1e-9) + 1.0;
  layout.state_bytes = 1000;
  return output_size(scene, layout);
}

TEST(OutputSize, WhatDoesNotFitIsRefusedWithWhatWould) {
  Scene scene = scene_with(TrajectoryFormat::xyz);
  const OutputSize size = size_at(scene, 1e-3);
  EXPECT_FALSE(refusal(scene, size, size.together()));
  const auto fault = refusal(scene, size, 1e6);
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->location.file, "scene.toml");
  EXPECT_EQ(brief(*fault), "7:9 output.every = 0.001 [output.too_large]");
  for (const char* part : {"100001", "5 MB of observables.csv", "MB of trajectory.xyz",
                           "MB of run.journal", " 1 MB"}) {
    EXPECT_NE(fault->why.find(part), std::string::npos) << part << "\n" << fault->why;
  }
  EXPECT_TRUE(fault->admissible.starts_with(">= ")) << fault->admissible;
  for (const double room : {1e5, 1e6, 1.234e7, 5e7}) {
    scene.output.every = 1e-3;
    const double every = shortest_every(scene, size, room);
    EXPECT_LE(size_at(scene, every).together(), room) << every;
    // Rounded to three digits, and a hundredth left.
    EXPECT_GT(size_at(scene, 0.975 * every).together(), room) << every;
  }
  EXPECT_FALSE(refusal(scene, size, 10.0).value().admissible.starts_with(">= "));
}

TEST(OutputSize, MoreRowsThanAnyoneReadsAreRefusedHoweverMuchRoomThereIs) {
  Scene scene = scene_with(std::nullopt);
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(refusal(scene, size_at(scene, 1.1e-7), infinite));
  const auto fault = refusal(scene, size_at(scene, 0.9e-7), infinite);
  ASSERT_TRUE(fault);
  EXPECT_EQ(brief(*fault), "7:9 output.every = 9e-08 [output.too_large]");
  EXPECT_TRUE(fault->admissible.starts_with(">= 1.01e-07")) << fault->admissible;
  EXPECT_NE(fault->admissible.find("1e+09"), std::string::npos) << fault->admissible;
}

TEST(OutputSize, CheckpointsAloneNeedRoomToo) {
  Scene scene = scene_with(std::nullopt);
  scene.output = OutputSettings();
  scene.run.location = {"scene.toml", 3, 1};
  RunLayout layout;
  layout.state_bytes = 1'000'000;
  const OutputSize size = output_size(scene, layout);
  EXPECT_FALSE(refusal(scene, size, 3e6));
  EXPECT_EQ(brief(refusal(scene, size, 1.5e6).value()), "3:1 run [output.too_large]");
  // Checkpoints of perturbed starts stay until the run has ended.
  scene.run.perturb.emplace();
  scene.run.perturb->repeats = 9;
  EXPECT_NEAR(output_size(scene, layout).together(), 10.0 * size.together(), 1.0);
  EXPECT_TRUE(refusal(scene, output_size(scene, layout), 15e6));
}

/// A run that goes on, or that replaces another, has what stands there already.
TEST(OutputSize, WhatTheRunHasWrittenIsRoomForIt) {
  constexpr std::size_t kWritten = 50'000'000;
  // Other programs may write this much meanwhile.
  constexpr double kOthers = 20e6;
  const TemporaryFolder folder;
  EXPECT_NEAR(room_in(folder / "not" / "there"), room_in(folder.path()), kOthers);
  write(folder / kJournalFile, std::string(kWritten, 'x'));
  write(folder / "other", std::string(1000, 'x'));
  const auto free = static_cast<double>(fs::space(folder.path()).available);
  EXPECT_NEAR(room_in(folder.path()), free + static_cast<double>(kWritten), kOthers);
}

// ---- events

/// A run of so many events, of which three are kept.
nlohmann::json summary_of(const TemporaryFolder& temporary, std::uint64_t events) {
  Scene scene;
  scene.effective_toml = small_header().scene;
  RunFolder folder(temporary.path(), Occupied::replace_results);
  Resumption resumption = start_again(folder);
  folder.own(resumption.journal);
  RunRecorder recorder(
      folder, scene, "1.2.3", std::move(resumption), [] {}, 3);
  recorder.begin(small_layout());
  for (std::uint64_t k = 0; k < events; ++k) recorder.event(small_event(k));
  RunResult result;
  result.groups = {
      group_of("events", "", 1, {{"slips", {static_cast<double>(events - 1)}}, {"turns", {1.0}}})};
  EXPECT_EQ(recorder.finish(result), std::nullopt);
  return nlohmann::json::parse(content(temporary / kSummaryFile));
}

TEST(OutputSize, EventsBeyondTheLimitAreCountedAndNotKept) {
  const TemporaryFolder folder;
  const auto rows = [&] {
    const std::string text = content(folder / kEventsFile);
    return std::count(text.begin(), text.end(), '\n') - 1;
  };
  EXPECT_EQ(summary_of(folder, 3)["warning_codes"].size(), 0U);
  EXPECT_EQ(rows(), 3);
  const auto summary = summary_of(folder, 5);
  EXPECT_EQ(rows(), 3);
  EXPECT_EQ(summary["events"]["slips"], 4);
  EXPECT_EQ(summary["warnings"].size(), 1U);
  EXPECT_EQ(summary["warning_codes"], nlohmann::json({"output.events_dropped"}));
}

}  // namespace
}  // namespace tomlin::test
