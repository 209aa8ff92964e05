#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "framework/core/bound_force.hpp"
#include "framework/core/integrator.hpp"
#include "framework/core/state_layout.hpp"
#include "framework/core/system.hpp"
#include "framework/scene/scene.hpp"

/// A scene bound: particles, coordinates, forces and the list of kernel calls that evaluates them.
namespace tomlin {

class Model {
 public:
  /// Binds a scene; throws InputError for faults that only show now.
  explicit Model(std::shared_ptr<const Scene> scene, InstructionSet set = chosen_instruction_set());
  ~Model();
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  struct Body {
    BoundBody<double> bound;
    double rolling_radius = 0.0;
    double total_mass = 0.0;
    double inertia = 0.0;                   ///< about the centre, planar rigid bodies
    std::vector<std::vector<double>> arms;  ///< [count][dimension] at the start, about the centre
    bool rotates() const { return arms.size() > 1 && arms.front().size() == 2; }
  };

  struct Force {
    std::string name;
    const ForceRecord* record = nullptr;
    std::unique_ptr<BoundForce<double>> bound;
    std::vector<std::size_t> bodies;
    std::ptrdiff_t first_rate = -1;  ///< where its force and power stand among the integrals
  };

  /// A force of the scene that was not built, and why.
  struct LeftOut {
    std::string force;
    std::string why;
  };

  const Scene& scene() const { return *scene_; }
  int dimension() const { return scene_->dimension; }
  const std::vector<Body>& bodies() const { return bodies_; }
  const std::vector<Force>& forces() const { return forces_; }
  const std::vector<LeftOut>& left_out() const { return left_out_; }
  System<double>& system() { return system_; }
  const Origin& origin() const { return origin_; }
  std::size_t coordinate_count() const { return system_.view.coordinates; }

  /// Position, velocity, integrals and origin of the run.
  void declare(StateLayout& layout) const;
  /// Work on this state from now on, as it is.
  void attach(RunState& state);
  /// Fill the attached state with the scene's start.
  void start();

  /// Move the origin when everything has moved by a cell or more. Cheap when nothing has. True when
  /// it did.
  bool rebase_if_due();

  /// Stages count their time from here on.
  void anchor(const DoubleDouble& time) { begin_step(this, time.hi, time.lo); }
  const DoubleDouble& anchor_time() const { return anchor_; }

  /// Evaluate all forces at a state (not counted among the run's evaluations). Leaves generalised
  /// forces in system().view.force and rates in `rates`.
  void evaluate_at(const DoubleDouble& time, const double* position, const double* velocity,
                   const double* integrals, double* rates);

  /// Centre of mass of a body, relative to the origin, and its velocity; [dimension] numbers each.
  void centre(std::size_t body, const double* position, double* result) const;
  void centre_velocity(std::size_t body, const double* velocity, double* result) const;
  /// Rotation from the start in turns, within (-1/2, 1/2] for a flexible body and as the coordinate
  /// has it for a rigid one.
  double rotation(std::size_t body, const double* position) const;
  /// A place relative to the origin in the scene's own coordinates: cells added back.
  DoubleDouble placed(int axis, double offset) const;

  /// Kinetic and potential energy at a state.
  double kinetic_energy(const double* velocity) const;
  double potential_energy(const DoubleDouble& time, const double* position, const double* velocity,
                          const double* integrals);

  /// Bounds on the fastest motion about the start: angular frequency and damping rate.
  struct Stiffness {
    double frequency = 0.0;
    double damping_rate = 0.0;
  };
  Stiffness stiffness();
  /// Name of the force with the largest share in it.
  std::string stiffest_force();

  /// The largest fixed step that this scheme is stable with; infinite when nothing limits it.
  double stable_step(const IntegratorRecord& scheme);

  /// Name of the body and particle that a coordinate belongs to, for messages.
  struct CoordinateName {
    std::string body;
    std::ptrdiff_t particle = -1;  ///< -1: the body as a whole
    std::string axis;
  };
  CoordinateName name_of(std::size_t coordinate) const;

 private:
  void choose_origin();
  void place_bodies();
  void bind_forces();
  void order_operations();
  static void begin_step(void* model, double time_high, double time_low);
  void place_fixed();
  double share_of_stiffness(const Force& force, const Stage<double>& here);
  Stage<double> stage(const double* position, const double* velocity, const double* integrals,
                      double* rates);

  std::shared_ptr<const Scene> scene_;
  InstructionSet set_;
  Origin origin_;
  std::vector<BodyGeometry> geometry_;
  std::vector<Body> bodies_;
  std::vector<Force> forces_;
  std::vector<LeftOut> left_out_;
  std::vector<BoundForce<double>*> timed_;

  System<double> system_;
  std::vector<Operation<double>> operations_;
  struct Storage;
  std::unique_ptr<Storage> storage_;
  std::array<std::int64_t, 3> first_cells_{};  ///< of the origin at time 0
  DoubleDouble anchor_;                        ///< the time from which stages count
  std::int64_t* cells_ = nullptr;
  std::int64_t* whole_turns_ = nullptr;
};

}  // namespace tomlin
