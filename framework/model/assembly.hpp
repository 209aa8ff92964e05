#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "framework/core/bound_force.hpp"
#include "framework/core/force.hpp"
#include "framework/core/state_layout.hpp"
#include "framework/core/system.hpp"
#include "framework/model/friction_kernels.hpp"
#include "framework/model/rigid_kernels.hpp"
#include "framework/scene/scene.hpp"

/// A scene bound in one number type: particles, coordinates, forces, and the list of kernel calls
/// that evaluates them. What can be read off it is the model's business (model.hpp).
namespace tomlin {

/// Noise on the start, for seeing whether a result is determined.
struct Perturbation {
  std::vector<std::size_t> bodies;
  double size = 0.0;
  std::uint64_t seed = 0;
  std::uint64_t stream = 0;
};

/// What the model decides for a scene before it is bound.
struct AssemblyPlan {
  const Scene* scene = nullptr;
  std::vector<BodyGeometry> geometry;
  Origin origin;                ///< at time 0
  std::array<double, 3> box{};  ///< length of each periodic axis, else 0
  InstructionSet set = InstructionSet::baseline;
  bool inertial = true;
  bool splits_friction = false;
  bool quasistatic = false;  ///< no friction acts, on nothing
  bool ledger = false;
  bool backwards = false;  ///< kernels in the opposite order: another sums the same, to rounding
};

/// Index of the rotation among a planar body's coordinates.
inline constexpr std::size_t kRotation = 2;

template <class Real>
class Assembly {
 public:
  /// Throws InputError for faults that only show now.
  explicit Assembly(const AssemblyPlan& plan);
  Assembly(const Assembly&) = delete;
  Assembly& operator=(const Assembly&) = delete;

  struct Body {
    BoundBody<Real> bound;
    double rolling_radius = 0.0;
    double total_mass = 0.0;
    double inertia = 0.0;                   ///< about the centre, planar bodies
    std::vector<std::vector<double>> arms;  ///< [count][dimension] at the start, about the centre
    std::array<bool, 3> held{};             ///< axes along which nothing moves
    bool rotation_held = false;
    // Of a rigid body: its inverse mass and inertia, or without inertia its inverse friction; zero
    // where held.
    std::array<double, 3> response{};
    double response_of_rotation = 0.0;
    /// From the centre to the point about which these responses are independent of each other: the
    /// centre of friction without inertia.
    std::array<double, 2> pivot{};
    const Motion* motion = nullptr;  ///< of a prescribed body
    std::size_t steering = 0;        ///< which of the steered bodies it is

    bool rotates() const { return arms.size() > 1 && arms.front().size() == 2; }
    bool moves_as_one() const { return bound.slot.rigid; }
    bool prescribed() const { return motion != nullptr; }
  };

  struct Force {
    std::string name;
    const ForceRecord* record = nullptr;
    Traits traits;  ///< its claims, as the scene describes it
    std::unique_ptr<BoundForce<Real>> bound;
    std::vector<std::size_t> bodies;
    std::ptrdiff_t first_rate = kNoRate;  ///< where its force and power stand among the rates
    std::ptrdiff_t heat_rate = kNoRate;   ///< where its heat stands, with the ledger
    bool is_operator = false;             ///< friction that is not evaluated as a force
  };

  /// What does work on the scene: a force with a pulled end, or a prescribed body.
  struct Driver {
    std::string name;
    std::ptrdiff_t first_rate = kNoRate;
    const Drive* drive = nullptr;
  };

  /// A force of the scene that was not built, and why.
  struct LeftOut {
    std::string force;
    std::string why;
  };

  const Scene& scene() const { return *plan_.scene; }
  int dimension() const { return plan_.scene->dimension; }
  const std::vector<Body>& bodies() const { return bodies_; }
  const std::vector<Force>& forces() const { return forces_; }
  const std::vector<Driver>& drivers() const { return drivers_; }
  const std::vector<LeftOut>& left_out() const { return left_out_; }
  System<Real>& system() { return system_; }
  const System<Real>& system() const { return system_; }
  /// Where all friction operators' heat stands among the rates, with the ledger.
  std::ptrdiff_t friction_rate() const { return friction_rate_; }

  /// Fill these with the scene's start; cells of the origin stay as they are.
  void start(Real* position, Real* velocity, Real* integrals, const Perturbation* noise);
  /// What events change of the forces stands in the run's state.
  void declare_controls(StateLayout& layout) const;
  void attach_controls(RunState& state);
  void start_controls();
  /// Stages count their time from here on.
  void begin_step(const DoubleDouble& time);
  /// The origin has moved; positions in the state are the caller's to shift.
  void rebase(const Origin& origin);

  /// Write no numbers where the next evaluation has to write forces, so that a kernel that adds to
  /// what it should set shows.
  void spoil_forces();

  /// How far a prescribed body has come since the start along an axis, at the anchor.
  double travel_of(const Body& body, int axis) const;
  /// Its rotation in turns at the last evaluation.
  double turns_of(const Body& body) const;
  /// Its velocity along an axis at the last evaluation.
  double speed_of(const Body& body, int axis) const;
  /// Own variables that hold the way of prescribed bodies whose motion changes with time.
  struct Steered {
    std::size_t body = 0;
    std::ptrdiff_t own[4] = {-1, -1, -1, -1};  ///< x, y, z, turns
  };
  const std::deque<Steered>& steered() const { return steered_; }

 private:
  /// Where a prescribed body is: its way since the start from the time alone, or from its own
  /// variables.
  struct Steering {
    const Motion* motion = nullptr;
    int axes = 0;
    bool planar = false;
    Real start[3] = {};   ///< of the centre, relative to the present origin
    Real speed[4] = {};   ///< x, y, z, turns: where they do not change
    Real travel[4] = {};  ///< since the start, at the anchor
    std::ptrdiff_t own[4] = {-1, -1, -1, -1};
    DoubleDouble anchor;
    Real coordinates[3] = {};  ///< as a rigid body's: in the plane x, y, turns
    Real speeds[3] = {};

    const TimeFunction& function(int k) const {
      return k < 3 ? motion->velocity[k] : motion->angular_velocity;
    }
  };

  void size_bodies();
  void place_bodies();
  void lay_coordinates();
  void bind_forces();
  void lay_rates();
  void bound_moves();
  void lay_friction();
  void order_operations();
  void add_point_forces(const std::vector<Pass<Real>>& passes);
  void place_fixed();
  bool takes_as_operator(const Force& force) const;
  static void steer(const void* arguments, const Stage<Real>& stage);
  static void heat_of_drift(const void* arguments, const Stage<Real>& stage);
  /// Numbers in the arrays of forces that one evaluation writes.
  struct Written {
    bool mapped = false;
    std::size_t offset = 0;
    std::size_t length = 0;
  };
  void list_written(std::size_t body, bool centre);
  static void spoil(const void* written, const Stage<Real>& stage);

  AssemblyPlan plan_;
  Origin origin_;
  std::vector<Body> bodies_;
  std::vector<Force> forces_;
  std::vector<Driver> drivers_;
  std::vector<LeftOut> left_out_;
  std::vector<BoundForce<Real>*> timed_;
  System<Real> system_;
  std::vector<Operation<Real>> operations_;
  std::ptrdiff_t friction_rate_ = kNoRate;

  // Kernels hold pointers into what follows, so none is resized after binding.
  std::size_t dofs_ = 0;
  std::size_t mapped_size_ = 0;
  std::size_t own_count_ = 0;
  std::deque<AlignedVector<Real>> share_;      ///< mass fractions, one array a body
  std::deque<AlignedVector<Real>> reference_;  ///< of bodies that move as one
  std::deque<AlignedVector<Real>> arms_;
  std::deque<RigidArguments<Real>> rigid_;
  std::vector<std::size_t> rigid_body_;  ///< whose each of them is
  std::deque<Steering> steering_;
  std::deque<Steered> steered_;
  std::deque<Drive> prescribed_drives_;
  std::deque<FrictionArguments<Real>> friction_;
  std::deque<AlignedVector<Real>> friction_arrays_;
  std::vector<FrictionOperator<Real>> friction_operators_;
  DriftHeatArguments<Real> drift_heat_;
  /// Heats of forces in a scene without inertia.
  struct Drifted {
    std::vector<Operation<Real>> places;  ///< of bodies that move as one
    std::vector<Operation<Real>> heats;
    mutable AlignedVector<Real> velocity;
    const Real* mobility = nullptr;
    std::size_t dofs = 0;
  };
  Drifted drifted_;
  AlignedVector<Real> heat_of_bodies_;
  AlignedVector<Real> mobility_;
  std::vector<std::shared_ptr<void>> zeros_;
  std::vector<Written> written_;
  std::vector<PointForce<Real>> point_forces_;
  AlignedVector<Real> inverse_mass_;
  AlignedVector<Real> largest_move_;
  AlignedVector<Real> tolerance_scale_;
  AlignedVector<Real> force_;
  AlignedVector<Real> mapped_position_;
  AlignedVector<Real> mapped_velocity_;
  AlignedVector<Real> mapped_force_;
};

extern template class Assembly<double>;
extern template class Assembly<float>;
extern template class Assembly<Quad>;

}  // namespace tomlin
