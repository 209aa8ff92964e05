#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace tomlin {

/// XXH3-128 as 32 hexadecimal digits, the same on every machine; `xxhsum -H128` prints it too.
std::string content_hash(std::span<const std::byte> bytes);

}  // namespace tomlin
