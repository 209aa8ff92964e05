#include "framework/scene/box_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

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

/// Two bonds: a body that is meant to end within the box leaves more room to its image, and layers
/// of a stack are farther apart.
constexpr double kLeastBondsToImage = 2.0;

/// A body that lists its neighbours, as those of a lattice do.
class LatticeBody {
 public:
  LatticeBody(const BodyDraft& body, int dimension)
      : body_(body), shape_(body.record->build(body.description.get(), dimension)) {
    const std::vector<IndexPair> pairs = neighbours({});
    pairs_ = pairs.size();
    for (const auto& [i, j] : pairs) {
      double squares = 0.0;
      for (std::size_t d = 0; d < shape_.anchor.size(); ++d) {
        squares += std::pow(position(i, d) - position(j, d), 2);
      }
      longest_bond_ = std::max(longest_bond_, std::sqrt(squares));
    }
  }

  /// Whether a box of this length along an axis cuts it.
  bool is_cut_by(double length, std::size_t axis) const {
    double low = 0.0;
    double high = 0.0;
    for (const std::vector<double>& x : shape_.relative) {
      low = std::min(low, x[axis]);
      high = std::max(high, x[axis]);
    }
    if (!(length - (high - low) < kLeastBondsToImage * longest_bond_)) return false;
    std::array<double, 3> along{};
    along[axis] = length;
    return neighbours(along).size() == pairs_;
  }

 private:
  std::vector<IndexPair> neighbours(const std::array<double, 3>& box) const {
    return body_.record->neighbours(body_.description.get(), box);
  }
  double position(std::int64_t i, std::size_t axis) const {
    return shape_.relative[static_cast<std::size_t>(i)][axis];
  }

  const BodyDraft& body_;
  BodyGeometry shape_;
  std::size_t pairs_ = 0;  ///< of neighbours without a box
  double longest_bond_ = 0.0;
};

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
      if (force.record == nullptr || !force.valid) continue;
      check_period(force, static_cast<int>(axis), box.lengths[axis], reading, faults);
    }
  }
}

void check_box_bodies(const BoxSettings& box, const TableReading& reading,
                      const std::vector<BodyDraft>& bodies, int dimension, FaultList& faults) {
  if (std::find(box.periodic.begin(), box.periodic.end(), true) == box.periodic.end()) return;
  for (const BodyDraft& body : bodies) {
    if (body.record == nullptr || !body.valid || !body.count) continue;
    if (body.record->neighbours == nullptr) continue;
    const LatticeBody lattice(body, dimension);
    for (std::size_t axis = 0; axis < box.lengths.size(); ++axis) {
      if (!box.periodic[axis] || !lattice.is_cut_by(box.lengths[axis], axis)) continue;
      reading.complain(
          faults, "lengths",
          {FaultCode::box_invalid, "",
           fmt::format("along {} the length {} cuts {}: its bonds through the side of the box "
                       "would not be those within it",
                       kAxisNames[axis], box.lengths[axis], quoted_text(body.name)),
           fmt::format("the length that continues the body ({}), or one with room about it",
                       body.record->note(body.description.get()))});
    }
  }
}

}  // namespace tomlin
