#include "framework/core/numbers/random.hpp"

#include <Random123/philox.h>

namespace tomlin {

std::uint64_t stream_of(std::string_view name) {
  constexpr std::uint64_t kStart = 0xcbf29ce484222325;
  constexpr std::uint64_t kPrime = 0x100000001b3;
  std::uint64_t stream = kStart;
  for (const char letter : name) stream = (stream ^ static_cast<unsigned char>(letter)) * kPrime;
  return stream;
}

namespace {

r123::Philox4x64::ctr_type draw(const RandomKey& key, const RandomPlace& place) {
  r123::Philox4x64 generator;
  const r123::Philox4x64::ctr_type counter = {{place.a, place.b, place.c, place.d}};
  const r123::Philox4x64::key_type words = {{key.seed, key.stream}};
  return generator(counter, words);
}

}  // namespace

std::pair<double, double> uniform_pair(const RandomKey& key, const RandomPlace& place) {
  const auto bits = draw(key, place);
  // The middle of one of 2^52 equal parts: exact, and never an end.
  const auto uniform = [](std::uint64_t word) {
    return static_cast<double>(word >> 12) * 0x1p-52 + 0x1p-53;
  };
  return {uniform(bits[0]), uniform(bits[1])};
}

double uniform_symmetric(const RandomKey& key, const RandomPlace& place) {
  const std::uint64_t bits = draw(key, place)[0];
  // The middle of one of 2^53 equal parts of (-1, 1): exact, and never an end.
  return static_cast<double>(static_cast<std::int64_t>(bits) >> 11) * 0x1p-52 + 0x1p-53;
}

}  // namespace tomlin
