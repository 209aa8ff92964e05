#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "framework/core/system/aligned.hpp"

/// Everything that changes during a run, in one declared layout: positions, clocks, controllers,
/// running integrals, observers. What is not declared here is scratch and can be lost at any step
/// boundary.
namespace tomlin {

/// Names and sizes; filled by the engine, the integrator and the observers before the run starts.
class StateLayout {
 public:
  struct Field {
    std::string name;
    std::size_t first = 0;
    std::size_t count = 0;
  };

  /// Fields start on a group boundary, so that kernels may load them whole.
  std::size_t add_reals(std::string name, std::size_t count);
  std::size_t add_integers(std::string name, std::size_t count);
  /// Numbers of the run's number type: reals for double, bytes of their own otherwise.
  template <class Real>
  void add_numbers(std::string name, std::size_t count) {
    if constexpr (std::is_same_v<Real, double>) {
      add_reals(std::move(name), count);
    } else {
      add_raw(std::move(name), (padded(count) + 2 * kGroup) * sizeof(Real));
    }
  }

  const std::vector<Field>& reals() const { return reals_; }
  const std::vector<Field>& integers() const { return integers_; }
  std::size_t real_count() const { return real_count_; }
  const std::vector<Field>& raw() const { return raw_; }
  std::size_t integer_count() const { return integer_count_; }
  std::size_t raw_count() const { return raw_count_; }

  friend bool operator==(const StateLayout& a, const StateLayout& b);

 private:
  void add_raw(std::string name, std::size_t bytes);

  std::vector<Field> reals_;
  std::vector<Field> integers_;
  std::vector<Field> raw_;  ///< in bytes
  std::size_t real_count_ = 0;
  std::size_t integer_count_ = 0;
  std::size_t raw_count_ = 0;
};

/// The numbers of a layout.
class RunState {
 public:
  RunState() = default;
  explicit RunState(const StateLayout& layout);

  bool empty() const { return reals_.empty() && integers_.empty() && raw_.empty(); }
  const StateLayout& layout() const { return layout_; }

  double* reals(std::string_view field);
  const double* reals(std::string_view field) const;
  std::int64_t* integers(std::string_view field);
  const std::int64_t* integers(std::string_view field) const;

  /// A field of add_numbers<Real>().
  template <class Real>
  Real* numbers(std::string_view field) {
    if constexpr (std::is_same_v<Real, double>) {
      return reals(field);
    } else {
      return reinterpret_cast<Real*>(raw(field));
    }
  }

  /// All numbers of another state of the same layout, where they stand: pointers to them stay good.
  void copy_numbers(const RunState& from);

  /// All numbers as bytes, and back; the layout is not in the bytes. Throws std::invalid_argument
  /// when the size does not fit.
  std::vector<std::byte> to_bytes() const;
  void from_bytes(const std::vector<std::byte>& bytes);

 private:
  std::byte* raw(std::string_view field);

  StateLayout layout_;
  AlignedVector<double> reals_;
  std::vector<std::int64_t> integers_;
  AlignedVector<std::byte> raw_;
};

/// Declares the numbers of a list of parts, in fields of this name, and attaches the parts to them.
template <class Part>
void declare_all(StateLayout& layout, const std::string& name, const std::vector<Part>& parts) {
  layout.add_reals(name, parts.size() * Part::kReals);
  layout.add_integers(name, parts.size() * Part::kIntegers);
}
template <class Part>
void attach_all(RunState& state, const std::string& name, std::vector<Part>& parts) {
  double* reals = state.reals(name);
  std::int64_t* integers = state.integers(name);
  for (Part& part : parts) {
    part.attach(std::exchange(reals, reals + Part::kReals),
                std::exchange(integers, integers + Part::kIntegers));
  }
}

}  // namespace tomlin
