#pragma once

#include <cstddef>

namespace tomlin {

/// The one summation rule: eight interleaved partial sums, folded pairwise. A sum over particles
/// has the same bits whether it is taken here, one by one, or in the lanes of a Pack.
template <class T>
class InterleavedSum {
 public:
  void add(std::size_t index, const T& x) { partial_[index % 8] = partial_[index % 8] + x; }

  T total() const {
    const T a = partial_[0] + partial_[4];
    const T b = partial_[1] + partial_[5];
    const T c = partial_[2] + partial_[6];
    const T d = partial_[3] + partial_[7];
    return (a + c) + (b + d);
  }

 private:
  T partial_[8] = {T(0.0), T(0.0), T(0.0), T(0.0), T(0.0), T(0.0), T(0.0), T(0.0)};
};

}  // namespace tomlin
