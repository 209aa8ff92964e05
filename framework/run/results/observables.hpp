#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/core/text/fault.hpp"
#include "framework/run/run.hpp"

/// The numbers of a result by name: the dotted paths of summary.json, components by letter.
namespace tomlin {

/// One number of a result.
struct Observable {
  std::string path;             ///< in full: "drivers.driver.mean_force.x", "bodies.ring.turns"
  std::optional<double> value;  ///< nothing where undefined: null in summary.json
  /// Its row; good as long as the result.
  const ResultQuantity* quantity = nullptr;
};

/// Every number of a result: of drivers, of bodies, then of the run as a whole. The paths depend on
/// the scene alone, not on how far the run got.
std::vector<Observable> observables(const RunResult& result);

/// The number at a path; the leading "drivers." or "bodies." may be left out, as in
/// "driver.mean_force.x" and "ring.turns". Nothing where it is undefined, say because the run
/// ended before the window. Throws InputError, with the nearest path, when there is none of that
/// name; `location` is where the path was written.
std::optional<double> observable(const RunResult& result, std::string_view path,
                                 const SourceLocation& location = {.file = "observable"});

/// The path in full: "drivers.driver.mean_force.x" of "driver.mean_force.x". Throws as above.
std::string full_path(const RunResult& result, std::string_view path,
                      const SourceLocation& location = {.file = "observable"});

}  // namespace tomlin
