#include "framework/core/system/state_layout.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace tomlin {
namespace {

/// Room for kernels that load one group past the last number.
constexpr std::size_t kPadding = 2 * kGroup;

const StateLayout::Field& find(const std::vector<StateLayout::Field>& fields,
                               std::string_view name) {
  for (const auto& field : fields) {
    if (field.name == name) return field;
  }
  throw std::invalid_argument("the run state has no field \"" + std::string(name) + "\"");
}

bool same(const std::vector<StateLayout::Field>& a, const std::vector<StateLayout::Field>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (a[k].name != b[k].name || a[k].first != b[k].first || a[k].count != b[k].count)
      return false;
  }
  return true;
}

}  // namespace

std::size_t StateLayout::add_reals(std::string name, std::size_t count) {
  const std::size_t first = real_count_;
  reals_.push_back({std::move(name), first, count});
  real_count_ += padded(count) + kPadding;
  return first;
}

std::size_t StateLayout::add_integers(std::string name, std::size_t count) {
  const std::size_t first = integer_count_;
  integers_.push_back({std::move(name), first, count});
  integer_count_ += count;
  return first;
}

void StateLayout::add_raw(std::string name, std::size_t bytes) {
  raw_.push_back({std::move(name), raw_count_, bytes});
  raw_count_ += (bytes + kAlignment - 1) / kAlignment * kAlignment;
}

bool operator==(const StateLayout& a, const StateLayout& b) {
  return same(a.reals_, b.reals_) && same(a.integers_, b.integers_) && same(a.raw_, b.raw_);
}

RunState::RunState(const StateLayout& layout)
    : layout_(layout),
      reals_(layout.real_count(), 0.0),
      integers_(layout.integer_count(), 0),
      raw_(layout.raw_count(), std::byte{0}) {}

double* RunState::reals(std::string_view field) {
  return reals_.data() + find(layout_.reals(), field).first;
}

const double* RunState::reals(std::string_view field) const {
  return reals_.data() + find(layout_.reals(), field).first;
}

std::int64_t* RunState::integers(std::string_view field) {
  return integers_.data() + find(layout_.integers(), field).first;
}

const std::int64_t* RunState::integers(std::string_view field) const {
  return integers_.data() + find(layout_.integers(), field).first;
}

std::byte* RunState::raw(std::string_view field) {
  return raw_.data() + find(layout_.raw(), field).first;
}

void RunState::copy_numbers(const RunState& from) {
  if (from.reals_.size() != reals_.size() || from.integers_.size() != integers_.size() ||
      from.raw_.size() != raw_.size()) {
    throw std::invalid_argument("numbers of another layout cannot be copied");
  }
  std::copy(from.reals_.begin(), from.reals_.end(), reals_.begin());
  std::copy(from.integers_.begin(), from.integers_.end(), integers_.begin());
  std::copy(from.raw_.begin(), from.raw_.end(), raw_.begin());
}

std::vector<std::byte> RunState::to_bytes() const {
  std::vector<std::byte> bytes;
  const auto append = [&bytes](const auto& numbers) {
    const auto* first = reinterpret_cast<const std::byte*>(numbers.data());
    bytes.insert(bytes.end(), first, first + numbers.size() * sizeof(numbers[0]));
  };
  append(reals_);
  append(integers_);
  append(raw_);
  return bytes;
}

void RunState::from_bytes(const std::vector<std::byte>& bytes) {
  const std::size_t expected =
      reals_.size() * sizeof(double) + integers_.size() * sizeof(std::int64_t) + raw_.size();
  if (bytes.size() != expected) {
    throw std::invalid_argument("the bytes are of a run state of another size");
  }
  const std::byte* next = bytes.data();
  const auto take = [&next](auto& numbers) {
    const std::size_t length = numbers.size() * sizeof(numbers[0]);
    if (length > 0) std::memcpy(numbers.data(), next, length);
    next += length;
  };
  take(reals_);
  take(integers_);
  take(raw_);
}

}  // namespace tomlin
