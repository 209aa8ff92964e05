#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "framework/core/system/aligned.hpp"
#include "framework/run/steps/stepping.hpp"

namespace tomlin {

/// Steps of equal length. Most have nothing to be served between them: they are taken in blocks.
class FixedGrid : public Stepping {
 public:
  explicit FixedGrid(StepParts parts);
  void advance(std::uint64_t most) override;
  std::int64_t steps_for_lanes() override;
  void count_steps(std::int64_t steps, const DoubleDouble& time) override;
  void state_changed() override {
    plain_left_ = 0;
    on_grid_ = false;
  }

 protected:
  void look(const DoubleDouble&, const DoubleDouble&) override {
    parts_.observation.end_step();
    parts_.observation.end_block();
  }
  double anchor_next() override { return run_.since_anchor(); }

 private:
  DoubleDouble into_step();
  void take_one(const Step& step);
  DoubleDouble end_of_step() const;
  std::int64_t plain_steps();
  std::int64_t blocks_before(double time) const;
  void take_block(std::int64_t most);
  std::int64_t point_block(std::int64_t most, StepFault& fault);
  void sample_within_block(std::int64_t grid, std::int64_t taken);
  void sample_end_of_block();
  std::int64_t plain_block(std::int64_t most, StepFault& fault);

  bool on_grid_ = false;            ///< known to be between two steps of the grid
  std::int64_t plain_left_ = 0;     ///< steps known to have nothing to serve
  bool samples_each_step_ = false;  ///< each of them ends on a sample
  AlignedVector<double> point_rates_;
  AlignedVector<double> point_positions_;
  AlignedVector<double> point_velocities_;
  PointStarts<double> starts_;  ///< these
};

}  // namespace tomlin
