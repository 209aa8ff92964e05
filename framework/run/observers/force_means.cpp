#include <array>
#include <cmath>

#include "framework/run/guard/prescribed_inertia.hpp"
#include "framework/run/observers/kinds.hpp"
#include "framework/run/steps/run_plan.hpp"

/// Mean forces of drivers: the running integral of each force over the window, by its length; and
/// its components along the velocity of the support, at the start of the run, and across it.
namespace tomlin::observers {
namespace {

const ResultQuantity kDriverMeanForce{"mean_force", dimension::force, Shape::vector, Scope::window,
                                      "integral of the force over the window, by its length"};
const ResultQuantity kMeanForceAlong{
    "mean_force_along", dimension::force, Shape::number, Scope::window,
    "component of mean_force along the first velocity of the support, if that is steady"};
const ResultQuantity kMeanForceAcross{
    "mean_force_across", dimension::force, Shape::number, Scope::window,
    "the rest of it: in two dimensions the component 90 degrees counter-clockwise of the velocity, "
    "in three its size"};

class ForceMeans : public RunObserver {
 public:
  explicit ForceMeans(const ObserverParts& parts) : parts_(parts) {}

  void results(ResultTable& table, const double*) const override {
    for (const Model::Driver& driver : parts_.signals.drivers()) {
      const std::vector<double> mean = mean_force(driver);
      std::optional<double> along;
      std::optional<double> across;
      if (!mean.empty() && drags(*driver.drive)) {
        const std::size_t k = &driver - parts_.signals.drivers().data();
        std::array<double, 3> direction{};
        for (std::size_t d = 0; d < parts_.axes(); ++d) {
          direction[d] = parts_.signals.start_velocity(k, d) / speed_of(*driver.drive);
        }
        along = component_along(mean, direction);
        across = component_across(mean, direction, *along);
      }
      ResultGroup& group = table.driver(driver);
      group.add(kDriverMeanForce, parts_.axes(), mean);
      group.add(kMeanForceAlong, along);
      group.add(kMeanForceAcross, across);
    }
  }

 private:
  static double component_along(const std::vector<double>& force,
                                const std::array<double, 3>& direction) {
    double along = 0.0;
    for (std::size_t d = 0; d < force.size(); ++d) along += force[d] * direction[d];
    return along;
  }
  /// Nothing on a line.
  static std::optional<double> component_across(const std::vector<double>& force,
                                                const std::array<double, 3>& direction,
                                                double along) {
    if (force.size() == 1) return {};
    if (force.size() == 2) return force[1] * direction[0] - force[0] * direction[1];
    double squares = 0.0;
    for (std::size_t d = 0; d < force.size(); ++d) {
      const double rest = force[d] - along * direction[d];
      squares += rest * rest;
    }
    return std::sqrt(squares);
  }

  std::vector<double> mean_force(const Model::Driver& driver) const {
    const MeasureWindow& window = parts_.window;
    std::vector<double> mean;
    if (!window.is_over()) return mean;
    const std::vector<double> lacking = inertia_lacking_in(parts_.run.model, driver, window);
    for (std::size_t d = 0; d < parts_.axes(); ++d) {
      const auto rate = driver.first_rate + static_cast<std::ptrdiff_t>(d);
      mean.push_back((window.gained(rate) + lacking[d]) / window.length());
    }
    return mean;
  }

  ObserverParts parts_;
};

}  // namespace

ObserverKind force_means() {
  return kind_of<ForceMeans>(
      {{"drivers", {&kDriverMeanForce, &kMeanForceAlong, &kMeanForceAcross}}});
}

}  // namespace tomlin::observers
