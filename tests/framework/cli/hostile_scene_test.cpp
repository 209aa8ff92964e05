#include <fstream>
#include <string>
#include <vector>

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
  /// One short line of error that begins like this, abridged, and has the parts in it.
  void expect_refused_at_once(const std::string& scene, const std::string& start,
                              const std::vector<std::string>& parts) {
    write(folder_ / "scene.toml", scene);
    expect_file_refused_at_once("scene.toml", start, parts);
  }

  void expect_file_refused_at_once(const std::string& path, const std::string& start,
                                   const std::vector<std::string>& parts) {
    Conditions conditions;
    if (kCanBeLimited) conditions.most_memory = kMemory;
    if (kCanBeLimited) conditions.most_seconds = kSeconds;
    const Ended ended = tomlin({"run", path, "-o", "out"}, conditions);
    EXPECT_EQ(ended.status, 2) << ended.err.substr(0, 1000);
    EXPECT_EQ(lines(ended.err), 1);
    ASSERT_LT(ended.err.size(), 1000U);
    EXPECT_EQ(abridged(ended.err).substr(0, path.size() + start.size()), path + start);
    expect_parts(ended.err, parts);
    EXPECT_FALSE(exists("out"));
  }
};

constexpr const char* kTooLarge = " [scene.too_large]\n";

TEST_F(HostileScene, Particles) {
  const std::string limit = " 10000000 particles";
  expect_refused_at_once(chain("1e9") + kRun,
                         std::string(":4:9: body.chain.count = 1e9") + kTooLarge,
                         {" 1000000000 ", " 420 GB", limit});
  expect_refused_at_once(chain("9223372036854775807") + kRun,
                         std::string(":4:9: body.chain.count = 9223372036854775807") + kTooLarge,
                         {limit});
  expect_refused_at_once(
      "[[body]]\ntype = \"ring\"\ncount = 1e9\nradius = 1\ncentre = [0, 0]\n"
      "particle_mass = 1\n" +
          std::string(kRun),
      std::string(":3:9: body.ring.count = 1e9") + kTooLarge, {" 1000000000 ", " 580 GB", limit});
}

TEST_F(HostileScene, Pairs) {
  const std::string limit = " 50000000 pairs";
  const std::string all = std::string(".pairs = \"all\"") + kTooLarge;
  expect_refused_at_once(chain("1e7") + bonds("pairs = \"all\"") + kRun,
                         ":10:9: force.harmonic_bonds" + all,
                         {" 49999995000000 ", " 4000000 GB", limit});
  expect_refused_at_once(chain("5e6", "a") + chain("5e6", "b") +
                             bonds("bodies = [\"a\", \"b\"]\npairs = \"all\"") + kRun,
                         ":17:9: force.harmonic_bonds" + all, {" 25000000000000 ", limit});
  // Each of these is admissible alone.
  expect_refused_at_once(chain("8000") + bonds("name = \"one\"\npairs = \"all\"") +
                             bonds("name = \"two\"\npairs = \"all\"") + kRun,
                         ":16:9: force.two" + all,
                         {" 31996000 pairs", " the 31996000 ", " 5.1 GB", limit});
}

TEST_F(HostileScene, Components) {
  expect_refused_at_once(kTip + repeated("[[body]]\n", 400'000),
                         std::string(":8:1: body") + kTooLarge, {" 10000 "});
  expect_refused_at_once(kTip + repeated("[[force]]\n", 400'000),
                         std::string(":14:1: force") + kTooLarge, {" 10000 "});
}

TEST_F(HostileScene, Bombs) {
  std::string costly = "[parameters]\n";
  for (int i = 0; i < 9000; ++i) {
    costly += "p" + std::to_string(i) + " = \"" + repeated("1.1^", 190) + "1\"\n";
  }
  expect_refused_at_once(costly + chain("1") + kRun, ":", {" 1048576 bytes", kTooLarge});
  expect_refused_at_once("[[body]]\ntype = \"particles\"\nparticle_mass = 1\npositions = [" +
                             repeated("\"sin(exp(log(2^0.3)))\",", 200'000) + "]\n" + kRun,
                         ":4:", {" 1048576 bytes", kTooLarge});
  expect_refused_at_once("a = [" + repeated("1,", 8'000'000) + "]\n",
                         std::string(":1:2000003:") + kTooLarge, {" 1000000 "});
}

TEST_F(HostileScene, Files) {
  const std::string sparse = (folder_ / "sparse.toml").string();
  std::ofstream(sparse).close();
  fs::resize_file(sparse, std::uintmax_t{100} << 30);
  ASSERT_EQ(mkfifo((folder_ / "fifo").c_str(), 0600), 0);
  const std::string unreadable = " [file.cannot_read]\n";
  struct Odd {
    std::string name;
    std::string code;
    std::string part;
  };
  for (const auto& [name, code, part] : {Odd{"sparse.toml", kTooLarge, " 16 M"},
                                         {"/dev/zero", unreadable, "device"},
                                         {"fifo", unreadable, "pipe"},
                                         {".", unreadable, "directory"}}) {
    expect_file_refused_at_once(name, ":1:1:" + code, {part});
    expect_refused_at_once(
        "[[body]]\ntype = \"particles\"\nparticle_mass = 1\nfile = \"" + name + "\"\n" + kRun,
        ":4:8: body.particles.file = \"" + name + "\"" + code, {part});
  }
  expect_file_refused_at_once("/dev/null", ":1:1:" + unreadable, {"device"});
}

// A scene takes the memory that messages state, as far as an address space that is a third too
// small or too large can show.
class Memory : public HostileScene {
 protected:
  void expect_takes(const std::string& scene, double bytes) {
    if (!kCanBeLimited) GTEST_SKIP() << "the sanitizers need memory of their own";
    constexpr double kProgram = 80e6;  // the program, its libraries and stacks
    constexpr double kTooLittle = 0.67;
    constexpr double kEnough = 1.33;
    write(folder_ / "scene.toml", scene);
    Conditions conditions;
    conditions.most_memory = static_cast<long>(kProgram + kTooLittle * bytes);
    const Ended starved = expect_status(2, tomlin({"run", "scene.toml", "-o", "out"}, conditions));
    EXPECT_EQ(abridged(starved.err), "tomlin: [scene.too_large]\n");
    conditions.most_memory = static_cast<long>(kProgram + kEnough * bytes);
    expect_status(0, tomlin({"run", "scene.toml", "-o", "out", "--force"}, conditions));
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
