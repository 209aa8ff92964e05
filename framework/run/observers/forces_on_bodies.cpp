#include <algorithm>
#include <limits>
#include <utility>

#include "framework/run/observers/kinds.hpp"
#include "framework/run/observers/total_forces.hpp"

/// Mean and extremes of any force on any body over the window, at the nodes of a quadrature within
/// each step, and the force at the end.
namespace tomlin::observers {
namespace {

const ResultQuantity kMeanOnBody{"mean_force", dimension::force, Shape::vector, Scope::window,
                                 "mean of the force on all of the body"};
const ResultQuantity kMaxOnBody{"max_force", dimension::force, Shape::vector, Scope::window,
                                "largest component along each axis, of those within steps that the "
                                "mean is made of"};
const ResultQuantity kMinOnBody{"min_force", dimension::force, Shape::vector, Scope::window,
                                "smallest component along each axis"};
const ResultQuantity kFinalOnBody{"final_force", dimension::force, Shape::vector, Scope::end,
                                  "force on all of the body at the end"};

class ForcesOnBodies : public RunObserver, public NodeObserver {
 public:
  explicit ForcesOnBodies(const ObserverParts& parts)
      : parts_(parts), forces_(parts), count_(forces_.names().size() * parts.axes()) {
    for (const std::string& name : forces_.names()) {
      for (const ResultQuantity* row : {&kMeanOnBody, &kMaxOnBody, &kMinOnBody}) {
        over_window_ = over_window_ || parts.selection.wants("forces", name, row->key);
      }
    }
  }
  bool any() const { return count_ > 0; }

  ObserverFacets facets() override { return {.at_nodes = over_window_ ? this : nullptr}; }
  void declare(StateLayout& layout) const override {
    layout.add_reals("forces_on_bodies", kNumbers * count_);
  }
  void attach(RunState& state) override { numbers_ = state.reals("forces_on_bodies"); }
  void start() override { next_window(); }
  void next_window() override {
    constexpr double kNone = std::numeric_limits<double>::max();
    for (std::size_t k = 0; k < count_; ++k) {
      double* const numbers = numbers_ + kNumbers * k;
      numbers[kSum] = numbers[kSum + 1] = 0.0;
      numbers[kMost] = -kNone;
      numbers[kLeast] = kNone;
    }
  }

  void node(const RunMoment& moment, double weight) override {
    forces_.evaluate(moment, [&](std::size_t k, std::size_t axis, double force) {
      double* const numbers = numbers_ + kNumbers * (k * parts_.axes() + axis);
      add_to(numbers + kSum, weight * force);
      numbers[kMost] = std::max(numbers[kMost], force);
      numbers[kLeast] = std::min(numbers[kLeast], force);
    });
  }

  void stopped(const RunMoment& end) override {
    final_.assign(count_, 0.0);
    forces_.evaluate(end, [this](std::size_t k, std::size_t axis, double force) {
      final_[k * parts_.axes() + axis] = force;
    });
  }

  void results(ResultTable& table, const double*) const override {
    const MeasureWindow& window = parts_.window;
    for (std::size_t k = 0; k < forces_.names().size(); ++k) {
      std::vector<double> mean;
      std::vector<double> most;
      std::vector<double> least;
      std::vector<double> last;
      for (std::size_t d = 0; !final_.empty() && d < parts_.axes(); ++d) {
        last.push_back(final_[k * parts_.axes() + d]);
      }
      for (std::size_t d = 0; over_window_ && window.is_over() && d < parts_.axes(); ++d) {
        const double* const numbers = numbers_ + kNumbers * (k * parts_.axes() + d);
        mean.push_back(numbers[kSum] / window.length());
        most.push_back(numbers[kMost]);
        least.push_back(numbers[kLeast]);
      }
      ResultGroup& group = table.group("forces", forces_.names()[k]);
      group.add(kMeanOnBody, parts_.axes(), mean);
      group.add(kMaxOnBody, parts_.axes(), most);
      group.add(kMinOnBody, parts_.axes(), least);
      group.add(kFinalOnBody, parts_.axes(), last);
    }
  }

 private:
  /// Numbers by force, body and axis: the integral, high and low part, and the extremes.
  enum { kSum, kMost = 2, kLeast, kNumbers };

  ObserverParts parts_;
  TotalForces forces_;
  std::size_t count_;
  bool over_window_ = false;
  std::vector<double> final_;  ///< [force and body][axis], once the run has stopped
  double* numbers_ = nullptr;
};

std::unique_ptr<RunObserver> make_forces_on_bodies(const ObserverParts& parts) {
  if (parts.selection.is_all()) return nullptr;
  auto forces = std::make_unique<ForcesOnBodies>(parts);
  if (!forces->any()) return nullptr;
  return forces;
}

}  // namespace

ObserverKind forces_on_bodies() {
  return {.rows = {{"forces", {&kMeanOnBody, &kMaxOnBody, &kMinOnBody, &kFinalOnBody}}},
          .make = make_forces_on_bodies};
}

}  // namespace tomlin::observers
