#include "framework/run/observers/kinds.hpp"
#include "framework/run/prescribed_inertia.hpp"

/// Mean forces of drivers: the running integral of each force over the window, by its length.
namespace tomlin::observers {
namespace {

const ResultQuantity kDriverMeanForce{"mean_force", dimension::force, Shape::vector, Scope::window,
                                      "integral of the force over the window, by its length"};

class ForceMeans : public RunObserver {
 public:
  explicit ForceMeans(const ObserverParts& parts) : parts_(parts) {}

  void results(ResultTable& table, const double*) const override {
    for (const Model::Driver& driver : parts_.signals.drivers()) {
      table.driver(driver).add(kDriverMeanForce, parts_.axes(), mean_force(driver));
    }
  }

 private:
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

ObserverKind force_means() { return kind_of<ForceMeans>({{"drivers", {&kDriverMeanForce}}}); }

}  // namespace tomlin::observers
