#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/integrator.hpp"
#include "framework/core/system/state_layout.hpp"
#include "framework/core/system/system.hpp"
#include "framework/model/assembly.hpp"
#include "framework/model/elastic_bodies.hpp"
#include "framework/model/force_tangent.hpp"
#include "framework/model/observe_kernels.hpp"
#include "framework/scene/scene.hpp"

/// A scene bound: particles, coordinates, forces and the list of kernel calls that evaluates them.
namespace tomlin {

/// Follows the model's clock and origin: the same scene bound in another number type, which does
/// the stepping while the model looks on.
class ModelFollower {
 public:
  virtual ~ModelFollower() = default;
  virtual void begin_step(const DoubleDouble& time) = 0;
  /// Positions are relative to this origin from now on.
  virtual void rebase(const Origin& origin) = 0;
  /// The state follows an origin that has moved by so many cells; the model's own has done so.
  virtual void shift_by(const std::array<std::int64_t, 3>& cells) = 0;
  virtual void start(const Perturbation* noise, const FinalState* from) = 0;
  virtual void write_numbers(FinalState& state) const = 0;

 protected:
  ModelFollower() = default;
};

class Model {
 public:
  /// Binds a scene; throws InputError for faults that only show now. A team of threads shares the
  /// evaluations and outlives the model.
  explicit Model(std::shared_ptr<const Scene> scene, InstructionSet set = chosen_instruction_set(),
                 const Team* team = nullptr);
  ~Model();
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  using Body = Assembly<double>::Body;
  using Force = Assembly<double>::Force;
  using Driver = Assembly<double>::Driver;
  using LeftOut = Assembly<double>::LeftOut;

  const Scene& scene() const { return *scene_; }
  int dimension() const { return scene_->dimension; }
  /// The plan by which any number type binds the scene.
  const AssemblyPlan& plan() const { return plan_; }
  const std::vector<Body>& bodies() const { return assembly_.bodies(); }
  const std::vector<Force>& forces() const { return assembly_.forces(); }
  const std::vector<Driver>& drivers() const { return assembly_.drivers(); }
  const std::vector<LeftOut>& left_out() const { return assembly_.left_out(); }
  /// Functions that read numbers off bodies, on the instruction set of the model.
  const ObserveTable& observe() const { return observe_; }
  const Assembly<double>& assembly() const { return assembly_; }
  Assembly<double>& assembly() { return assembly_; }
  System<double>& system() { return assembly_.system(); }
  const System<double>& system() const { return assembly_.system(); }
  const Origin& origin() const { return origin_; }
  std::size_t coordinate_count() const { return system().view.coordinates; }
  void follow(ModelFollower* follower) { follower_ = follower; }

  /// Position, velocity, integrals and origin of the run.
  void declare(StateLayout& layout) const;
  /// Work on this state from now on, as it is.
  void attach(RunState& state);
  /// Fill the attached state with the scene's start, or where another run has ended, disturbed when
  /// there is noise. Throws InputError where that was of a scene that has not the same parts.
  void start(const Perturbation* noise = nullptr, const FinalState* from = nullptr);
  /// The attached state at this time, for another run to start from.
  FinalState final_state(const DoubleDouble& time) const;

  /// When a force becomes active or ceases to be, the next time; infinite: never again.
  double next_switch() const;
  /// Switches, at the attached state of this time, the forces that were to switch until `latest`.
  /// Returns their names.
  std::vector<std::string> switch_forces(const DoubleDouble& time, double latest);

  /// Move the origin when everything has moved by a cell or more. Cheap when nothing has. True when
  /// it did.
  bool rebase_if_needed();
  /// How often it did.
  std::uint64_t rebases() const { return rebases_; }
  /// The orientations that rotors' coordinates are relative to follow the bodies; coordinates and
  /// velocities change with them. Cheap when nothing has turned far. True where one did.
  bool reorient_if_needed();
  bool has_rotors() const { return assembly_.rotor_count() > 0; }

  /// Stages count their time from here on.
  void anchor(const DoubleDouble& time) { begin_step(this, time.hi, time.lo); }
  const DoubleDouble& anchor_time() const { return anchor_; }

  /// Evaluate all forces at a state (not counted among the run's evaluations). Leaves generalised
  /// forces in system().view.force (without inertia: those of rigid bodies as velocities) and rates
  /// in `rates`.
  void evaluate_at(const DoubleDouble& time, const double* position, const double* velocity,
                   const double* integrals, double* rates);
  /// Evaluates forces for a particle alone on a line, without a loop over particles in each force,
  /// `elapsed` after the time that forces are anchored at.
  void evaluate_point(double position, double velocity, double elapsed, double* rates) const;

  /// Centre of mass of a body, relative to the origin, and its velocity; [dimension] numbers each.
  void centre(std::size_t body, const double* position, double* result) const;
  void centre_velocity(std::size_t body, const double* velocity, double* result) const;
  /// Rotation from the start in turns, within (-1/2, 1/2] for a flexible body and as the coordinate
  /// has it for a rigid one.
  double rotation(std::size_t body, const double* position) const;
  /// Positions of a body's particles in the scene's own coordinates, [particle][axis]; those of
  /// bodies whose particles follow from few coordinates are as of the last evaluation. Returns the
  /// end.
  double* place_particles(std::size_t body, const double* position, double* result) const;
  /// A position relative to the origin in the scene's own coordinates: cells added back.
  DoubleDouble placed(int axis, double offset) const { return origin_position_[axis] + offset; }

  /// Returns the position of the support of a driver in the scene's own coordinates, at a time
  /// since which its velocity has not changed.
  DoubleDouble pulled_end(std::size_t driver, const DoubleDouble& time, int axis) const;

  /// Without inertia velocities follow from forces: those at the last evaluated state.
  void drift_velocity(double* velocity) const;

  /// Kinetic and potential energy at a state; the potential energy leaves out what is held by
  /// nothing but the choice of zero, so that only differences of it count.
  double kinetic_energy(const double* position, const double* velocity) const;
  double potential_energy(const DoubleDouble& time, const double* position, const double* velocity,
                          const double* integrals);

  /// Name of the body and particle that a coordinate belongs to, for messages.
  struct CoordinateName {
    std::string body;
    std::ptrdiff_t particle = -1;  ///< -1: the body as a whole
    std::string axis;
  };
  CoordinateName name_of(std::size_t coordinate) const;

 private:
  std::vector<std::string> structure() const;
  void require_same_parts(const FinalState& from) const;
  static AssemblyPlan plan_for(const Scene& scene, InstructionSet set, const Team* team);
  void build_tangent();
  static void begin_step(void* model, double time_high, double time_low);
  void build_elastic();
  void orient();
  double rotation_of_rotor(const Body& body, const double* position) const;
  double energy_of(const Force& force, const DoubleDouble& time);
  void set_out(const Force& force, const DoubleDouble& time);
  void keep_shapes();
  void place_origin();
  Stage<double> stage(const double* position, const double* velocity, const double* integrals,
                      double* rates) const;

  std::shared_ptr<const Scene> scene_;
  AssemblyPlan plan_;
  Assembly<double> assembly_;
  std::vector<ElasticBody> elastic_;  ///< for schemes that split bonds off
  const ObserveTable& observe_;
  Origin origin_;
  std::array<DoubleDouble, 3> origin_position_;
  std::vector<AlignedVector<double>> shapes_;  ///< flexible bodies in the plane, see PlanarShape
  DoubleDouble anchor_;                        ///< the time from which stages count
  ModelFollower* follower_ = nullptr;
  std::uint64_t rebases_ = 0;
  AlignedVector<double> rates_;
  std::unique_ptr<ForceTangent> tangent_;  ///< for schemes that ask for it
  std::int64_t* cells_ = nullptr;
  std::int64_t* whole_turns_ = nullptr;
  double* orientations_ = nullptr;  ///< [rotor][4], quaternions
};

}  // namespace tomlin
