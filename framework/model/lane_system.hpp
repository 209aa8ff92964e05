#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "framework/core/system/aligned.hpp"
#include "framework/core/system/lanes.hpp"
#include "framework/core/system/system.hpp"
#include "framework/model/friction_kernels.hpp"
#include "framework/model/model.hpp"
#include "framework/model/travel_kernels.hpp"

namespace tomlin {

/// Models of one structure in the lanes of one system, which an integrator steps as it steps the
/// system of one model (framework/core/system/lanes.hpp). The arrays have no padding but for lanes
/// without a model, which repeat another one's numbers.
class LaneSystem {
 public:
  /// Why a model is in no lanes; empty where it is.
  static std::string why_not(const Model& model);

  /// Takes models of the structure of `first`, which outlives it. Width: lanes, multiple of kGroup.
  LaneSystem(const Model& first, std::size_t width);
  LaneSystem(const LaneSystem&) = delete;
  LaneSystem& operator=(const LaneSystem&) = delete;

  std::size_t width() const { return layout_.width; }
  const LaneLayout& layout() const { return layout_; }
  System<double>& system() { return system_; }
  bool fits(const Model& model) const;

  /// Parameters and state of a model, of which the integrator has taken so many steps.
  void put(std::size_t lane, const Model& model, std::uint64_t steps);
  // Parameters that follow from the time that forces are anchored at, in one of two ways.

  /// False where a model has to be anchored: put_timed().
  bool follows_by_kernel() const { return by_kernel_; }
  void put_timed(std::size_t lane, const Model& model);
  /// Sets the time of a lane, or of all lanes: count * unit.
  void set_time(std::size_t lane, const DoubleDouble& time);
  void set_times(const double* count, double unit);
  /// Lanes follow the times that are set.
  void follow_time();
  /// Its state.
  void get(std::size_t lane, Model& model) const;
  /// True unless it is certain that Model::rebase_if_needed() of the lane's model does nothing.
  bool may_rebase(std::size_t lane) const;

 private:
  struct Call {
    LaneArguments arguments;
    std::size_t numbers = 0;  ///< where they begin among all
    std::size_t scratch = 0;
    bool follows_time = false;
  };
  /// Numbers of all lanes that follow from times, [travel * width + lane].
  struct Travels {
    AlignedVector<double> time_high;
    AlignedVector<double> time_low;
    AlignedVector<double> velocity;
    AlignedVector<double> shift_high;
    AlignedVector<double> shift_low;
    std::vector<double*> to;
  };
  /// A coordinate that moves no less than what the origin follows: where it started and how far it
  /// may go from there, of each lane.
  struct Followed {
    std::size_t coordinate = 0;
    int axis = 0;  ///< -1: a rotation
    std::size_t body = 0;
    std::vector<double> start = {};
    std::vector<double> unit = {};
  };

  /// Friction on a body that is an operator, or noise without inertia.
  struct Friction {
    Friction(const FrictionArguments<double>& like, std::size_t width, std::size_t first,
             std::size_t rows);
    void put(std::size_t lane, const void* arguments, std::uint64_t steps);

    FrictionLanes lanes;
    std::vector<const FrictionArguments<double>*> run;
    bool any_new = false;
    std::vector<unsigned char> is_new;
    std::vector<std::uint64_t> ahead;
    AlignedVector<double> keep;
    AlignedVector<double> loss;
    AlignedVector<double> spread;
    AlignedVector<double> normals;
    std::vector<std::uint64_t> next;
  };

  void map_numbers(const Model& model);
  void lay_calls();
  void lay_friction();
  double* take(std::size_t numbers);

  const Model& first_;
  LaneLayout layout_;
  LaneMap mapped_;
  /// Counts in one run's numbers: how many without padding stand before each, and before the end.
  std::vector<std::size_t> coordinates_before_;
  std::vector<std::size_t> mapped_before_;
  std::vector<std::size_t> rates_before_;
  std::vector<Call> calls_;
  std::vector<Operation<double>> operations_;
  std::deque<Friction> friction_;  ///< of flows, or of noises
  std::vector<Flow<double>> flows_;
  std::vector<Noise<double>> noises_;
  std::vector<KineticIntegral> kinetic_;
  std::vector<Followed> followed_;
  Travels travels_;
  bool by_kernel_ = true;
  const TravelTable& travel_kernels_;
  AlignedVector<double> memory_;
  std::size_t taken_ = 0;
  double* numbers_ = nullptr;
  double* inverse_mass_ = nullptr;
  double* largest_move_ = nullptr;
  double* noise_scale_ = nullptr;
  double* friction_of_noise_ = nullptr;
  System<double> system_;
};

}  // namespace tomlin
