#include "framework/run/results/result_group.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace tomlin {

std::string unit_of(const ResultQuantity& quantity) {
  return quantity.unit.empty() ? to_string(quantity.dimension) : quantity.unit;
}

std::string unit_in_tables(UnitSystem units, const ResultQuantity& quantity) {
  const bool spelled = units == UnitSystem::reduced || quantity.dimension == dimension::none;
  if (spelled && !quantity.unit.empty()) return quantity.unit;
  return unit_in_tables(units, quantity.dimension);
}

void ResultValue::convert_to(UnitSystem units) {
  const double unit = scene_unit(units, quantity_->dimension);
  if (unit == 1.0) return;
  for (double& number : numbers_) number /= unit;
}

void ResultValue::set(std::span<const double> numbers) {
  if (numbers.size() != count_) throw std::invalid_argument("numbers of another count");
  std::copy(numbers.begin(), numbers.end(), numbers_.begin());
  defined_ = true;
}

double ResultValue::value() const {
  if (!defined_) throw std::bad_optional_access();
  return numbers_[0];
}

double ResultValue::at(std::size_t k) const {
  if (k >= size()) throw std::out_of_range(quantity_->key + " has no such component");
  return numbers_[k];
}

std::optional<double> ResultValue::finite(std::size_t k) const {
  if (!defined_ || !std::isfinite(numbers_.at(k))) return {};
  return numbers_[k];
}

const ResultValue* ResultGroup::find(std::string_view key) const {
  const auto found = std::find_if(values.begin(), values.end(), [key](const ResultValue& value) {
    return value.quantity().key == key;
  });
  return found == values.end() ? nullptr : &*found;
}

const ResultValue& ResultGroup::operator[](std::string_view key) const {
  const ResultValue* found = find(key);
  if (found == nullptr) {
    throw std::out_of_range(family + " " + name + " have no " + std::string(key));
  }
  return *found;
}

ResultValue& ResultGroup::add_row(std::shared_ptr<const ResultQuantity> quantity,
                                  std::size_t axes) {
  const std::size_t count = quantity->shape == Shape::vector ? axes : 1;
  return values.emplace_back(std::move(quantity), count);
}

ResultValue& ResultGroup::add_row(const ResultQuantity& quantity, std::size_t axes) {
  // The row is not owned.
  return add_row(
      std::shared_ptr<const ResultQuantity>(std::shared_ptr<const ResultQuantity>(), &quantity),
      axes);
}

void ResultGroup::add(const ResultQuantity& quantity, std::optional<double> value) {
  ResultValue& added = add_row(quantity);
  if (value) added.set({&*value, 1});
}

void ResultGroup::add(const ResultQuantity& quantity, std::size_t axes,
                      const std::vector<double>& components) {
  ResultValue& added = add_row(quantity, axes);
  if (!components.empty()) added.set(components);
}

}  // namespace tomlin
