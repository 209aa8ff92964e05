#include "framework/core/numbers/normal_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "framework/core/system/stage.hpp"
#include "tests/framework/core/math_bits.hpp"
#include "tests/framework/core/target_test.hpp"

// Normal numbers of a key and a counter: their bits, their moments, and that numbers of different
// counters have nothing to do with each other.

namespace tomlin {
inline namespace TOMLIN_TARGET {

namespace {

constexpr RandomKey kNormalKey{11, 0x9e3779b97f4a7c15u};
constexpr std::size_t kNormalsAtOnce = 64;

struct NormalBlock {
  alignas(64) double at[kNormalsAtOnce];
  NormalBlock(const RandomKey& key, const RandomCounter& counter,
              std::size_t length = kNormalsAtOnce, std::size_t used = kNormalsAtOnce) {
    fill_normals(key, counter, length, used, at);
  }
};

// Recorded once, of the baseline.
constexpr std::uint64_t kNormalBits = 2511090069341685786u;

std::uint64_t normal_bits() {
  BitsHash hash;
  for (std::uint64_t step = 0; step < 2000; ++step) {
    for (const double z : NormalBlock(kNormalKey, {step, step % 2, 0, 0}).at) hash.add(z);
  }
  return hash.value();
}

// The error of a mean over n numbers of unit variance is n^-1/2; bounds are four of them.
constexpr double kFourSigma = 4.0;

struct NormalMoments {
  double first = 0.0, second = 0.0, third = 0.0, fourth = 0.0, largest = 0.0, count = 0.0;
  void add(double z) {
    first += z;
    second += z * z;
    third += z * z * z;
    fourth += z * z * z * z;
    largest = z * z > largest * largest ? z : largest;
    count += 1.0;
  }
};

/// The mean of products of two sets of numbers: of independent ones within four sigma of 0.
class Correlation {
 public:
  void add(const NormalBlock& a, const NormalBlock& b) {
    for (std::size_t k = 0; k < kNormalsAtOnce; ++k) {
      sum_ += a.at[k] * b.at[k];
      count_ += 1.0;
    }
  }
  bool seen() const { return std::abs(sum_) > kFourSigma * std::sqrt(count_); }

 private:
  double sum_ = 0.0;
  double count_ = 0.0;
};

constexpr std::uint64_t kManySteps = 4000;

}  // namespace

TARGET_TEST(NormalNumbers, TheBitsOfEverySet) { EXPECT_EQ(normal_bits(), kNormalBits); }

/// Published with the generator (kat_vectors of Random123): philox4x64 10, key and counter of
/// zeros, of ones, and of the digits of pi.
TARGET_TEST(NormalNumbers, PhiloxAsPublished) {
  struct Answer {
    RandomKey key;
    RandomCounter counter;
    std::uint64_t words[4];
  };
  constexpr std::uint64_t kOnes = ~std::uint64_t{0};
  const Answer answers[] = {
      {{0, 0},
       {0, 0, 0, 0},
       {0x16554d9eca36314c, 0xdb20fe9d672d0fdc, 0xd7e772cee186176b, 0x7e68b68aec7ba23b}},
      {{kOnes, kOnes},
       {kOnes, kOnes, kOnes, kOnes},
       {0x87b092c3013fe90b, 0x438c3c67be8d0224, 0x9cc7d7c69cd777b6, 0xa09caebf594f0ba0}},
      {{0x452821e638d01377, 0xbe5466cf34e90c6c},
       {0x243f6a8885a308d3, 0x13198a2e03707344, 0xa4093822299f31d0, 0x082efa98ec4e6c89},
       {0xa528f45403e61d95, 0x38c72dbd566e9788, 0xa5a1610e72fd18b5, 0x57bd43b5e52b7fe6}}};
  for (const Answer& answer : answers) {
    double first[2];
    double second[2];
    uniform_pairs(answer.key, answer.counter, 2, first, second);
    const auto uniform = [](std::uint64_t word) {
      return static_cast<double>(word >> 12) * 0x1p-52 + 0x1p-53;
    };
    EXPECT_EQ(first[0], uniform(answer.words[0]));
    EXPECT_EQ(second[0], uniform(answer.words[1]));
    EXPECT_EQ(first[1], uniform(answer.words[2]));
    EXPECT_EQ(second[1], uniform(answer.words[3]));
  }
}

/// By the library's functions, from uniform numbers one at a time.
TARGET_TEST(NormalNumbers, AreThoseOfBoxAndMuller) {
  constexpr double kRounding = 1e-14;  // of sizes up to 8, by functions of one or two digits
  const RandomCounter counter{5, 1, 0, 0};
  const NormalBlock block(kNormalKey, counter);
  for (std::size_t pair = 0; pair < kNormalsAtOnce / 2; ++pair) {
    double u[2];
    double w[2];
    uniform_pairs(kNormalKey, {counter.a, counter.b, pair / 2, counter.d}, 2, u, w);
    const double size = std::sqrt(-2.0 * std::log(u[pair % 2]));
    const double angle = 2.0 * 3.14159265358979323846 * w[pair % 2];
    // A group of cosines, then the group of their sines.
    const std::size_t at = pair / kGroup * 2 * kGroup + pair % kGroup;
    EXPECT_NEAR(block.at[at], size * std::cos(angle), kRounding) << pair;
    EXPECT_NEAR(block.at[at + kGroup], size * std::sin(angle), kRounding) << pair;
  }
}

/// How many of a group are wanted changes none of them.
TARGET_TEST(NormalNumbers, DoNotDependOnHowManyAreUsed) {
  const RandomCounter counter{9, 0, 0, 0};
  const NormalBlock all(kNormalKey, counter);
  for (const std::size_t used : {1U, 3U, 7U, 8U}) {
    const NormalBlock some(kNormalKey, counter, 3 * kGroup, used);
    for (std::size_t group = 0; group < 3; ++group) {
      for (std::size_t k = 0; k < used; ++k) {
        EXPECT_EQ(some.at[group * kGroup + k], all.at[group * kGroup + k]) << used;
      }
    }
  }
}

/// Mean, variance, skewness and kurtosis of 1e6 numbers: their errors are (1, 2, 15, 96)^1/2 /
/// 1000.
TARGET_TEST(NormalNumbers, HaveTheMomentsOfNormalOnes) {
  NormalMoments moments;
  constexpr std::uint64_t kSteps = 1000000 / kNormalsAtOnce;
  for (std::uint64_t step = 0; step < kSteps; ++step) {
    for (const double z : NormalBlock(kNormalKey, {step, 0, 0, 0}).at) moments.add(z);
  }
  const double n = moments.count;
  const double unit = kFourSigma / std::sqrt(n);
  EXPECT_NEAR(moments.first / n, 0.0, unit);
  EXPECT_NEAR(moments.second / n, 1.0, std::sqrt(2.0) * unit);
  EXPECT_NEAR(moments.third / n, 0.0, std::sqrt(15.0) * unit);
  EXPECT_NEAR(moments.fourth / n, 3.0, std::sqrt(96.0) * unit);
  // The largest of 1e6 is near 4.9: beyond 4 and below 6.5 but for one in 1e4 such sets.
  EXPECT_GT(std::abs(moments.largest), 4.0);
  EXPECT_LT(std::abs(moments.largest), 6.5);
}

/// Neighbouring steps, parts of a step, blocks, keys: no numbers are shared, and none are related.
TARGET_TEST(NormalNumbers, OfDifferentPlacesAreIndependent) {
  Correlation of_steps, of_parts, of_bodies, of_streams, of_seeds, of_particles, of_axes, planted;
  for (std::uint64_t step = 0; step < kManySteps; ++step) {
    const NormalBlock here(kNormalKey, {step, 0, 0, 0});
    of_steps.add(here, NormalBlock(kNormalKey, {step + 1, 0, 0, 0}));
    of_parts.add(here, NormalBlock(kNormalKey, {step, 1, 0, 0}));
    of_bodies.add(here, NormalBlock(kNormalKey, {step, 0, 0, 1}));
    of_streams.add(here, NormalBlock({kNormalKey.seed, kNormalKey.stream + 1}, {step, 0, 0, 0}));
    of_seeds.add(here, NormalBlock({kNormalKey.seed + 1, kNormalKey.stream}, {step, 0, 0, 0}));
    NormalBlock shifted = here;
    for (std::size_t k = 0; k < kNormalsAtOnce; ++k) {
      shifted.at[k] = here.at[(k + 1) % kNormalsAtOnce];
    }
    of_particles.add(here, shifted);
    for (std::size_t k = 0; k < kNormalsAtOnce; ++k) {
      shifted.at[k] = here.at[(k + kGroup) % kNormalsAtOnce];
    }
    of_axes.add(here, shifted);
    planted.add(here, here);
  }
  EXPECT_FALSE(of_steps.seen());
  EXPECT_FALSE(of_parts.seen());
  EXPECT_FALSE(of_bodies.seen());
  EXPECT_FALSE(of_streams.seen());
  EXPECT_FALSE(of_seeds.seen());
  EXPECT_FALSE(of_particles.seen());
  EXPECT_FALSE(of_axes.seen());
  EXPECT_TRUE(planted.seen()) << "the same numbers would be seen";
}

/// A seed that is added to a counter repeats, with seed + 1, the numbers of the next step.
TARGET_TEST(NormalNumbers, NoSeedRepeatsTheNumbersOfAnother) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    for (std::uint64_t step = 0; step < 50; ++step) {
      const NormalBlock here({seed, kNormalKey.stream}, {step, 0, 0, 0});
      for (std::uint64_t by = 1; by < 4; ++by) {
        const NormalBlock next({seed + by, kNormalKey.stream}, {step, 0, 0, 0});
        const NormalBlock earlier({seed, kNormalKey.stream}, {step + by, 0, 0, 0});
        EXPECT_NE(next.at[0], earlier.at[0]) << seed << ", " << step;
        EXPECT_NE(here.at[0], next.at[0]);
        EXPECT_NE(here.at[0], earlier.at[0]);
      }
    }
  }
}

/// Streams of components and of repeats.
TARGET_TEST(NormalNumbers, StreamsOfRepeats) {
  EXPECT_EQ(stream_of("", 0), 0xcbf29ce484222325u);     // as published: FNV-1a of nothing,
  EXPECT_EQ(stream_of("foobar"), 0x85944171f73967e8u);  // and of a word
  EXPECT_EQ(stream_of("bath", 0), stream_of("bath"));
  std::vector<std::uint64_t> all;
  for (const char* name : {"bath", "bath1", "other"}) {
    for (std::uint64_t repeat = 0; repeat < 300; ++repeat) {
      all.push_back(stream_of(name, repeat));
    }
  }
  std::sort(all.begin(), all.end());
  EXPECT_EQ(std::adjacent_find(all.begin(), all.end()), all.end());
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
