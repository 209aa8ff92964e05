#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "framework/core/system/aligned.hpp"
#include "framework/core/system/state_layout.hpp"
#include "framework/model/model.hpp"
#include "framework/scene/scene.hpp"

namespace tomlin {

/// The scheme without what it asks of forces: friction that it takes as an operator is a force here
/// like any other.
IntegratorRecord without_demands(IntegratorRecord scheme);
/// The scene with these forces, active at all times, to be looked at: dynamics, scheme and number
/// type are matters of the run, not of forces. The scheme has to last as long.
std::shared_ptr<const Scene> with_forces(const Scene& scene, std::vector<SceneForce> forces,
                                         const IntegratorRecord& scheme);

/// One force of a scene, bound to the scene's bodies as if it were the only one: what it does can
/// be looked at without the others. Positions start as the scene does and may be changed.
class SingleForce {
 public:
  /// `force` counts in Scene::forces. Throws InputError as binding the scene does.
  SingleForce(const Scene& scene, std::size_t force);

  /// False when the model leaves the force out; there is nothing to evaluate then.
  bool built() const { return !model_.forces().empty(); }
  Model& model() { return model_; }
  const Model& model() const { return model_; }
  const Model::Force& force() const { return model_.forces().front(); }

  /// A coordinate that may move.
  struct Variable {
    std::size_t at = 0;    ///< where it stands among the model's coordinates
    std::size_t body = 0;  ///< index into the model's bodies
    int axis = 0;          ///< -1: a rigid body's rotation
    double unit = 1.0;     ///< how far it goes when the body's edge goes a unit of length
  };
  const std::vector<Variable>& variables() const { return variables_; }

  double& position(const Variable& variable) { return position_[variable.at]; }
  double& velocity(const Variable& variable) { return velocity_[variable.at]; }
  /// Variables of its own.
  double* own() { return state_.reals("integrals"); }
  std::size_t own_count() const { return model_.system().view.own_count; }
  void restart();

  /// Generalised forces at the present positions and velocities; they last until the next call.
  /// Work is the sum of force times displacement over the variables.
  const double* forces(double time);
  /// After forces(): of its own variables, then what a driver reports.
  const double* rates() const { return rates_.data(); }
  double energy(double time);

  /// Total force and torque on a body.
  struct Wrench {
    std::array<double, 3> force{};
    std::array<double, 3> torque{};  ///< about the origin of the positions
  };
  /// After forces().
  Wrench wrench(std::size_t body);

 private:
  void list_variables();

  IntegratorRecord scheme_;
  Model model_;
  RunState state_;
  std::vector<Variable> variables_;
  AlignedVector<double> position_;
  AlignedVector<double> velocity_;
  AlignedVector<double> rates_;
  std::vector<double> start_of_own_;
};

}  // namespace tomlin
