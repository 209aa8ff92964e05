#include "framework/run/results/observables.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "framework/core/text/axis_names.hpp"
#include "framework/core/text/nearest_name.hpp"
#include "framework/run/results/results.hpp"

namespace tomlin {
namespace {

constexpr std::string_view kFamilyPrefixes[] = {"drivers.", "bodies.", "forces.", "observers."};

/// "driver.work" of "drivers.driver.work".
std::string_view without_family(std::string_view path) {
  for (const std::string_view family : kFamilyPrefixes) {
    if (path.starts_with(family)) return path.substr(family.size());
  }
  return path;
}

Fault unknown(const std::vector<Observable>& all, std::string_view path,
              const SourceLocation& location) {
  std::vector<std::string> names;
  for (const Observable& one : all) {
    names.emplace_back(without_family(one.path));
    names.push_back(one.path);
  }
  Fault fault(FaultCode::observable_unknown);
  fault.location = location;
  fault.key = path;
  fault.why = "there is no observable of that name";
  fault.admissible = "a dotted path as in summary.json, components by letter";
  if (!names.empty()) fault.admissible += ", say \"" + names.front() + "\"";
  fault.nearest = nearest_name(path, names).value_or("");
  // "mean_force", without whose and along which axis: the first of these.
  for (const std::string& name : names) {
    const bool part = ("." + name + ".").find("." + std::string(path) + ".") != std::string::npos;
    if (fault.nearest.empty() && !path.empty() && part) fault.nearest = name;
  }
  return fault;
}

}  // namespace

std::vector<Observable> observables(const RunResult& result) {
  std::vector<Observable> all;
  const auto add = [&all](const ResultGroup& group) {
    const std::string heading = group.family + "." + (group.name.empty() ? "" : group.name + ".");
    for (const ResultValue& value : group.values) {
      const ResultQuantity& quantity = value.quantity();
      for (std::size_t k = 0; k < value.count(); ++k) {
        std::string path = heading + quantity.key;
        if (quantity.shape == Shape::vector) path += std::string(".") + kAxisNames[k];
        all.push_back({std::move(path), value.finite(k), &quantity});
      }
    }
  };
  for (const ResultGroup& group : result.groups) add(group);
  for (const ResultGroup& group : groups_of_run(result)) add(group);
  return all;
}

namespace {

Observable found(const RunResult& result, std::string_view path, const SourceLocation& location) {
  const std::vector<Observable> all = observables(result);
  for (const Observable& one : all) {
    if (one.path == path || without_family(one.path) == path) return one;
  }
  throw InputError({unknown(all, path, location)});
}

}  // namespace

std::optional<double> observable(const RunResult& result, std::string_view path,
                                 const SourceLocation& location) {
  return found(result, path, location).value;
}

std::string full_path(const RunResult& result, std::string_view path,
                      const SourceLocation& location) {
  return found(result, path, location).path;
}

}  // namespace tomlin
