#include "framework/run/guard/watched_integrals.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/run/steps/run_plan.hpp"

namespace tomlin {
namespace {

/// Works that are known to a part of this are said to be known well.
constexpr double kLargestRoundingPart = 1e-4;

double steady_speed_of(const Model::Driver& driver) {
  return driver.drive->steady ? speed_of(*driver.drive) : 0.0;
}

}  // namespace

/// Forces of drivers that rest, or whose speed changes, count with the fastest steady one's.
std::vector<WatchedIntegral> watched_integrals(const Model& model) {
  std::vector<WatchedIntegral> all;
  const auto axes = static_cast<std::size_t>(model.dimension());
  double fastest = 0.0;
  for (const Model::Driver& driver : model.drivers()) {
    fastest = std::max(fastest, steady_speed_of(driver));
  }
  for (const Model::Driver& driver : model.drivers()) {
    const auto first = static_cast<std::size_t>(driver.first_rate);
    const double speed = steady_speed_of(driver);
    for (std::size_t d = 0; d < axes && fastest > 0.0; ++d) {
      all.push_back({first + d, speed > 0.0 ? speed : fastest,
                     driver.drive->stiffness_on(static_cast<int>(d))});
    }
    if (!driver.drive->steady) all.push_back({first + axes, 1.0});
  }
  for (const Model::Force& force : model.forces()) {
    if (!force.traits.conservative || force.heat_rate == kNoRate) continue;
    all.push_back({static_cast<std::size_t>(force.heat_rate), 1.0});
  }
  return all;
}

std::vector<double> along_with_drivers(const Model& model) {
  std::vector<double> along(model.system().view.dofs, 0.0);
  const Model::Driver* fastest = nullptr;
  for (const Model::Driver& driver : model.drivers()) {
    if (steady_speed_of(driver) > (fastest != nullptr ? steady_speed_of(*fastest) : 0.0))
      fastest = &driver;
  }
  if (fastest == nullptr) return along;
  for (const Model::Body& body : model.bodies()) {
    const BodySlot<double>& slot = body.bound.slot;
    for (int d = 0; d < model.dimension(); ++d) {
      const double velocity = fastest->drive->velocity[d];
      if (slot.rigid) {
        along[slot.centre + d] = velocity;
      } else if (!slot.mapped) {
        const auto first =
            along.begin() + static_cast<std::ptrdiff_t>(slot.offset + d * slot.stride);
        std::fill(first, first + static_cast<std::ptrdiff_t>(slot.count), velocity);
      }
    }
  }
  return along;
}

std::optional<Warning> doubt_of_rounding(double rounding, double work, double tolerance) {
  if (work == 0.0) return std::nullopt;
  const double part = rounding / std::abs(work);
  if (!(part > std::max(kLargestRoundingPart, tolerance))) return std::nullopt;
  return Warning{FaultCode::run_work_rounding,
                 fmt::format("rounding makes up a part of {:.2g} of the drivers' work: so slow a "
                             "motion dissipates less than double precision carries beside the "
                             "forces that do no work; quasistatic dynamics give the limit of slow "
                             "driving",
                             part),
                 "drivers"};
}

}  // namespace tomlin
