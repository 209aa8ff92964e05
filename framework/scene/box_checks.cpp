#include "framework/scene/box_checks.hpp"

#include <cmath>
#include <cstddef>
#include <string>

#include <fmt/format.h>

#include "framework/core/text/axis_names.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

/// True when the key was read and has one entry per dimension; a wrong number is reported.
bool has_size(const TableReading& reading, const char* key, std::size_t given, int dimension,
              FaultList& faults) {
  if (!reading.has(key)) return false;
  if (given == static_cast<std::size_t>(dimension)) return true;
  reading.complain(faults, key,
                   {FaultCode::scene_wrong_count, "",
                    fmt::format("mixed dimensions: {} given, but the first body sets the "
                                "dimension to {}",
                                given, dimension)});
  return false;
}

bool divides(double period, double length) {
  const double times = std::round(length / period);
  return times >= 1.0 && std::fabs(length - times * period) <= kPeriodTolerance * length;
}

std::string nearest_lengths(double period, double length) {
  const double times = std::floor(length / period);
  const std::string above = fmt::format("{}", (times + 1.0) * period);
  return times < 1.0 ? above : fmt::format("{} or {}", times * period, above);
}

void check_period(const ForceDraft& force, int axis, double length, const TableReading& reading,
                  FaultList& faults) {
  const double period = force.record->period(force.description.get(), axis);
  if (period <= 0.0 || divides(period, length)) return;
  reading.complain(faults, "lengths",
                   {FaultCode::box_invalid, "",
                    fmt::format("along {} the period {} of {} does not divide the length {}",
                                kAxisNames[axis], period, quoted_text(force.name), length),
                    nearest_lengths(period, length)});
}

}  // namespace

bool check_box(const BoxSettings& box, const TableReading& reading, std::optional<int> dimension,
               FaultList& faults) {
  if (!dimension) return false;
  const bool lengths = has_size(reading, "lengths", box.lengths.size(), *dimension, faults);
  const bool periodic = has_size(reading, "periodic", box.periodic.size(), *dimension, faults);
  return lengths && periodic;
}

void check_box_periods(const BoxSettings& box, const TableReading& reading,
                       const std::vector<ForceDraft>& forces, FaultList& faults) {
  for (std::size_t axis = 0; axis < box.lengths.size(); ++axis) {
    if (!box.periodic[axis]) continue;
    for (const ForceDraft& force : forces) {
      if (force.record == nullptr || !force.sound) continue;
      check_period(force, static_cast<int>(axis), box.lengths[axis], reading, faults);
    }
  }
}

}  // namespace tomlin
