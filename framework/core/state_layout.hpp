#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "framework/core/aligned.hpp"

/// Everything that changes during a run, in one declared layout for W >= 1 replicas: positions,
/// clocks, controllers, running integrals, observers. What is not declared here is scratch and can
/// be lost at any step boundary.
namespace tomlin {

/// Names and sizes; filled by the engine, the integrator and the observers before the run starts.
class StateLayout {
 public:
  struct Field {
    std::string name;
    std::size_t first = 0;  ///< in units of one replica's numbers
    std::size_t count = 0;
  };

  /// Fields start on a group boundary, so that kernels may load them whole.
  std::size_t add_reals(std::string name, std::size_t count);
  std::size_t add_integers(std::string name, std::size_t count);

  const std::vector<Field>& reals() const { return reals_; }
  const std::vector<Field>& integers() const { return integers_; }
  std::size_t real_count() const { return real_count_; }
  std::size_t integer_count() const { return integer_count_; }

  friend bool operator==(const StateLayout& a, const StateLayout& b);

 private:
  std::vector<Field> reals_;
  std::vector<Field> integers_;
  std::size_t real_count_ = 0;
  std::size_t integer_count_ = 0;
};

/// The numbers. Number k of replica w stands at [k * replicas + w]: the lanes of a batch are
/// contiguous, and with one replica an array is an array.
class RunState {
 public:
  RunState() = default;
  RunState(const StateLayout& layout, std::size_t replicas);

  std::size_t replicas() const { return replicas_; }
  const StateLayout& layout() const { return layout_; }

  double* reals(std::string_view field);
  const double* reals(std::string_view field) const;
  std::int64_t* integers(std::string_view field);
  const std::int64_t* integers(std::string_view field) const;

  /// One replica as a state of its own, and back. Throws std::invalid_argument when the layouts
  /// differ or there is no such replica.
  RunState extract(std::size_t replica) const;
  void insert(std::size_t replica, const RunState& single);

  /// All numbers as bytes, and back; the layout is not in the bytes. Throws std::invalid_argument
  /// when the size does not fit.
  std::vector<std::byte> to_bytes() const;
  void from_bytes(const std::vector<std::byte>& bytes);

 private:
  StateLayout layout_;
  std::size_t replicas_ = 0;
  AlignedVector<double> reals_;
  std::vector<std::int64_t> integers_;
};

}  // namespace tomlin
