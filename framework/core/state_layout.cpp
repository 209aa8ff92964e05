#include "framework/core/state_layout.hpp"

#include <cstring>
#include <stdexcept>
#include <utility>

namespace tomlin {
namespace {

/// Room for kernels that load one group past the last number.
constexpr std::size_t kSlack = 2 * kGroup;

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
  real_count_ += padded(count) + kSlack;
  return first;
}

std::size_t StateLayout::add_integers(std::string name, std::size_t count) {
  const std::size_t first = integer_count_;
  integers_.push_back({std::move(name), first, count});
  integer_count_ += count;
  return first;
}

bool operator==(const StateLayout& a, const StateLayout& b) {
  return same(a.reals_, b.reals_) && same(a.integers_, b.integers_);
}

RunState::RunState(const StateLayout& layout, std::size_t replicas)
    : layout_(layout),
      replicas_(replicas),
      reals_(layout.real_count() * replicas, 0.0),
      integers_(layout.integer_count() * replicas, 0) {}

double* RunState::reals(std::string_view field) {
  return reals_.data() + find(layout_.reals(), field).first * replicas_;
}

const double* RunState::reals(std::string_view field) const {
  return reals_.data() + find(layout_.reals(), field).first * replicas_;
}

std::int64_t* RunState::integers(std::string_view field) {
  return integers_.data() + find(layout_.integers(), field).first * replicas_;
}

const std::int64_t* RunState::integers(std::string_view field) const {
  return integers_.data() + find(layout_.integers(), field).first * replicas_;
}

RunState RunState::extract(std::size_t replica) const {
  if (replica >= replicas_) throw std::invalid_argument("no such replica");
  RunState single(layout_, 1);
  for (std::size_t k = 0; k < single.reals_.size(); ++k) {
    single.reals_[k] = reals_[k * replicas_ + replica];
  }
  for (std::size_t k = 0; k < single.integers_.size(); ++k) {
    single.integers_[k] = integers_[k * replicas_ + replica];
  }
  return single;
}

void RunState::insert(std::size_t replica, const RunState& single) {
  if (replica >= replicas_ || single.replicas_ != 1 || !(single.layout_ == layout_)) {
    throw std::invalid_argument("a replica of another layout cannot be inserted");
  }
  for (std::size_t k = 0; k < single.reals_.size(); ++k) {
    reals_[k * replicas_ + replica] = single.reals_[k];
  }
  for (std::size_t k = 0; k < single.integers_.size(); ++k) {
    integers_[k * replicas_ + replica] = single.integers_[k];
  }
}

std::vector<std::byte> RunState::to_bytes() const {
  const std::size_t real_bytes = reals_.size() * sizeof(double);
  const std::size_t integer_bytes = integers_.size() * sizeof(std::int64_t);
  std::vector<std::byte> bytes(real_bytes + integer_bytes);
  if (real_bytes > 0) std::memcpy(bytes.data(), reals_.data(), real_bytes);
  if (integer_bytes > 0) std::memcpy(bytes.data() + real_bytes, integers_.data(), integer_bytes);
  return bytes;
}

void RunState::from_bytes(const std::vector<std::byte>& bytes) {
  const std::size_t real_bytes = reals_.size() * sizeof(double);
  const std::size_t integer_bytes = integers_.size() * sizeof(std::int64_t);
  if (bytes.size() != real_bytes + integer_bytes) {
    throw std::invalid_argument("the bytes are of a run state of another size");
  }
  if (real_bytes > 0) std::memcpy(reals_.data(), bytes.data(), real_bytes);
  if (integer_bytes > 0) std::memcpy(integers_.data(), bytes.data() + real_bytes, integer_bytes);
}

}  // namespace tomlin
