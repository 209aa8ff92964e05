#include "framework/scene/fault_list.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace tomlin {
namespace {

bool found_before(const FoundFault& a, const FoundFault& b) {
  const auto order = [](const FoundFault& found) {
    const SourceLocation& location = found.fault.location;
    return std::tuple(found.setting, location.line, location.column);
  };
  return order(a) < order(b);
}

}  // namespace

void FaultList::of_value(const Node& value, Wrong wrong) {
  add(value.where.setting, source_.location(value.where), source_.written(value.where),
      std::move(wrong));
}

void FaultList::of_wrong_type(const Node& value, std::string key, std::string admissible) {
  of_value(value, {FaultCode::scene_wrong_type, std::move(key), "found " + kind_of(value),
                   std::move(admissible)});
}

void FaultList::of_key(const Extent& key, Wrong wrong) {
  add(key.setting, source_.location(key), "", std::move(wrong));
}

void FaultList::inside(const Node& text, std::size_t byte, Wrong wrong) {
  add(text.where.setting, source_.location_inside(text, byte), source_.written(text.where),
      std::move(wrong));
}

void FaultList::throw_if_any() const {
  if (!faults_.empty()) throw InputError(in_order());
}

std::vector<Fault> FaultList::in_order() const {
  std::vector<FoundFault> found = faults_;
  std::stable_sort(found.begin(), found.end(), found_before);
  std::vector<Fault> faults;
  faults.reserve(found.size());
  for (FoundFault& one : found) faults.push_back(std::move(one.fault));
  return faults;
}

void FaultList::take(Fault fault) { add({0, std::move(fault)}); }

void FaultList::add(std::uint32_t setting, SourceLocation location, std::string value,
                    Wrong wrong) {
  add({setting,
       Fault(wrong.code, std::move(location), std::move(wrong.key), std::move(value),
             std::move(wrong.why), std::move(wrong.admissible), std::move(wrong.nearest))});
}

void FaultList::add(FoundFault found) {
  if (faults_.size() == kMostFaults) {
    std::vector<Fault> faults = in_order();
    faults.emplace_back(FaultCode::scene_too_many_faults, faults.back().location, "", "",
                        "further faults are not shown");
    throw InputError(std::move(faults));
  }
  faults_.push_back(std::move(found));
}

}  // namespace tomlin
