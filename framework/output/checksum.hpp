#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace tomlin {

/// XXH3-64, the same on every machine.
std::uint64_t checksum_of(std::span<const std::byte> bytes, std::uint64_t seed);

}  // namespace tomlin
