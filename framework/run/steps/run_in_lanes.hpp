#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "framework/core/numbers/double_double.hpp"
#include "framework/core/system/scheme.hpp"

namespace tomlin {

struct RunContext;

/// One run of several that a batch takes steps of together (lane_batch.hpp).
class RunInLanes {
 public:
  virtual RunContext& context() = 0;
  /// Why the run takes all its steps by itself; empty: it may be in a batch.
  virtual std::string why_not() const = 0;

  /// How many steps there are before the run has to do anything itself, in whole blocks of kBlock;
  /// 0: step_alone().
  virtual std::int64_t steps_for_lanes() = 0;
  /// An adaptive step that would end at this time or later is taken by the run itself, outside of
  /// the batch.
  virtual double next_time() const = 0;
  /// One step by the run itself, or what is left of a block.
  virtual void step_alone() = 0;

  /// Steps have to be shown to watch() before count_steps(), those of a block together, from the
  /// first of them on: of a single particle on a line.
  virtual bool watches_steps() const = 0;
  virtual void watch(std::int64_t first, std::size_t count, const PointStarts<double>& starts) = 0;
  /// Counts steps that a batch has taken up to a time, with so many evaluations; the state is
  /// the one after. True where the origin has moved, and with it the state.
  virtual bool count_steps(std::int64_t steps, const DoubleDouble& time,
                           std::uint64_t evaluations) = 0;

 protected:
  ~RunInLanes() = default;
};

}  // namespace tomlin
