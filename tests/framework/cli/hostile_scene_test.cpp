#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "framework/scene/size_checks.hpp"
#include "tests/framework/cli/cli_fixture.hpp"

/// Scenes that ask for far too much are refused at once and cheaply: in little time and memory,
/// with the limit and with what it would take.
namespace tomlin::test {
namespace {

// A refusal takes some 30 MB, and 0.4 GB where a large file has to be read first.
constexpr long kMemory = 1L << 30;
// Most take hundredths; reading 16 MB of keys takes one. The unit is a whole second.
constexpr long kSeconds = 3;

#if defined(__has_feature)
#define TOMLIN_HAS_FEATURE(feature) __has_feature(feature)
#else
#define TOMLIN_HAS_FEATURE(feature) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || TOMLIN_HAS_FEATURE(address_sanitizer)
constexpr bool kCanBeLimited = false;  // it maps terabytes of addresses
#else
constexpr bool kCanBeLimited = true;
#endif

constexpr const char* kRun = "[run]\nduration = 0.02\nintegrator = { type = \"rk4\", dt = 1e-2 }\n";

std::string chain(const std::string& count, const std::string& name = "chain") {
  return "[[body]]\nname = \"" + name + "\"\ntype = \"chain\"\ncount = " + count +
         "\nspacing = 1\nparticle_mass = 1\n";
}

std::string bonds(const std::string& keys) {
  return "[[force]]\ntype = \"harmonic_bonds\"\nstiffness = 1e-9\n" + keys + "\n";
}

std::string repeated(const std::string& part, int times) {
  std::string text;
  for (int i = 0; i < times; ++i) text += part;
  return text;
}

class HostileScene : public Cli {
 protected:
  /// One line of error with both parts in it.
  void expect_refused_at_once(const std::string& scene, const std::string& start,
                              const std::string& limit) {
    write(folder_ / "scene.toml", scene);
    expect_file_refused_at_once("scene.toml", start, limit);
  }

  void expect_file_refused_at_once(const std::string& path, const std::string& start,
                                   const std::string& limit) {
    Conditions conditions;
    if (kCanBeLimited) conditions.most_memory = kMemory;
    if (kCanBeLimited) conditions.most_seconds = kSeconds;
    const Ended ended = tomlin({"run", path, "-o", "out"}, conditions);
    EXPECT_EQ(ended.status, 2) << ended.err.substr(0, 1000);
    EXPECT_EQ(ended.err.substr(0, path.size() + start.size()), path + start);
    EXPECT_TRUE(contains(ended.err, limit)) << ended.err.substr(0, 1000);
    EXPECT_EQ(lines(ended.err), 1);
    EXPECT_LT(ended.err.size(), 1000U);
    EXPECT_FALSE(exists("out"));
  }
};

TEST_F(HostileScene, Particles) {
  const std::string limit = "; admissible: at most 10000000 particles in a scene";
  expect_refused_at_once(chain("1e9") + kRun,
                         ":4:9: error: body.chain.count = 1e9: 1000000000 particles would take "
                         "about 420 GB",
                         limit);
  expect_refused_at_once(chain("9223372036854775807") + kRun,
                         ":4:9: error: body.chain.count = 9223372036854775807: ", limit);
  expect_refused_at_once(
      "[[body]]\ntype = \"ring\"\ncount = 1e9\nradius = 1\ncentre = [0, 0]\n"
      "particle_mass = 1\n" +
          std::string(kRun),
      ":3:9: error: body.ring.count = 1e9: 1000000000 particles would take "
      "about 580 GB",
      limit);
}

TEST_F(HostileScene, Pairs) {
  const std::string limit = "; admissible: at most 50000000 pairs in a scene";
  expect_refused_at_once(chain("1e7") + bonds("pairs = \"all\"") + kRun,
                         ":10:9: error: force.harmonic_bonds.pairs = \"all\": 49999995000000 pairs "
                         "would take about 4000000 GB",
                         limit);
  expect_refused_at_once(
      chain("5e6", "a") + chain("5e6", "b") + bonds("bodies = [\"a\", \"b\"]\npairs = \"all\"") +
          kRun,
      ":17:9: error: force.harmonic_bonds.pairs = \"all\": 25000000000000 pairs would take", limit);
  // Each of these is admissible alone.
  expect_refused_at_once(chain("8000") + bonds("name = \"one\"\npairs = \"all\"") +
                             bonds("name = \"two\"\npairs = \"all\"") + kRun,
                         ":16:9: error: force.two.pairs = \"all\": 31996000 pairs and the 31996000 "
                         "of the forces before would take about 5.1 GB",
                         limit);
}

TEST_F(HostileScene, Components) {
  expect_refused_at_once(kTip + repeated("[[body]]\n", 400'000), ":8:1: error: body: there are ",
                         "at most 10000");
  expect_refused_at_once(kTip + repeated("[[force]]\n", 400'000), ":14:1: error: force: there are ",
                         "at most 10000");
  expect_refused_at_once(kTip + repeated("[[force]]\n", 1'000'000),
                         ":500019:2: error: too many values", "at most 1000000 values");
}

TEST_F(HostileScene, Bombs) {
  std::string costly = "[parameters]\n";
  for (int i = 0; i < 9000; ++i) {
    costly += "p" + std::to_string(i) + " = \"" + repeated("1.1^", 190) + "1\"\n";
  }
  expect_refused_at_once(costly + chain("1") + kRun, ":", "at most 1048576 bytes in all");
  expect_refused_at_once("[[body]]\ntype = \"particles\"\nparticle_mass = 1\npositions = [" +
                             repeated("\"sin(exp(log(2^0.3)))\",", 200'000) + "]\n" + kRun,
                         ":4:", "at most 1048576 bytes in all");
  expect_refused_at_once("a = [" + repeated("1,", 8'000'000) + "]\n", ":1:2000003: error: too many",
                         "at most 1000000 values");
}

TEST_F(HostileScene, Files) {
  const std::string large = ":1:1: error: the file is too large; admissible: at most 16 MiB";
  const std::string sparse = (folder_ / "sparse.toml").string();
  std::ofstream(sparse).close();
  fs::resize_file(sparse, std::uintmax_t{100} << 30);
  expect_file_refused_at_once("sparse.toml", large, "");
  for (const char* device : {"/dev/zero", "/dev/null"}) {
    expect_file_refused_at_once(device, ":1:1: error: a device or a socket, where a file", "");
  }
  ASSERT_EQ(mkfifo((folder_ / "fifo").c_str(), 0600), 0);
  expect_file_refused_at_once("fifo", ":1:1: error: a pipe, where a file is expected", "");
  expect_file_refused_at_once(".", ":1:1: error: a directory, where a file is expected", "");
  for (const std::string name : {"sparse.toml", "/dev/zero", "fifo", "."}) {
    expect_refused_at_once(
        "[[body]]\ntype = \"particles\"\nparticle_mass = 1\nfile = \"" + name + "\"\n" + kRun,
        ":4:8: error: body.particles.file = ", "");
  }
}

// What messages say a scene would take it does take, as far as an address space that is a third
// too small or too large can tell.
class Memory : public HostileScene {
 protected:
  void expect_takes(const std::string& scene, double bytes) {
    if (!kCanBeLimited) GTEST_SKIP() << "the sanitizers need memory of their own";
    constexpr double kProgram = 60e6;  // the program, its libraries and stacks
    constexpr double kTooLittle = 0.67;
    constexpr double kEnough = 1.33;
    write(folder_ / "scene.toml", scene);
    Conditions conditions;
    conditions.most_memory = static_cast<long>(kProgram + kTooLittle * bytes);
    const Ended starved = tomlin({"run", "scene.toml", "-o", "out"}, conditions);
    EXPECT_EQ(starved.status, 2);
    EXPECT_EQ(starved.err, "tomlin: error: this takes more memory than there is\n");
    conditions.most_memory = static_cast<long>(kProgram + kEnough * bytes);
    const Ended fed = tomlin({"run", "scene.toml", "-o", "out", "--force"}, conditions);
    EXPECT_EQ(fed.status, 0) << fed.err;
  }
};

TEST_F(Memory, OfParticles) {
  constexpr double kCount = 500'000;
  const double each = kBytesPerParticle + kBytesPerCoordinate;
  expect_takes(chain("500000") + kRun, kCount * each);
}

TEST_F(Memory, OfParticlesInThePlane) {
  constexpr double kCount = 500'000;
  const double each = kBytesPerParticle + 2.0 * kBytesPerCoordinate;
  expect_takes(chain("500000") + "origin = [0.0, 0.0]\n" + kRun, kCount * each);
}

// Just below a power of two: lists of pairs grow by doubling, and beyond one reserve twice as much.
TEST_F(Memory, OfPairs) {
  constexpr double kCount = 2800.0 * 2799.0 / 2.0;
  expect_takes(chain("2800") + bonds("pairs = \"all\"") + kRun, kCount * kBytesPerPair);
}

}  // namespace
}  // namespace tomlin::test
