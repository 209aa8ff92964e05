#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

/// Random numbers that depend on nothing but their key and their counter: the counter-based
/// generator Philox 4x64-10 (Salmon, Moraes, Dror, Shaw, SC '11, doi:10.1145/2063384.2063405;
/// Random123).
namespace tomlin {

struct RandomKey {
  std::uint64_t seed = 0;
  std::uint64_t stream = 0;
};

/// Position in the stream: e.g. step, particle, stage. Never mix a seed into it.
struct RandomCounter {
  std::uint64_t a = 0;
  std::uint64_t b = 0;
  std::uint64_t c = 0;
  std::uint64_t d = 0;
};

/// The stream of what has this name, wherever it stands (FNV-1a, 64 bits; Fowler, Noll and Vo).
std::uint64_t stream_of(std::string_view name);

/// The stream of a component in one of the repeats of a run; that of repeat 0 is stream_of(name).
std::uint64_t stream_of(std::string_view name, std::uint64_t repeat);

/// Pairs of independent numbers, uniform in (0, 1): pair k is half of the block at {a, b, c + k/2,
/// d}.
void uniform_pairs(const RandomKey& key, const RandomCounter& counter, std::size_t count,
                   double* first, double* second);

/// Two independent numbers, uniform in (0, 1).
std::pair<double, double> uniform_pair(const RandomKey& key, const RandomCounter& counter);

/// Uniform in (-1, 1), symmetric about zero.
double uniform_symmetric(const RandomKey& key, const RandomCounter& counter);

}  // namespace tomlin
