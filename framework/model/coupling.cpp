#include "framework/model/coupling.hpp"

#include <algorithm>
#include <unordered_set>

namespace tomlin {

void CouplingGraph::join(std::size_t one, std::size_t other) {
  if (one == other) return;
  neighbours_[one].push_back(other);
  neighbours_[other].push_back(one);
}

void CouplingGraph::settle() {
  for (std::vector<std::size_t>& list : neighbours_) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
}

std::vector<std::size_t> CouplingGraph::by_distance(std::size_t start) const {
  std::vector<std::size_t> order = {start};
  std::unordered_set<std::size_t> seen = {start};
  for (std::size_t next = 0; next < order.size(); ++next) {
    const std::size_t first = order.size();
    for (const std::size_t other : neighbours_[order[next]]) {
      if (seen.insert(other).second) order.push_back(other);
    }
    std::stable_sort(order.begin() + static_cast<std::ptrdiff_t>(first), order.end(),
                     [&](std::size_t a, std::size_t b) {
                       return neighbours_[a].size() < neighbours_[b].size();
                     });
  }
  return order;
}

/// Far from everything, roughly: the last of a walk that started at the last of another.
std::size_t CouplingGraph::far_end(std::size_t start) const {
  return by_distance(by_distance(start).back()).back();
}

std::vector<std::size_t> CouplingGraph::narrow_order() const {
  std::vector<std::size_t> order;
  std::vector<bool> placed(size(), false);
  for (std::size_t node = 0; node < size(); ++node) {
    if (placed[node]) continue;
    for (const std::size_t next : by_distance(far_end(node))) {
      placed[next] = true;
      order.push_back(next);
    }
  }
  std::reverse(order.begin(), order.end());
  return order;
}

std::vector<std::size_t> CouplingGraph::groups() const {
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::vector<std::size_t> group(size(), kNone);
  std::vector<std::size_t> taken_by;  // the last node that could not have this group
  for (std::size_t node = 0; node < size(); ++node) {
    const auto avoid = [&](std::size_t other) {
      if (group[other] != kNone) taken_by[group[other]] = node;
    };
    for (const std::size_t near : neighbours_[node]) {
      avoid(near);
      for (const std::size_t further : neighbours_[near]) avoid(further);
    }
    const auto free =
        std::find_if(taken_by.begin(), taken_by.end(), [&](std::size_t by) { return by != node; });
    group[node] = static_cast<std::size_t>(free - taken_by.begin());
    if (free == taken_by.end()) taken_by.push_back(kNone);
  }
  return group;
}

}  // namespace tomlin
