#include <algorithm>
#include <cmath>

#include "framework/run/observers/kinds.hpp"

/// How much the force of a driver varies over the window: sqrt(<F^2> - <F>^2) per axis, from nodes
/// of a quadrature within each step. They take time: only where it is asked for.
namespace tomlin::observers {
namespace {

const ResultQuantity kForceDeviation{"force_deviation", dimension::force, Shape::vector,
                                     Scope::window,
                                     "standard deviation of the force over the window; where "
                                     "[measure] observables asks for it"};

class ForceDeviation : public RunObserver, public NodeObserver {
 public:
  explicit ForceDeviation(const ObserverParts& parts) : parts_(parts) {
    for (const Model::Driver& driver : parts.signals.drivers()) {
      if (parts.selection.wants("drivers", driver.name, kForceDeviation.key)) {
        wanted_.push_back(&driver);
      }
    }
  }
  bool any() const { return !wanted_.empty(); }

  ObserverFacets facets() override { return {.at_nodes = this}; }
  void declare(StateLayout& layout) const override { layout.add_reals(kField, count()); }
  void attach(RunState& state) override { numbers_ = state.reals(kField); }
  void next_window() override { std::fill_n(numbers_, count(), 0.0); }

  /// Weighted mean and sum of squares about it, both brought up to date by every node, so that no
  /// digits cancel: D. H. D. West, Commun. ACM 22 (1979) 532, doi:10.1145/359146.359153.
  void node(const RunMoment& moment, double weight) override {
    double& weights = numbers_[0];
    weights += weight;
    double* number = numbers_ + kWeights;
    for (const Model::Driver* driver : wanted_) {
      const double* force = moment.rates + driver->first_rate;
      for (std::size_t d = 0; d < parts_.axes(); ++d, number += kPerAxis) {
        const double from_mean = force[d] - number[kMean];
        number[kMean] += from_mean * (weight / weights);
        number[kSquares] += weight * from_mean * (force[d] - number[kMean]);
      }
    }
  }

  void results(ResultTable& table, const double*) const override {
    const double* number = numbers_ + kWeights;
    for (const Model::Driver* driver : wanted_) {
      std::vector<double> deviation;
      for (std::size_t d = 0; d < parts_.axes(); ++d, number += kPerAxis) {
        if (!parts_.window.is_over() || !(numbers_[0] > 0.0)) continue;
        deviation.push_back(std::sqrt(number[kSquares] / numbers_[0]));
      }
      table.driver(*driver).add(kForceDeviation, parts_.axes(), deviation);
    }
  }

 private:
  static constexpr const char* kField = "force_deviation";
  /// The sum of weights, then of each driver on each axis.
  enum { kWeights = 1 };
  enum { kMean, kSquares, kPerAxis };
  std::size_t count() const { return kWeights + wanted_.size() * parts_.axes() * kPerAxis; }

  ObserverParts parts_;
  std::vector<const Model::Driver*> wanted_;
  double* numbers_ = nullptr;
};

std::unique_ptr<RunObserver> make_force_deviation(const ObserverParts& parts) {
  if (parts.selection.is_all()) return nullptr;
  auto deviation = std::make_unique<ForceDeviation>(parts);
  if (!deviation->any()) return nullptr;
  return deviation;
}

}  // namespace

ObserverKind force_deviation() {
  return {.rows = {{"drivers", {&kForceDeviation}}}, .make = make_force_deviation};
}

}  // namespace tomlin::observers
