#include <optional>

#include <fmt/format.h>

#include "framework/run/observers/kinds.hpp"

namespace tomlin::observers {
namespace {

const ResultQuantity kEnergy{"energy", dimension::energy, Shape::number, Scope::end,
                             "potential energy, but for a constant"};
const ResultQuantity kNeutralDirections{"neutral_directions", dimension::none, Shape::count,
                                        Scope::end, "zero modes: unconstrained directions"};
const ResultQuantity kSmallestCurvature{
    "smallest_curvature", dimension::stiffness, Shape::number, Scope::end,
    "smallest second derivative of the energy along a direction that is held"};
const ResultQuantity kLogDeterminant{"log_determinant", dimension::none, Shape::number, Scope::end,
                                     "ln |det| of the energy's second derivatives"};

/// "chain, particle 3, x".
std::string where(const Model& model, std::size_t coordinate) {
  const Model::CoordinateName name = model.name_of(coordinate);
  const std::string particle = name.particle < 0 ? "" : fmt::format(", particle {}", name.particle);
  return fmt::format("{}{}, {}", name.body, particle, name.axis);
}

/// The equilibrium that a run ends in.
struct FoundEquilibrium {
  double energy = 0.0;                       ///< potential; but for what the choice of zero holds
  double neutral_directions = 0.0;           ///< zero modes
  std::optional<double> smallest_curvature;  ///< of the energy, along what is not neutral
  std::optional<double> log_determinant;     ///< ln |det| of the energy's second derivatives
};

/// The equilibria of a quasistatic run: ties, where nothing but rounding decides which one follows,
/// and the equilibrium that it ends in.
class Equilibrium : public RunObserver, public PathObserver {
 public:
  explicit Equilibrium(const ObserverParts& parts) : parts_(parts) {
    parts.events.expect(EventKind::tie);
  }

  ObserverFacets facets() override { return {.on_path = this}; }
  void declare(StateLayout& layout) const override { layout.add_reals("events.tie", 2); }
  void attach(RunState& state) override { first_tie_ = state.reals("events.tie"); }
  void at_equilibrium() override;
  void stopped(const RunMoment& end) override;
  void finish(const RunMoment& end) override;
  void results(ResultTable& table, const double* rates) const override;

 private:
  ObserverParts parts_;
  double* first_tie_ = nullptr;  ///< time and coordinate
  std::optional<FoundEquilibrium> found_;
};

/// Whether it was a tie.
void Equilibrium::at_equilibrium() {
  const std::optional<std::size_t> coordinate = parts_.run.path->tied();
  if (!coordinate) return;
  const double time = parts_.run.clock.time();
  if (parts_.events.count(EventKind::tie) == 0) {
    first_tie_[0] = time;
    first_tie_[1] = static_cast<double>(*coordinate);
  }
  Event event = event_of_kind(EventKind::tie);
  event.time = time;
  event.duration = 0.0;
  const std::string name = parts_.run.model.name_of(*coordinate).body;
  for (const Model::Body& body : parts_.run.model.bodies()) {
    if (body.bound.name == name) parts_.events.record(event, body.bound.name);
  }
}

/// Reads off the equilibrium that the run ends in, which is no part of the run's cost.
void Equilibrium::stopped(const RunMoment&) {
  RunContext& run = parts_.run;
  if (run.outcome.failure) return;
  System<double>& system = run.model.system();
  const std::uint64_t evaluations = system.evaluations;
  const std::uint64_t columns = system.columns;
  run.model.anchor(run.clock.now());
  const EquilibriumState state = run.path->state(0.0);
  system.evaluations = evaluations;
  system.columns = columns;
  FoundEquilibrium& found = found_.emplace(FoundEquilibrium{});
  const SystemView<double>& view = system.view;
  found.energy =
      run.model.potential_energy(run.clock.now(), view.position, view.velocity, view.integrals);
  found.neutral_directions = static_cast<double>(state.neutral);
  if (state.neutral < view.coordinates) found.smallest_curvature = state.softest;
  if (state.neutral == 0) found.log_determinant = state.log_determinant;
  for (const std::size_t coordinate : state.neutral_at) {
    run.outcome.warnings.push_back(
        {FaultCode::run_zero_mode,
         fmt::format("the equilibrium has a zero mode, in which {} moves most: it stays at its "
                     "position along it",
                     where(run.model, coordinate)),
         "bodies." + run.model.name_of(coordinate).body});
  }
}

void Equilibrium::finish(const RunMoment&) {
  const std::int64_t ties = parts_.events.count(EventKind::tie);
  if (ties == 0) return;
  RunContext& run = parts_.run;
  const std::string times = ties == 1 ? "" : fmt::format(", the first of {} ties", ties);
  const auto coordinate = static_cast<std::size_t>(first_tie_[1]);
  run.outcome.warnings.push_back(
      {FaultCode::run_tie,
       fmt::format("not determined after time {:.6g}{}: there the scene is symmetric and its "
                   "equilibrium unstable, so that rounding alone decides in which direction {} "
                   "moves; break the symmetry by a small force, or see how far results differ with "
                   "run.perturb",
                   first_tie_[0], times, where(run.model, coordinate)),
       "bodies." + run.model.name_of(coordinate).body});
}

void Equilibrium::results(ResultTable& table, const double*) const {
  if (!found_) return;
  ResultGroup& group = table.group("equilibrium");
  group.add(kEnergy, found_->energy);
  group.add(kNeutralDirections, found_->neutral_directions);
  group.add(kSmallestCurvature, found_->smallest_curvature);
  group.add(kLogDeterminant, found_->log_determinant);
}

}  // namespace

ObserverKind equilibrium() {
  return {.rows = {{"equilibrium",
                    {&kEnergy, &kNeutralDirections, &kSmallestCurvature, &kLogDeterminant}}},
          .make = [](const ObserverParts& parts) -> std::unique_ptr<RunObserver> {
            if (parts.run.path == nullptr) return nullptr;
            return std::make_unique<Equilibrium>(parts);
          }};
}

}  // namespace tomlin::observers
