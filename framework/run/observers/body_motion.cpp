#include "framework/core/numbers/constants.hpp"
#include "framework/run/observers/kinds.hpp"

/// Motion of bodies within the window: revolutions, rolling, mean velocity.
namespace tomlin::observers {
namespace {

const ResultQuantity kTurns{
    "turns", dimension::none, Shape::number, Scope::window,
    "revolutions, counter-clockwise positive; of a tube in space seen with z, "
    "or else y, up and the other axis to the right"};
const ResultQuantity kRolling{
    "rolling", dimension::none, Shape::number, Scope::window,
    "-R dphi/dx of a body with a closed outline, R = perimeter / (2 pi): 1 where it "
    "rolls without sliding"};
const ResultQuantity kMeanVelocity{"mean_velocity", dimension::velocity, Shape::vector,
                                   Scope::window, "displacement of the centre by time"};

class BodyMotion : public RunObserver {
 public:
  explicit BodyMotion(const ObserverParts& parts) : parts_(parts) {}

  void results(ResultTable& table, const double*) const override {
    const MeasureWindow& window = parts_.window;
    const std::size_t axes = parts_.axes();
    const std::vector<Model::Body>& bodies = parts_.run.model.bodies();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      ResultGroup& group = table.body(bodies[b]);
      std::optional<double> turns;
      std::optional<double> rolling;
      std::vector<double> mean_velocity;
      if (window.is_over()) {
        for (std::size_t d = 0; d < axes; ++d) {
          mean_velocity.push_back(static_cast<double>(window.moved(b, d)) / window.length());
        }
        if (bodies[b].rotates()) {
          turns = window.turned(b);
          const auto along = static_cast<std::size_t>(bodies[b].plane[0]);
          const auto moved = static_cast<double>(window.moved(b, along));
          if (bodies[b].rolling_radius > 0.0 && moved != 0.0) {
            rolling = bodies[b].rolling_radius * kTau * (0.0 - *turns) / moved;
          }
        }
      }
      if (axes == 2 || bodies[b].turns_in_space) {
        group.add(kTurns, turns);
        group.add(kRolling, rolling);
      }
      group.add(kMeanVelocity, axes, mean_velocity);
    }
  }

 private:
  ObserverParts parts_;
};

}  // namespace

ObserverKind body_motion() {
  return kind_of<BodyMotion>({{"bodies", {&kTurns, &kRolling, &kMeanVelocity}}});
}

}  // namespace tomlin::observers
