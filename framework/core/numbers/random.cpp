#include "framework/core/numbers/random.hpp"

#include <string>

#include <Random123/philox.h>

namespace tomlin {

std::uint64_t stream_of(std::string_view name) {
  constexpr std::uint64_t kStart = 0xcbf29ce484222325;
  constexpr std::uint64_t kPrime = 0x100000001b3;
  std::uint64_t stream = kStart;
  for (const char letter : name) stream = (stream ^ static_cast<unsigned char>(letter)) * kPrime;
  return stream;
}

std::uint64_t stream_of(std::string_view name, std::uint64_t repeat) {
  if (repeat == 0) return stream_of(name);
  return stream_of(std::string(name) + "/" + std::to_string(repeat));  // no name has a slash
}

namespace {

r123::Philox4x64::ctr_type draw(const RandomKey& key, const RandomCounter& counter) {
  r123::Philox4x64 generator;
  const r123::Philox4x64::ctr_type block = {{counter.a, counter.b, counter.c, counter.d}};
  const r123::Philox4x64::key_type words = {{key.seed, key.stream}};
  return generator(block, words);
}

/// The middle of one of 2^52 equal parts of (0, 1): exact, and never an end.
double uniform(std::uint64_t word) { return static_cast<double>(word >> 12) * 0x1p-52 + 0x1p-53; }

}  // namespace

void uniform_pairs(const RandomKey& key, const RandomCounter& counter, std::size_t count,
                   double* first, double* second) {
  for (std::size_t k = 0; k < count; k += 2) {
    const auto bits = draw(key, {counter.a, counter.b, counter.c + k / 2, counter.d});
    for (std::size_t j = 0; j < 2 && k + j < count; ++j) {
      first[k + j] = uniform(bits[2 * j]);
      second[k + j] = uniform(bits[2 * j + 1]);
    }
  }
}

std::pair<double, double> uniform_pair(const RandomKey& key, const RandomCounter& counter) {
  const auto bits = draw(key, counter);
  return {uniform(bits[0]), uniform(bits[1])};
}

double uniform_symmetric(const RandomKey& key, const RandomCounter& counter) {
  const std::uint64_t bits = draw(key, counter)[0];
  // The middle of one of 2^53 equal parts of (-1, 1): exact, and never an end.
  return static_cast<double>(static_cast<std::int64_t>(bits) >> 11) * 0x1p-52 + 0x1p-53;
}

}  // namespace tomlin
