#include "framework/run/results/observation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "framework/run/guard/energy_terms.hpp"
#include "framework/run/observers/kinds.hpp"
#include "framework/run/observers/observed_integrals.hpp"
#include "framework/run/observers/scene_observers.hpp"
#include "framework/run/results/results.hpp"
#include "framework/run/steps/gauss_rule.hpp"
#include "framework/run/window/blocking.hpp"

namespace tomlin {
namespace {

/// A signal is checked for after this many samples of one very long step.
constexpr std::uint64_t kSamplesBetweenLooks = 100'000;

/// Families of results, in the order of a summary.
constexpr std::string_view kFamilies[] = {"drivers", "bodies",      "forces", "observers",
                                          "events",  "equilibrium", "energy"};

}  // namespace

/// Rows of a family, and warnings, come in this order.
std::span<const ObserverKind> observer_kinds() {
  using namespace observers;
  static const ObserverKind kinds[] = {
      friction_loops(), force_means(),   end_of_run(),  body_motion(),     extremes(),
      equilibrium(),    pull_events(),   body_events(), window_check(),    work(),
      event_counts(),   energy_ledger(), long_bonds(),  force_deviation(), forces_on_bodies(),
      temperature(),    mean_errors(),
  };
  return kinds;
}

namespace {

bool is_wanted(const ObserverKind& kind, const Selection& selection) {
  if (!kind.watches) return true;
  const auto wants = [&](std::string_view key) { return selection.wants(key); };
  return std::any_of(kind.events.begin(), kind.events.end(), wants) ||
         std::any_of(kind.rows.begin(), kind.rows.end(), [&](const ObserverRows& rows) {
           return std::any_of(rows.quantities.begin(), rows.quantities.end(),
                              [&](const ResultQuantity* row) { return wants(row->key); });
         });
}

template <class Facet>
void add_facet(Facet* facet, std::vector<Facet*>& all) {
  if (facet != nullptr) all.push_back(facet);
}

}  // namespace

ResultGroup& ResultTable::group(std::string_view family, std::string_view name) {
  for (ResultGroup& group : groups_) {
    if (group.family == family && group.name == name) return group;
  }
  return groups_.emplace_back(ResultGroup{std::string(family), std::string(name), {}});
}

void ResultTable::convert_to(UnitSystem units) {
  if (units == UnitSystem::reduced) return;
  for (ResultGroup& group : groups_) {
    for (ResultValue& value : group.values) value.convert_to(units);
  }
  for (ErrorEstimate& estimate : errors_) {
    const ResultQuantity* quantity = quantity_at(estimate.path);
    if (quantity == nullptr || !estimate.error) continue;
    *estimate.error /= scene_unit(units, quantity->dimension);
  }
}

std::vector<ResultGroup> ResultTable::take(const Selection& selection) {
  selection.keep_rows(groups_);
  const auto rank = [](const ResultGroup& group) {
    return std::find(std::begin(kFamilies), std::end(kFamilies), group.family) -
           std::begin(kFamilies);
  };
  std::stable_sort(groups_.begin(), groups_.end(),
                   [&](const ResultGroup& a, const ResultGroup& b) { return rank(a) < rank(b); });
  return std::move(groups_);
}

Observation::Observation(RunContext& run)
    : run_(run),
      selection_(selection_of(*run.scene, run.options)),
      signals_(run.model),
      window_(run.model),
      rotations_(run.model),
      events_(run.options.sink, window_),
      samples_({run, signals_, window_, rotations_, events_, selection_}),
      span_(run.model, signals_, *run.integrator) {
  const ObserverParts parts{run_, signals_, window_, rotations_, events_, selection_};
  for (const ObserverKind& kind : observer_kinds()) {
    if (!run.options.all_observables && !is_wanted(kind, selection_)) continue;
    if (auto observer = kind.make(parts)) observers_.push_back(std::move(observer));
  }
  if (!run.scene->observers.empty()) {
    auto of_scene = std::make_unique<observers::SceneObservers>(parts);
    if (of_scene->any()) samples_.show(*of_scene);
    observers_.push_back(std::move(of_scene));
    if (auto gathers = observers::observed_integrals(parts)) {
      observers_.push_back(std::move(gathers));
    }
  }
  for (const auto& observer : observers_) {
    const ObserverFacets facets = observer->facets();
    add_facet(facets.at_steps, at_steps_);
    add_facet(facets.at_blocks, at_blocks_);
    add_facet(facets.reader, readers_);
    add_facet(facets.at_nodes, at_nodes_);
    add_facet(facets.at_ends, at_ends_);
    add_facet(facets.at_block_ends, at_block_ends_);
    add_facet(facets.at_batch_ends, at_batch_ends_);
    add_facet(facets.on_path, on_path_);
    add_facet(facets.errors, estimators_);
  }
  at_signals_ = at_steps_;
  at_signals_.insert(at_signals_.end(), at_blocks_.begin(), at_blocks_.end());
  block_.width = signals_.count();
  block_times_.assign(kBlock, 0.0);
  block_signals_.assign(kBlock * signals_.count(), 0.0);
  block_.times = block_times_.data();
  block_.signals = block_signals_.data();
  block_.rate_width = run.model.system().view.rates;
  const SystemView<double>& view = run.model.system().view;
  within_.position.assign(view.dofs + 2 * kGroup, 0.0);
  within_.velocity.assign(view.dofs + 2 * kGroup, 0.0);
  within_.integrals.assign(view.rates + 2 * kGroup, 0.0);
  within_.rates.assign(view.rates + 2 * kGroup, 0.0);
  within_.signals.assign(signals_.count(), 0.0);
}

void Observation::declare(StateLayout& layout) const {
  rotations_.declare(layout);
  window_.declare(layout);
  events_.declare(layout);
  samples_.declare(layout);
  for (const auto& observer : observers_) observer->declare(layout);
}

void Observation::attach(RunState& state) {
  rotations_.attach(state);
  window_.attach(state);
  events_.attach(state);
  samples_.attach(state);
  for (const auto& observer : observers_) observer->attach(state);
  is_point_ = run_.plan.dt > 0.0 && run_.point_blocks() != nullptr;
}

void Observation::start() {
  rotations_.start();
  for (const auto& observer : observers_) observer->start();
}

void Observation::placed() {
  for (SignalObserver* observer : at_signals_) observer->placed();
}

void Observation::look_at_start() {
  const SystemView<double>& view = run_.model.system().view;
  if (samples_.are_wanted()) take_point(0.0, view.position, view.velocity, view.integrals);
  if (window_.next_edge() == 0.0) reach_edge(0.0, view.position, view.velocity, view.integrals);
  at_equilibrium();
  look_at_end_of_step();
}

void Observation::begin_step(double time) {
  dense_is_complete_ = false;
  if (!watches()) return;
  const SystemView<double>& view = run_.model.system().view;
  const double* velocity = run_.plan.dt == 0.0 ? view.velocity : nullptr;
  for (StateReader* reader : readers_) reader->read(0, view.position, velocity);
  block_times_[block_.count] = time;
  point_position_ = view.position[0];
  point_velocity_ = view.velocity[0];
  signals_.write_speeds(view.velocity, time, row());
}

void Observation::end_step() {
  if (!watches()) return;
  signals_.write_forces(run_.integrator->first_rates(), row());
  SignalBlock step = block_.step(block_.count++);
  if (is_point_) {
    step.positions = &point_position_;
    step.velocities = &point_velocity_;
    step.rates = run_.integrator->first_rates();
  }
  for (SignalObserver* observer : at_steps_) observer->steps(step);
}

void Observation::end_block() {
  for (SignalObserver* observer : at_blocks_) observer->steps(block_);
  block_.count = 0;
}

void Observation::point_block(std::int64_t first_step, std::size_t count,
                              const PointStarts<double>& starts) {
  if (!watches()) return;
  const std::size_t width = run_.model.system().view.rates;
  const std::size_t speed = signals_.speed_of(0);
  const double dt = run_.plan.dt;
  double* const times = block_times_.data();
  double* signals = block_signals_.data();
  for (std::size_t k = 0; k < count; ++k) {
    times[k] = static_cast<double>(first_step + static_cast<std::int64_t>(k)) * dt;
    signals[speed] = std::abs(starts.velocities[k]);
    signals_.write_forces(starts.rates + k * width, signals);
    signals += block_.width;
  }
  block_.count = count;
  SignalBlock block = block_;
  block.positions = starts.positions;
  block.velocities = starts.velocities;
  block.rates = starts.rates;
  for (SignalObserver* observer : at_steps_) observer->steps(block);
  end_block();
}

void Observation::sample_point(double time, double position, double velocity, double* rates) {
  // Kernels read whole groups.
  within_.position[0] = position;
  within_.velocity[0] = velocity;
  samples_.take({.time = time,
                 .position = within_.position.data(),
                 .velocity = within_.velocity.data(),
                 .rates = rates});
}

/// Long steps hide extremes: those of the cubic through the dense output at thirds of the step are
/// as good as the dense output.
void Observation::look_between(double from, double to) {
  if (!watches()) return;
  const SystemView<double>& view = run_.model.system().view;
  span_.from = from;
  span_.to = to;
  span_.is_dense = true;
  span_.times[0] = from;
  signals_.write_forces(run_.integrator->first_rates(), row());
  std::copy_n(row(), signals_.count(), span_.at[0].data());
  for (int k = 1; k <= 3; ++k) {
    span_.times[k] = from + (to - from) * k / 3.0;
    if (span_.read_dense(k / 3.0, span_.times[k], span_.at[k])) continue;
    // Without dense output the step is shown as one of the grid.
    end_step();
    end_block();
    return;
  }
  for (StateReader* reader : readers_) reader->read(3, view.position, view.velocity);
  show_span();
}

void Observation::show_span() {
  for (std::size_t k = 0; k < 3; ++k) {
    for (SignalObserver* observer : at_signals_) observer->look_at_point(span_, k);
  }
  for (SignalObserver* observer : at_signals_) observer->span(span_);
}

/// Steps are long, and forces fall steeply where an equilibrium is about to end: looks are at
/// equal distances along the path, and cubics go through four of them.
void Observation::look_along_path(double from, double to) {
  if (!watches()) return;
  span_.is_dense = false;
  for (std::size_t first = 0; first + 3 < EquilibriumPath::kMoments; first += 3) {
    for (std::size_t k = 0; k < 4; ++k) {
      const double part = run_.path->moment(first + k, within_.position.data(),
                                            within_.velocity.data(), within_.rates.data());
      span_.times[k] = from + (to - from) * part;
      signals_.write_forces(within_.rates.data(), span_.at[k].data());
      signals_.write_speeds(within_.velocity.data(), span_.times[k], span_.at[k].data());
      if (k == 3) break;
      for (StateReader* reader : readers_) reader->read(k, within_.position.data(), nullptr);
    }
    span_.from = span_.times[0];
    span_.to = span_.times[3];
    show_span();
  }
}

void Observation::at_equilibrium() {
  for (PathObserver* observer : on_path_) observer->at_equilibrium();
}

/// The signals before it are those at the end of the step; speeds after it are of no meaning.
void Observation::path_slip(double energy_lost) {
  const SystemView<double>& view = run_.model.system().view;
  run_.model.evaluate_at(run_.clock.now(), view.position, view.velocity, view.integrals,
                         within_.rates.data());
  signals_.write_forces(within_.rates.data(), within_.signals.data());
  const PathSlip slip{energy_lost, span_.at[3].data(), within_.signals.data()};
  for (PathObserver* observer : on_path_) observer->path_slip(slip);
}

void Observation::force_changed(const std::string& force) {
  signals_.set_directions();
  for (const auto& observer : observers_) observer->force_changed(force);
  Event event = event_of_kind(EventKind::driver_reversal);
  event.time = run_.clock.time();
  events_.record(event, force);
}

void Observation::force_switched(const std::string& force) {
  signals_.set_directions();
  for (const auto& observer : observers_) observer->force_switched(force);
}

void Observation::look_at_rotations() {
  rotations_.look([this](std::size_t body, double turns) {
    for (StateReader* reader : readers_) reader->turned(body, turns);
  });
}

void Observation::look_at_block_end() {
  for (BlockObserver* observer : at_block_ends_) observer->block_ended();
}

double Observation::idle_until() const {
  double time = std::numeric_limits<double>::infinity();
  for (const BlockObserver* observer : at_block_ends_)
    time = std::min(time, observer->idle_until());
  return time;
}

void Observation::look_at_batch_end() {
  for (BatchObserver* observer : at_batch_ends_) observer->batch_ended();
}

bool Observation::serve(double first_time, const DoubleDouble& from, const DoubleDouble& to,
                        double next_since) {
  // The end of the step itself needs no interpolation, and so no evaluation.
  if (first_time < static_cast<double>(to)) complete_dense(next_since);
  const double length = static_cast<double>(to - from);
  std::uint64_t served = 0;
  for (double time = first_time; time <= static_cast<double>(to); time = next_time()) {
    // The step is then left unfinished.
    if (++served % kSamplesBetweenLooks == 0 && run_.stopped()) return false;
    const SystemView<double>& view = run_.model.system().view;
    const double* position = view.position;
    const double* velocity = view.velocity;
    const double* integrals = view.integrals;
    if (run_.plan.dt == 0.0 || time != static_cast<double>(to)) {
      const double theta =
          std::clamp(static_cast<double>(DoubleDouble(time) - from) / length, 0.0, 1.0);
      position = within_.position.data();
      velocity = within_.velocity.data();
      integrals = within_.integrals.data();
      run_.integrator->interpolate(theta, within_.position.data(), within_.velocity.data(),
                                   within_.integrals.data());
    }
    if (!window_.is_open() && time >= window_.next_edge()) {
      reach_edge(time, position, velocity, integrals);
    }
    if (window_.is_open() && time >= window_.next_edge()) {
      reach_edge(time, position, velocity, integrals);
      window_has_ended_ = true;
    }
    if (samples_.is_taken_at(time)) take_point(time, position, velocity, integrals);
  }
  return true;
}

/// Once a step.
void Observation::complete_dense(double next_since) {
  if (!std::exchange(dense_is_complete_, true)) run_.integrator->finish_dense_from(next_since);
}

void Observation::integrate(const DoubleDouble& from, const DoubleDouble& to, double next_since) {
  if (at_nodes_.empty()) return;
  const double length = static_cast<double>(to - from);
  const auto part_at = [&](double time) {
    return std::clamp(static_cast<double>(DoubleDouble(time) - from) / length, 0.0, 1.0);
  };
  const double begin = part_at(window_.from().time);
  const double part = part_at(window_.to().time) - begin;
  if (!(part > 0.0)) return;
  at_nodes(from, to, next_since, {begin, part}, [this](const RunMoment& moment, double weight) {
    for (NodeObserver* observer : at_nodes_) observer->node(moment, weight);
  });
}

void Observation::look_at_end_of_step() {
  if (at_ends_.empty()) return;
  const SystemView<double>& view = run_.model.system().view;
  const RunMoment moment =
      moment_at(run_.clock.now(), view.position, view.velocity, view.integrals);
  for (StepObserver* observer : at_ends_) observer->stepped(moment);
}

RunMoment Observation::moment_at(const DoubleDouble& time, const double* position,
                                 const double* velocity, const double* integrals) {
  run_.model.evaluate_at(time, position, velocity, integrals, within_.rates.data());
  return {.time = static_cast<double>(time),
          .elapsed = static_cast<double>(time - run_.model.anchor_time()),
          .position = position,
          .velocity = velocity,
          .integrals = integrals,
          .rates = within_.rates.data(),
          .signals = nullptr};
}

void Observation::take_point(double time, const double* position, const double* velocity,
                             const double* integrals) {
  samples_.take(moment_at(DoubleDouble(time), position, velocity, integrals));
}

void Observation::reach_edge(double time, const double* position, const double* velocity,
                             const double* integrals) {
  RunMoment moment = moment_at(DoubleDouble(time), position, velocity, integrals);
  double stored = 0.0;
  if (run_.scene->run.ledger) {
    stored = stored_energy(run_.model, DoubleDouble(time), position, velocity, integrals);
  }
  window_.reach(position, integrals, rotations_, stored);
  signals_.write_forces(within_.rates.data(), within_.signals.data());
  signals_.write_speeds(velocity, time, within_.signals.data());
  moment.signals = within_.signals.data();
  for (const auto& observer : observers_) observer->edge(moment);
}

void Observation::next_window() {
  for (const auto& observer : observers_) observer->next_window();
}

void Observation::close_window() {
  const SystemView<double>& view = run_.model.system().view;
  if (window_.is_open()) {
    reach_edge(window_.to().time, view.position, view.velocity, view.integrals);
  }
}

RunMoment Observation::end_of_run(double* rates) {
  const SystemView<double>& view = run_.model.system().view;
  signals_.write_forces(rates, within_.signals.data());
  return {.time = run_.clock.time(),
          .elapsed = static_cast<double>(run_.clock.now() - run_.model.anchor_time()),
          .position = view.position,
          .velocity = view.velocity,
          .integrals = view.integrals,
          .rates = rates,
          .signals = within_.signals.data()};
}

void Observation::stopped(double* rates) {
  const RunMoment end = end_of_run(rates);
  for (const auto& observer : observers_) observer->stopped(end);
}

void Observation::finish(double* rates) {
  const RunMoment end = end_of_run(rates);
  for (SignalObserver* observer : at_signals_) observer->look_at_end(end);
  for (const auto& observer : observers_) observer->finish(end);
}

std::vector<std::string> Observation::estimated() const {
  std::vector<std::string> paths;
  for (const ErrorEstimator* estimator : estimators_) {
    const std::vector<std::string> more = estimator->estimated();
    paths.insert(paths.end(), more.begin(), more.end());
  }
  return paths;
}

std::optional<double> Observation::error_so_far(std::string_view path) const {
  for (const ErrorEstimator* estimator : estimators_) {
    if (const std::optional<double> error = estimator->error_so_far(path)) return error;
  }
  return std::nullopt;
}

void Observation::write_results(const double* rates, RunResult& result) const {
  ResultTable table;
  for (const auto& observer : observers_) observer->results(table, rates);
  table.convert_to(run_.scene->units);
  result.errors = table.errors();
  std::string unknown;
  double longer = 0.0;
  for (const ErrorEstimate& estimate : result.errors) {
    if (estimate.error) continue;
    longer = std::max(longer, estimate.longer);
    unknown += (unknown.empty() ? "" : ", ") + estimate.path;
  }
  if (!unknown.empty()) {
    result.warnings.push_back(
        {FaultCode::run_error_not_estimated,
         fmt::format(
             "no statistical error of {}: the window is shorter than {:g} correlation "
             "times, or has too few blocks, slips or strokes{}",
             unknown, kFewestCorrelationTimes,
             longer > 0.0 ? fmt::format("; one {:.2g} times as long is the least", longer) : ""),
         "measure"});
  }
  result.groups = table.take(run_.options.all_observables ? Selection() : selection_);
}

}  // namespace tomlin
