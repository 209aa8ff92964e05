#pragma once

#include <vector>

#include "framework/core/numbers/double_double.hpp"

namespace tomlin {

/// Further interface of forces whose support can start elsewhere than the description says: where
/// the support of another run's driver has come to.
class PulledEnd {
 public:
  virtual ~PulledEnd() = default;
  /// From where the description starts it, along each axis, at a time that is no earlier than its
  /// last change of velocity.
  virtual std::vector<DoubleDouble> travelled(const DoubleDouble& time) const = 0;
  /// At time 0 it has travelled so far already. Before start_control().
  virtual void begin_at(const std::vector<DoubleDouble>& travel) = 0;
  /// It rests where it starts until set_out(). Before its control is laid out.
  virtual void rests_at_first() = 0;
  /// It moves from this time on, having travelled so far.
  virtual void set_out(const DoubleDouble& time, const std::vector<DoubleDouble>& travel) = 0;
  /// The description does not say where it starts: with the attached point.
  virtual bool starts_at_point() const = 0;
  /// There is one for each particle.
  virtual bool is_of_each_particle() const = 0;

 protected:
  PulledEnd() = default;
};

}  // namespace tomlin
