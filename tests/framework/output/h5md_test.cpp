#include "framework/output/h5md.hpp"

#include <chrono>
#include <csignal>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/framework/output/disk_limit.hpp"
#include "tests/framework/output/temporary_folder.hpp"
#include "tests/framework/output/trajectory_fixture.hpp"

// Written here and read back by the HDF5 library; h5md_check.py reads the same by the rules of
// H5MD.

namespace tomlin::test {
namespace {

namespace fs = std::filesystem;

Hdf5Handle opened(const fs::path& file) {
  const Hdf5Silence silence;
  return Hdf5Handle(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
}

template <class Number>
struct Read {
  std::vector<hsize_t> shape;
  std::vector<hsize_t> chunk;
  bool double_precision = false;
  std::vector<Number> values;
};

template <class Number>
Read<Number> read(const Hdf5Handle& file, const char* path) {
  Read<Number> result;
  const Hdf5Handle dataset(H5Dopen2(file, path, H5P_DEFAULT));
  EXPECT_GE(dataset, 0) << path;
  if (dataset < 0) return result;
  const Hdf5Handle space(H5Dget_space(dataset));
  result.shape.resize(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
  H5Sget_simple_extent_dims(space, result.shape.data(), nullptr);
  const Hdf5Handle type(H5Dget_type(dataset));
  result.double_precision = H5Tequal(type, H5T_IEEE_F64LE) > 0;
  const Hdf5Handle properties(H5Dget_create_plist(dataset));
  if (H5Pget_layout(properties) == H5D_CHUNKED) {
    result.chunk.resize(result.shape.size());
    H5Pget_chunk(properties, static_cast<int>(result.chunk.size()), result.chunk.data());
  }
  result.values.resize(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  const bool real = std::is_same_v<Number, double>;
  H5Dread(dataset, real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT,
          result.values.data());
  return result;
}

void write_file(const fs::path& file, const RunLayout& layout, std::size_t frames) {
  H5mdWriter writer(file, layout, some_facts());
  write_frames(writer, layout, frames);
  writer.finish();
}

constexpr const char* kValue = "/particles/all/position/value";
constexpr const char* kTime = "/particles/all/position/time";
constexpr const char* kStep = "/particles/all/position/step";

void expect_frames(const Hdf5Handle& file, const RunLayout& layout, std::size_t frames) {
  const auto value = read<double>(file, kValue);
  EXPECT_EQ(value.shape, (std::vector<hsize_t>{frames, layout.particles(), 3}));
  EXPECT_TRUE(value.double_precision);
  const auto axes = static_cast<std::size_t>(layout.dimension);
  std::size_t k = 0;
  std::size_t wrong = 0;
  for (std::size_t f = 0; f < frames; ++f) {
    for (std::size_t i = 0; i < layout.particles(); ++i) {
      for (std::size_t d = 0; d < 3; ++d) {
        wrong += value.values[k++] != (d < axes ? position_of(f, i * axes + d) : 0.0);
      }
    }
  }
  EXPECT_EQ(wrong, 0u);
  const auto time = read<double>(file, kTime);
  const auto step = read<std::int64_t>(file, kStep);
  EXPECT_TRUE(time.double_precision);
  ASSERT_EQ(time.values.size(), frames);
  ASSERT_EQ(step.values.size(), frames);
  for (std::size_t f = 0; f < frames; ++f) {
    EXPECT_EQ(time.values[f], time_of(f));
    EXPECT_EQ(step.values[f], static_cast<std::int64_t>(f));
  }
}

TEST(H5md, ReadsBackAsTheSameBits) {
  const TemporaryFolder folder;
  write_file(folder / "t.h5", two_bodies(), 5);
  const Hdf5Handle file = opened(folder / "t.h5");
  expect_frames(file, two_bodies(), 5);
  EXPECT_EQ(read<double>(file, "/particles/all/mass").values,
            (std::vector<double>{0.25, 0.5, 0.125, 2.0}));
  EXPECT_EQ(read<std::int64_t>(file, "/particles/all/species").values,
            (std::vector<std::int64_t>{0, 0, 0, 1}));
  EXPECT_EQ(read<std::int64_t>(file, "/particles/all/id").values,
            (std::vector<std::int64_t>{0, 1, 2, 3}));
  const auto edges = read<double>(file, "/particles/all/box/edges/value");
  EXPECT_EQ(edges.shape, (std::vector<hsize_t>{5, 3}));
  for (std::size_t k = 0; k < edges.values.size(); ++k) {
    EXPECT_EQ(edges.values[k], k % 3 == 0 ? 7.5 : 0.0) << k;
  }
}

TEST(H5md, HasTheSpeciesOfParticles) {
  const TemporaryFolder folder;
  write_file(folder / "t.h5", with_species(), 2);
  const Hdf5Handle file = opened(folder / "t.h5");
  EXPECT_EQ(read<std::int64_t>(file, "/particles/all/species").values,
            (std::vector<std::int64_t>{1, 0, 0, 2}));
  EXPECT_EQ(read<std::int64_t>(file, "/particles/all/body").values,
            (std::vector<std::int64_t>{0, 0, 0, 1}));
  EXPECT_GE(H5Lexists(file, "/parameters/species", H5P_DEFAULT), 1);
}

/// Chunks end within the run, at its end, and within a frame.
TEST(H5md, KeepsEveryFrameOfAnyShape) {
  struct Shape {
    std::size_t particles;
    std::size_t frames;
  };
  for (const auto& [particles, frames] :
       {Shape{1, 0}, Shape{1, 1}, Shape{1, 43690}, Shape{1, 140001}, Shape{1000, 43},
        Shape{1000, 101}, Shape{43691, 3}, Shape{100000, 2}}) {
    SCOPED_TRACE(std::to_string(particles) + " particles, " + std::to_string(frames) + " frames");
    const TemporaryFolder folder;
    write_file(folder / "t.h5", line_of(particles), frames);
    expect_frames(opened(folder / "t.h5"), line_of(particles), frames);
  }
}

/// Neither a million pieces nor a megabyte for three numbers.
TEST(H5md, IsCutIntoPiecesThatSuitItsShape) {
  constexpr hsize_t kMegabyte = hsize_t{1} << 20U;
  const TemporaryFolder folder;
  const auto chunk_of = [&](std::size_t particles, std::size_t frames) {
    fs::remove(folder / "t.h5");
    write_file(folder / "t.h5", line_of(particles), frames);
    return read<double>(opened(folder / "t.h5"), kValue).chunk;
  };
  EXPECT_EQ(chunk_of(3, 4), (std::vector<hsize_t>{4, 3, 3}));
  EXPECT_LT(fs::file_size(folder / "t.h5"), 20'000u);
  for (const auto& [particles, frames] :
       {std::pair<std::size_t, std::size_t>{1, 200000}, {1000, 200}, {100000, 3}}) {
    const std::vector<hsize_t> chunk = chunk_of(particles, frames);
    const hsize_t bytes = 8 * chunk[0] * chunk[1] * chunk[2];
    EXPECT_LE(bytes, kMegabyte);
    EXPECT_GT(bytes, kMegabyte / 2);
    // Positions, step and time, and what may be left over in the last piece of each.
    EXPECT_LT(fs::file_size(folder / "t.h5"), (24 * particles + 16) * frames + 3 * kMegabyte);
  }
}

TEST(H5md, TheSameRowsGiveTheSameBytes) {
  const TemporaryFolder folder;
  write_file(folder / "a.h5", two_bodies(), 100);
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // clocks of files count seconds
  write_file(folder / "b.h5", two_bodies(), 100);
  EXPECT_TRUE(content(folder / "a.h5") == content(folder / "b.h5"));
}

TEST(H5md, RefusesRowsThatAreNotRight) {
  const TemporaryFolder folder;
  H5mdWriter writer(folder / "t.h5", two_bodies(), some_facts());
  write_frames(writer, two_bodies(), 1);
  std::vector<double> row = row_of(two_bodies(), 1);
  row.back() = std::numeric_limits<double>::quiet_NaN();
  const std::string message = output_error([&] { writer.frame(row); });
  EXPECT_NE(message.find("sample 1: the position of particle 3"), std::string::npos) << message;
  row.pop_back();
  EXPECT_THROW(writer.frame(row), OutputError);
  writer.finish();
  expect_frames(opened(folder / "t.h5"), two_bodies(), 1);
}

TEST(H5md, HasItsNameOnlyWhenItIsComplete) {
  const TemporaryFolder folder;
  {
    H5mdWriter writer(folder / "t.h5", two_bodies(), some_facts());
    write_frames(writer, two_bodies(), 60000);
    EXPECT_FALSE(fs::exists(folder / "t.h5"));
    EXPECT_TRUE(fs::exists(folder / "t.h5.part"));
    EXPECT_THROW(H5mdWriter(folder / "t.h5", two_bodies(), some_facts()), OutputError);
  }
  EXPECT_FALSE(fs::exists(folder / "t.h5"));
  EXPECT_LT(opened(folder / "t.h5.part"), 0) << "an unfinished file opens";
}

/// Killed while it writes: what is left has no name that readers look for, and does not open.
TEST(H5md, AKilledWriterLeavesNothingThatLooksComplete) {
  for (const std::size_t frames : {1u, 50000u, 150000u}) {
    const TemporaryFolder folder;
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      H5mdWriter writer(folder / "t.h5", line_of(1), some_facts());
      write_frames(writer, line_of(1), frames);
      ::raise(SIGKILL);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
    EXPECT_FALSE(fs::exists(folder / "t.h5"));
    EXPECT_TRUE(fs::exists(folder / "t.h5.part"));
    EXPECT_LT(opened(folder / "t.h5.part"), 0) << frames << " frames";
  }
}

std::string trouble_of(const fs::path& file, std::size_t limit, std::size_t frames) {
  const DiskLimit full(limit);
  return output_error([&] {
    H5mdWriter writer(file, line_of(10), some_facts());
    write_frames(writer, line_of(10), frames);
    writer.finish();
  });
}

/// At any moment: when it is opened, between chunks, when it is closed.
TEST(H5md, ReportsAFullDiskWhereverItFillsUp) {
  for (const std::size_t limit : {0u, 100u, 3000u, 1048576u, 2000000u, 7000000u, 9600000u}) {
    SCOPED_TRACE(limit);
    const TemporaryFolder folder;
    const std::string message = trouble_of(folder / "t.h5", limit, 40000);
    EXPECT_NE(message.find((folder / "t.h5.part").string()), std::string::npos) << message;
    EXPECT_NE(message.find("File too large"), std::string::npos) << message;
    EXPECT_FALSE(fs::exists(folder / "t.h5"));
  }
  // Whatever went wrong before, the library is in order, and the next file is whole.
  const TemporaryFolder folder;
  EXPECT_EQ(trouble_of(folder / "t.h5", 20'000'000, 40000), "");
  expect_frames(opened(folder / "t.h5"), line_of(10), 40000);
  EXPECT_EQ(H5Fget_obj_count(H5F_OBJ_ALL, H5F_OBJ_ALL), 0);
}

TEST(H5md, ReportsAFolderThatHasGone) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "run");
  H5mdWriter writer(folder.path() / "run" / "t.h5", two_bodies(), some_facts());
  fs::remove_all(folder / "run");
  EXPECT_THROW(writer.finish(), OutputError);
  EXPECT_THROW(H5mdWriter(folder.path() / "run" / "t.h5", two_bodies(), some_facts()), OutputError);
}

TEST(H5md, TheLibrarysOwnComplaintsAreTranslated) {
  const TemporaryFolder folder;
  const Hdf5File file(folder / "t.h5");
  const Hdf5Silence silence;
  const std::string message =
      output_error([&] { file.check(H5Gopen2(file.root(), "not there", H5P_DEFAULT)); });
  EXPECT_NE(message.find("t.h5.part: HDF5: "), std::string::npos) << message;
  EXPECT_NE(message.find("not there"), std::string::npos) << message;
}

}  // namespace
}  // namespace tomlin::test
