#include <algorithm>

#include "framework/run/observers/kinds.hpp"

/// Bonds keep the images with which they start in a periodic box, however long they become. Their
/// lengths are looked at now and then, at times that do not depend on where a run was stopped.
namespace tomlin::observers {
namespace {

class LongBonds : public RunObserver, public BatchObserver {
 public:
  explicit LongBonds(const ObserverParts& parts)
      : parts_(parts), rates_(parts.run.model.system().view.rates + 2 * kGroup) {}

  ObserverFacets facets() override { return {.at_batch_ends = this}; }
  void declare(StateLayout& layout) const override {
    layout.add_integers("long_bonds", parts_.run.model.forces().size());
  }
  void attach(RunState& state) override { long_ = state.integers("long_bonds"); }

  void edge(const RunMoment& moment) override {
    look(stage_of(parts_.run.model.system().view, moment.position, moment.velocity,
                  moment.integrals, moment.rates, moment.elapsed));
  }

  /// Particles of rigid bodies are placed first.
  void batch_ended() override {
    Model& model = parts_.run.model;
    const SystemView<double>& view = model.system().view;
    model.evaluate_at(parts_.run.clock.now(), view.position, view.velocity, view.integrals,
                      rates_.data());
    look(stage_of(view, view.position, view.velocity, view.integrals, rates_.data(), 0.0));
  }

  void stopped(const RunMoment&) override {
    const std::vector<Model::Force>& forces = parts_.run.model.forces();
    for (std::size_t k = 0; k < forces.size(); ++k) {
      if (long_[k] == 0) continue;
      parts_.run.outcome.warnings.push_back(
          {FaultCode::run_bond_beyond_half_box,
           forces[k].name +
               ": a bond became as long as half the box or longer: it stays with the image of its "
               "particle with which it started, though another is nearer by then; a potential "
               "between whatever is near is a formula of r",
           "force." + forces[k].name});
    }
  }

 private:
  void look(const Stage<double>& stage) {
    const std::vector<Model::Force>& forces = parts_.run.model.forces();
    for (std::size_t k = 0; k < forces.size(); ++k) {
      if (long_[k] != 0) continue;
      long_[k] = forces[k].diagnosis->bond_beyond_half_box(stage).empty() ? 0 : 1;
    }
  }

  ObserverParts parts_;
  AlignedVector<double> rates_;   // aligned: kernels read them
  std::int64_t* long_ = nullptr;  ///< [force]
};

/// Only a scene with a periodic side has images.
std::unique_ptr<RunObserver> make_long_bonds(const ObserverParts& parts) {
  const auto& box = parts.run.model.plan().box;
  if (std::none_of(box.begin(), box.end(), [](double length) { return length > 0.0; })) {
    return nullptr;
  }
  return std::make_unique<LongBonds>(parts);
}

}  // namespace

ObserverKind long_bonds() { return {.rows = {}, .make = make_long_bonds}; }

}  // namespace tomlin::observers
