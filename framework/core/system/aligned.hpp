#pragma once

#include <cstddef>
#include <new>
#include <vector>

#include "framework/core/system/stage.hpp"

namespace tomlin {

/// Every array that a kernel touches starts on a cache line.
inline constexpr std::size_t kAlignment = 64;

template <class T>
struct AlignedAllocator {
  using value_type = T;
  AlignedAllocator() = default;
  template <class U>
  AlignedAllocator(const AlignedAllocator<U>&) {}
  T* allocate(std::size_t n) {
    return static_cast<T*>(::operator new(n * sizeof(T), std::align_val_t(kAlignment)));
  }
  void deallocate(T* p, std::size_t) { ::operator delete(p, std::align_val_t(kAlignment)); }
  friend bool operator==(const AlignedAllocator&, const AlignedAllocator&) { return true; }
};

template <class T>
using AlignedVector = std::vector<T, AlignedAllocator<T>>;

/// The length of an array of n numbers with its padding.
constexpr std::size_t padded(std::size_t n) { return (n + kGroup - 1) / kGroup * kGroup; }

}  // namespace tomlin
