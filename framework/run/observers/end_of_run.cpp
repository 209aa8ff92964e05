#include <cmath>

#include "framework/core/numbers/constants.hpp"
#include "framework/run/observers/kinds.hpp"

/// State at the end of a run: forces of drivers, positions and velocities of bodies.
namespace tomlin::observers {
namespace {

const ResultQuantity kFinalForce{"final_force", dimension::force, Shape::vector, Scope::end,
                                 "force at the end"};
const ResultQuantity kCentre{"centre_of_mass", dimension::length, Shape::vector, Scope::end,
                             "position of the centre of mass"};
const ResultQuantity kVelocity{"velocity", dimension::velocity, Shape::vector, Scope::end,
                               "velocity of the centre of mass"};
const ResultQuantity kRotation{"rotation",
                               dimension::none,
                               Shape::number,
                               Scope::end,
                               "angle from the start, unwrapped, counter-clockwise positive",
                               "rad"};

class EndOfRun : public RunObserver {
 public:
  explicit EndOfRun(const ObserverParts& parts) : parts_(parts) {}

  void results(ResultTable& table, const double* rates) const override {
    const std::size_t axes = parts_.axes();
    for (const Model::Driver& driver : parts_.signals.drivers()) {
      const double* force = rates + driver.first_rate;
      table.driver(driver).add(kFinalForce, axes, {force, force + axes});
    }
    const Model& model = parts_.run.model;
    const SystemView<double>& view = model.system().view;
    for (std::size_t b = 0; b < model.bodies().size(); ++b) {
      const Model::Body& body = model.bodies()[b];
      ResultGroup& group = table.body(body);
      double numbers[3];
      std::vector<double> centre;
      centre.reserve(axes);
      model.centre(b, view.position, numbers);
      for (int d = 0; d < model.dimension(); ++d) {
        centre.push_back(static_cast<double>(model.placed(d, numbers[d])));
      }
      group.add(kCentre, axes, centre);
      model.centre_velocity(b, view.velocity, numbers);
      group.add(kVelocity, axes, {numbers, numbers + axes});
      if (axes != 2 && !body.turns_in_space) continue;
      std::optional<double> rotation;
      if (body.rotates()) rotation = kTau * parts_.rotations.turns_of(b, view.position);
      group.add(kRotation, rotation);
    }
  }

 private:
  ObserverParts parts_;
};

}  // namespace

ObserverKind end_of_run() {
  return kind_of<EndOfRun>(
      {{"drivers", {&kFinalForce}}, {"bodies", {&kCentre, &kVelocity, &kRotation}}});
}

}  // namespace tomlin::observers
