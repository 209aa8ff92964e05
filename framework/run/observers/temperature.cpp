#include <algorithm>

#include "framework/run/observers/kinds.hpp"

/// Temperatures of bodies, where there is a thermostat and the scheme knows velocities within its
/// steps.
namespace tomlin::observers {
namespace {

const ResultQuantity kTemperature{
    "temperature", dimension::temperature, Shape::number, Scope::window,
    "twice the mean kinetic energy, by the number of coordinates that move, from the velocities in "
    "the middle of steps, which `baoab` and `gjf` know; of runs with a thermostat above 0; in "
    "reduced units an energy. Drift counts as heat"};

class Temperature : public RunObserver {
 public:
  explicit Temperature(const ObserverParts& parts) : parts_(parts) {}

  void results(ResultTable& table, const double*) const override {
    const SystemView<double>& view = parts_.run.model.system().view;
    std::size_t k = 0;
    for (const Model::Body& body : parts_.run.model.bodies()) {
      if (body.kinetic_rate == kNoRate) continue;
      const KineticIntegral& kinetic = view.kinetic[k++];
      const double* inverse = view.inverse_mass + kinetic.first;
      const auto free = std::count_if(inverse, inverse + kinetic.length,
                                      [](double inverse_mass) { return inverse_mass > 0.0; });
      std::optional<double> temperature;
      if (parts_.window.is_over() && free > 0) {
        temperature = 2.0 * parts_.window.gained(body.kinetic_rate) /
                      (parts_.window.length() * static_cast<double>(free));
      }
      table.body(body).add(kTemperature, temperature);
    }
  }

 private:
  ObserverParts parts_;
};

std::unique_ptr<RunObserver> make_temperature(const ObserverParts& parts) {
  if (parts.run.model.system().view.kinetic_count == 0) return nullptr;
  return std::make_unique<Temperature>(parts);
}

}  // namespace

ObserverKind temperature() {
  return {.rows = {{"bodies", {&kTemperature}}}, .make = make_temperature};
}

}  // namespace tomlin::observers
