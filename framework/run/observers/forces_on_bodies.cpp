#include <algorithm>
#include <set>

#include "framework/model/force_twin.hpp"
#include "framework/run/observers/kinds.hpp"

/// The mean force of any force on any body over the window. Forces are evaluated one by one at the
/// nodes of a quadrature within each step, which takes time: only those that are asked for.
namespace tomlin::observers {
namespace {

const ResultQuantity kMeanForce{"mean_force", dimension::force, Shape::vector, Scope::window,
                                "mean of the force on all of the body"};

class ForcesOnBodies : public RunObserver {
 public:
  explicit ForcesOnBodies(const ObserverParts& parts) : parts_(parts) {
    const Model& model = parts.run.model;
    std::size_t mapped = 0;
    for (const Model::Body& body : model.bodies()) {
      const BodySlot<double>& slot = body.bound.slot;
      if (slot.mapped) mapped = std::max(mapped, slot.offset + slot.stride * parts.axes());
    }
    force_.assign(model.system().view.dofs + 2 * kGroup, 0.0);
    mapped_force_.assign(mapped + 2 * kGroup, 0.0);
    rates_.assign(model.system().view.rates + 2 * kGroup, 0.0);
    for (const Model::Force& force : model.forces()) list_bodies_of(force);
  }
  bool any() const { return !pairs_.empty(); }

  ObserverNeeds needs() const override { return {.nodes = true}; }
  void declare(StateLayout& layout) const override {
    layout.add_reals("forces_on_bodies", 2 * pairs_.size() * parts_.axes());
  }
  void attach(RunState& state) override { sums_ = state.reals("forces_on_bodies"); }
  void next_window() override { std::fill_n(sums_, 2 * pairs_.size() * parts_.axes(), 0.0); }

  void node(const RunMoment& moment, double weight) override {
    const SystemView<double>& view = parts_.run.model.system().view;
    // Where friction is an operator no force reads those of rigid bodies.
    place_velocities(parts_.run.model.bodies(), parts_.run.model.dimension(), moment.position,
                     moment.velocity, view.mapped_velocity);
    Stage<double> stage = stage_of(view, moment.position, moment.velocity, moment.integrals,
                                   rates_.data(), moment.elapsed);
    stage.force = force_.data();
    stage.mapped_force = mapped_force_.data();
    const Model::Force* last = nullptr;
    double* sum = sums_;
    for (const Pair& pair : pairs_) {
      if (pair.force != last) {
        std::fill(force_.begin(), force_.end(), 0.0);
        std::fill(mapped_force_.begin(), mapped_force_.end(), 0.0);
        for (const Pass<double>& pass : pair.passes) pass.add(pass.arguments, stage);
        last = pair.force;
      }
      for (std::size_t d = 0; d < parts_.axes(); ++d, sum += 2) {
        add_to(sum, weight * total_on(pair.body, d));
      }
    }
  }

  void results(ResultTable& table, const double*) const override {
    const MeasureWindow& window = parts_.window;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const std::string& body = parts_.run.model.bodies()[pairs_[k].body].bound.name;
      std::vector<double> mean;
      for (std::size_t d = 0; window.is_over() && d < parts_.axes(); ++d) {
        mean.push_back(sums_[2 * (k * parts_.axes() + d)] / window.length());
      }
      table.group("forces", pairs_[k].force->name + ".on." + body)
          .add(kMeanForce, parts_.axes(), mean);
    }
  }

 private:
  /// One of the pairs that are asked for, and the kernel calls of its force.
  struct Pair {
    const Model::Force* force = nullptr;
    std::size_t body = 0;
    std::vector<Pass<double>> passes;
  };

  void list_bodies_of(const Model::Force& force) {
    const std::vector<Pass<double>> passes = force.bound->passes();
    std::set<std::size_t> bodies;
    for (const Pass<double>& pass : passes) {
      for (const Region& region : pass.writes) bodies.insert(region.body);
    }
    for (const std::size_t body : bodies) {
      const std::string name = force.name + ".on." + parts_.run.model.bodies()[body].bound.name;
      if (!parts_.selection.wants("forces", name, kMeanForce.key)) continue;
      pairs_.push_back({&force, body, passes});
    }
  }

  /// Particles' shares, and what acts on a rigid body's centre.
  double total_on(std::size_t body, std::size_t axis) const {
    const BodySlot<double>& slot = parts_.run.model.bodies()[body].bound.slot;
    const AlignedVector<double>& forces = slot.mapped ? mapped_force_ : force_;
    const double* first = forces.data() + slot.offset + axis * slot.stride;
    double total = slot.rigid ? force_[slot.centre + axis] : 0.0;
    for (std::size_t i = 0; i < slot.count; ++i) total += first[i];
    return total;
  }

  ObserverParts parts_;
  std::vector<Pair> pairs_;
  AlignedVector<double> force_;  // aligned: kernels write them
  AlignedVector<double> mapped_force_;
  AlignedVector<double> rates_;
  double* sums_ = nullptr;  ///< [pair][axis]: high and low part
};

std::unique_ptr<RunObserver> make_forces_on_bodies(const ObserverParts& parts) {
  if (parts.selection.is_all()) return nullptr;
  auto forces = std::make_unique<ForcesOnBodies>(parts);
  if (!forces->any()) return nullptr;
  return forces;
}

}  // namespace

ObserverKind forces_on_bodies() {
  return {.rows = {{"forces", {&kMeanForce}}}, .make = make_forces_on_bodies};
}

}  // namespace tomlin::observers
