#include "framework/scene/fault_list.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace tomlin {
namespace {

constexpr const char* kSettings = "--set";

bool comes_before(const Fault& a, const Fault& b) {
  const auto order = [](const Fault& fault) {
    return std::tuple(fault.place.file == kSettings, fault.place.line, fault.place.column);
  };
  return order(a) < order(b);
}

}  // namespace

void FaultList::of_value(const Node& value, Wrong wrong) {
  add(source_.place(value.where), source_.written(value.where), std::move(wrong));
}

void FaultList::of_key(const Extent& key, Wrong wrong) {
  add(source_.place(key), "", std::move(wrong));
}

void FaultList::inside(const Node& text, std::size_t byte, Wrong wrong) {
  add(source_.place_inside(text, byte), source_.written(text.where), std::move(wrong));
}

void FaultList::throw_if_any() const {
  if (!faults_.empty()) throw InputError(in_order());
}

std::vector<Fault> FaultList::in_order() const {
  std::vector<Fault> faults = faults_;
  std::stable_sort(faults.begin(), faults.end(), comes_before);
  return faults;
}

void FaultList::add(Place place, std::string value, Wrong wrong) {
  if (faults_.size() == kMostFaults) {
    std::vector<Fault> faults = in_order();
    Fault more;
    more.place = faults.back().place;
    more.why = "and more faults; these were the first that were found";
    faults.push_back(std::move(more));
    throw InputError(std::move(faults));
  }
  Fault fault;
  fault.place = std::move(place);
  fault.key = std::move(wrong.key);
  fault.value = std::move(value);
  fault.why = std::move(wrong.why);
  fault.admissible = std::move(wrong.admissible);
  fault.nearest = std::move(wrong.nearest);
  faults_.push_back(std::move(fault));
}

}  // namespace tomlin
