#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "framework/core/system/aligned.hpp"
#include "framework/run/events/events.hpp"
#include "framework/run/guard/energy_terms.hpp"
#include "framework/run/observers/kinds.hpp"
#include "framework/run/observers/slip_statistics.hpp"
#include "framework/run/observers/static_force.hpp"
#include "framework/run/steps/run_plan.hpp"
#include "framework/run/window/wells.hpp"

/// Results that follow from a driver's force: slips with their statistics, reversals, the static
/// force and the effective stiffness during sticking.
namespace tomlin::observers {
namespace {

const ResultQuantity kStaticForce{
    "static_force", dimension::force, Shape::number, Scope::run,
    "largest force along the pull before the first slip; of the whole run where nothing slips"};

/// The engine holds forces as doubles, in a run in quadruple precision as well.
constexpr double kUnitRoundoff = 2.3e-16;

/// Work done on the scene so far, at the starts of steps, for a single point on a line, whose steps
/// are taken in blocks. It is integrated from its rates there, so that it does not depend on where
/// blocks end: the formula of Adams and Moulton with four points,
/// which has the order 4.
class WorkOfSteps {
 public:
  explicit WorkOfSteps(const Model& model) {
    for (const Model::Driver& driver : model.drivers()) {
      powers_.push_back(driver.first_rate + model.dimension());
    }
    for (const Model::Force& force : model.forces()) {
      if (force.traits.conservative && force.heat_rate != kNoRate) {
        of_energies_.push_back(force.heat_rate);
      }
    }
  }
  static void declare(StateLayout& layout) {
    layout.add_reals("events.work", LastPoints::kReals + 1);
    layout.add_integers("events.work", LastPoints::kIntegers);
  }
  void attach(RunState& state) {
    double* reals = state.reals("events.work");
    power_ = LastPoints(reals, state.integers("events.work"));
    work_ = reals + LastPoints::kReals;
  }
  void start() {
    power_.clear();
    *work_ = 0.0;
  }
  bool is_known() const { return power_.count() > 0; }
  /// At the start of a step, with the rates there.
  double add(double time, const double* rates) {
    double power = 0.0;
    for (const std::ptrdiff_t rate : powers_) power += rates[rate];
    for (const std::ptrdiff_t rate : of_energies_) power -= rates[rate];
    power_.add(time, power);
    return *work_ += last_step();
  }

 private:
  double last_step() const {
    const std::size_t count = power_.count();
    if (count < 2) return 0.0;
    const double h = power_.time(0) - power_.time(1);
    constexpr double kEqual = 1e-6;  // steps, but for rounding of times
    const bool equal =
        count >= 4 && std::abs(power_.time(0) - power_.time(3) - 3.0 * h) < kEqual * h;
    if (!equal) return 0.5 * h * (power_.value(0) + power_.value(1));
    return h / 24.0 *
           (9.0 * power_.value(0) + 19.0 * power_.value(1) - 5.0 * power_.value(2) +
            power_.value(3));
  }

  std::vector<std::ptrdiff_t> powers_;
  std::vector<std::ptrdiff_t> of_energies_;
  LastPoints power_;
  double* work_ = nullptr;
};

class PullEvents : public RunObserver,
                   public SignalObserver,
                   public PathObserver,
                   public ErrorEstimator {
 public:
  explicit PullEvents(const ObserverParts& parts);

  ObserverFacets facets() override {
    return {.at_steps = watches_.empty() ? nullptr : this,
            .at_blocks = watches_.empty() && !drivers_.empty() ? this : nullptr,
            .on_path = this,
            .errors = this};
  }
  void declare(StateLayout& layout) const override;
  void attach(RunState& state) override;
  void start() override;
  void next_window() override { slips_.start(); }
  void placed() override;
  void steps(const SignalBlock& block) override;
  void look_at_point(const SignalSpan& span, std::size_t k) override;
  void span(const SignalSpan& span) override;
  void path_slip(const PathSlip& slip) override;
  void force_changed(std::string_view force) override;
  void force_switched(std::string_view force) override;
  void find_wells(const DoubleDouble& now);
  void look_at_end(const RunMoment& end) override;
  void finish(const RunMoment& end) override;
  std::vector<std::string> estimated() const override { return slips_.estimated(); }
  std::optional<double> error_so_far(std::string_view path) const override {
    return slips_.error_so_far(path);
  }
  void results(ResultTable& table, const double* rates) const override;

 private:
  bool follows_path() const { return parts_.run.path != nullptr; }
  /// The force along the pull, whichever way the driver now goes.
  double force_along(std::size_t driver, const double* signals) const {
    return parts_.signals.power(driver, signals) * parts_.signals.along(driver);
  }
  /// That times the factors, if there are any.
  double stretching(const DriverWatch& watch, const double* signals) const {
    const std::size_t k = watch.driver();
    if (watch.factors().empty()) return force_along(k, signals);
    double power = 0.0;
    for (std::size_t d = 0; d < parts_.axes(); ++d) {
      power += watch.factors()[d] * parts_.signals.start_velocity(k, d) *
               signals[parts_.signals.force_of(k, d)];
    }
    return power * parts_.signals.along(k);
  }
  void watch(double time, const double* signals);
  void watch_block(const SignalBlock& block);
  void keep_states(const SignalBlock& block);
  DriverWatch::HeatAt heat_at(double time);
  void slipped(const Event& slip);
  void see_peaks(const SignalSpan& span);
  void forget_peaks();

  ObserverParts parts_;
  const std::vector<Model::Driver>& drivers_;
  std::vector<DriverWatch> watches_;
  StaticForce static_force_;
  SlipStatistics slips_;
  double* peaks_ = nullptr;  ///< quasistatic: of forces along the pulls since the last slip
  std::string_view name_;    ///< of the driver whose event is looked for
  DriverWatch::Emit emit_;
  DriverWatch::Heat heat_;
  bool looks_for_slips_ = false;
  WorkOfSteps work_;
  SignalBlock states_;                ///< of a point: the steps that are looked at
  std::array<double, kBlock> works_;  ///< at their starts
  DriverWatch::HeatAt at_end_;        ///< of a step, whose heat was asked for last
  AlignedVector<double> position_;    // aligned: kernels read them
  AlignedVector<double> velocity_;
};

PullEvents::PullEvents(const ObserverParts& parts)
    : parts_(parts),
      drivers_(parts.signals.drivers()),
      static_force_(parts, watches_),
      slips_(parts),
      work_(parts.run.model),
      works_{},
      at_end_{std::numeric_limits<double>::quiet_NaN(), 0.0} {
  const Model& model = parts_.run.model;
  if (follows_path()) parts_.events.expect(EventKind::slip);
  const bool noisy = has_thermostat(*parts_.run.scene);
  for (std::size_t k = 0; k < drivers_.size(); ++k) {
    const Drive& drive = *drivers_[k].drive;
    if (!pulls(drive)) continue;
    double period = 0.0;
    for (int d = 0; d < model.dimension(); ++d) {
      if (drive.velocity[d] == 0.0 || !(drive.stiffness_on(d) > 0.0)) continue;
      period = std::max(period, model.origin().unit[d]);
    }
    watches_.emplace_back(
        k, drive, period, kUnitRoundoff,
        follows_path() ? DriverWatch::Slips::reported : DriverWatch::Slips::detected);
    if (noisy) {
      watches_.back().set_noise();
    } else {
      parts_.events.expect(EventKind::reversal);
    }
    if (!watches_.back().watches_slips()) continue;
    looks_for_slips_ = true;
    parts_.events.expect(EventKind::slip);
  }
  emit_ = [this](const Event& event) {
    if (event.kind == EventKind::slip) slipped(event);
    parts_.events.record(event, name_);
  };
  heat_ = [this](double time) { return heat_at(time); };
  // A single point on a line has no more.
  const SystemView<double>& view = model.system().view;
  if (!looks_for_slips_ || view.dofs > kGroup) return;
  position_.assign(view.dofs + 2 * kGroup, 0.0);
  velocity_.assign(view.dofs + 2 * kGroup, 0.0);
}

void PullEvents::declare(StateLayout& layout) const {
  static_force_.declare(layout);
  slips_.declare(layout);
  if (follows_path()) layout.add_reals("events.peaks", drivers_.size());
  declare_all(layout, "events.drivers", watches_);
  WorkOfSteps::declare(layout);
}

void PullEvents::attach(RunState& state) {
  static_force_.attach(state);
  slips_.attach(state);
  if (follows_path()) peaks_ = state.reals("events.peaks");
  attach_all(state, "events.drivers", watches_);
  work_.attach(state);
  if (parts_.run.plan.dt > 0.0 || follows_path()) return;
  for (DriverWatch& watch : watches_) watch.set_long_steps();
}

void PullEvents::start() {
  static_force_.start();
  for (DriverWatch& watch : watches_) watch.start();
  work_.start();
  forget_peaks();
}

void PullEvents::placed() {
  if (follows_path()) return;
  find_wells(DoubleDouble(0.0));
  const bool any = std::any_of(watches_.begin(), watches_.end(),
                               [](const DriverWatch& watch) { return watch.finds_slips(); });
  const bool for_good = !std::isfinite(parts_.run.model.next_switch());
  if (!any && for_good) parts_.events.expect(EventKind::slip, false);
}

/// Finds the wells of the forces that are active now.
void PullEvents::find_wells(const DoubleDouble& now) {
  RunContext& run = parts_.run;
  for (DriverWatch& watch : watches_) {
    if (!watch.watches_slips()) continue;
    const Model::Driver& driver = drivers_[watch.driver()];
    const auto body = body_pulled_by(run.model, driver);
    if (!body) continue;
    const auto well =
        well_of_body(run.model, *body, driver, watch.period(), now, run.plan.duration);
    if (!well) continue;
    if (well->known) {
      watch.set_wells(well->distance);
    } else {
      watch.set_unknown_wells();
    }
  }
}

void PullEvents::watch(double time, const double* signals) {
  for (DriverWatch& watch : watches_) {
    name_ = drivers_[watch.driver()].name;
    watch.add(time, stretching(watch, signals), force_along(watch.driver(), signals), emit_, heat_);
  }
}

void PullEvents::watch_block(const SignalBlock& block) {
  std::array<double, kBlock> forces;
  DriverWatch& watch = watches_.front();
  name_ = drivers_[watch.driver()].name;
  for (std::size_t n = 0; n < block.count; ++n) {
    forces[n] = force_along(watch.driver(), block.at(n));
  }
  watch.add_block(block.times, forces.data(), block.count, emit_, heat_);
}

void PullEvents::keep_states(const SignalBlock& block) {
  states_ = block;
  for (std::size_t n = 0; n < block.count; ++n) {
    works_[n] = work_.add(block.times[n], block.rates + n * block.rate_width);
  }
}

/// Heat of a single point at the start of a step; else at the end of the step that has been taken.
DriverWatch::HeatAt PullEvents::heat_at(double time) {
  RunContext& run = parts_.run;
  if (!work_.is_known()) {
    const double end = static_cast<double>(run.seen);
    if (at_end_.time != end) at_end_ = {end, heat_so_far(run)};
    return at_end_;
  }
  const auto n = static_cast<std::size_t>(
      std::find(states_.times, states_.times + states_.count, time) - states_.times);
  position_[0] = states_.positions[n];
  velocity_[0] = states_.velocities[n];
  return {time,
          works_[n] - run.model.kinetic_energy(position_.data(), velocity_.data()) -
              run.model.potential_energy(DoubleDouble(time), position_.data(), velocity_.data(),
                                         run.model.system().view.integrals)};
}

void PullEvents::steps(const SignalBlock& block) {
  if (block.has_states() && looks_for_slips_) keep_states(block);
  // Blocks are watched for one driver alone, so that events come in the order of time.
  if (block.count > 1 && watches_.size() == 1 && !static_force_.any_open()) {
    watch_block(block);
    return;
  }
  for (std::size_t n = 0; n < block.count; ++n) {
    if (static_force_.any_open()) static_force_.note_slipping();
    watch(block.times[n], block.at(n));
    if (static_force_.any_open()) static_force_.add(block.times[n], block.at(n));
  }
}

void PullEvents::look_at_point(const SignalSpan& span, std::size_t k) {
  if (k == 0) static_force_.note_slipping();
  watch(span.times[k], span.at[k].data());
}

void PullEvents::span(const SignalSpan& span) {
  static_force_.add(span);
  if (follows_path()) see_peaks(span);
}

/// Before it is counted.
void PullEvents::slipped(const Event& slip) {
  for (const DriverWatch& watch : watches_) {
    if (drivers_[watch.driver()].name != name_) continue;
    static_force_.slipped(watch, !follows_path());
    slips_.add(watch.driver(), slip, watch.steepest());
  }
}

/// The largest force along a driver's pull since the last slip.
void PullEvents::see_peaks(const SignalSpan& span) {
  for (std::size_t k = 0; k < drivers_.size(); ++k) {
    if (!drags(*drivers_[k].drive)) continue;
    double powers[4];
    for (std::size_t n = 0; n < 4; ++n) powers[n] = parts_.signals.power(k, span.at[n].data());
    const CubicExtremes found = cubic_extremes(powers[0], powers[1], powers[2], powers[3]);
    const auto see = [&](double power) {
      peaks_[k] = std::max(peaks_[k], power * parts_.signals.along(k));
    };
    for (const double power : powers) see(power);
    for (int e = 0; e < found.count; ++e) see(found.value[e]);
  }
}

void PullEvents::forget_peaks() {
  if (follows_path()) {
    std::fill_n(peaks_, drivers_.size(), -std::numeric_limits<double>::infinity());
  }
}

/// It is the slip of the driver whose spring's end gets furthest ahead.
void PullEvents::path_slip(const PathSlip& slip) {
  Event event = event_of_kind(EventKind::slip);
  event.time = parts_.run.clock.time();
  event.duration = 0.0;
  event.energy_lost = slip.energy_lost;
  name_ = drivers_.empty() ? parts_.run.model.bodies().front().bound.name : drivers_.front().name;
  for (DriverWatch& watch : watches_) {
    const std::size_t k = watch.driver();
    const double ahead =
        (stretching(watch, slip.before) - stretching(watch, slip.after)) / watch.stiffness();
    if (std::isnan(event.size) || std::abs(ahead) > std::abs(event.size)) {
      event.size = ahead;
      event.peak_force = peaks_[k];
      name_ = drivers_[k].name;
    }
    if (ahead > 0.0) static_force_.slipped(k, parts_.signals.power(k, slip.before));
  }
  forget_peaks();
  emit_(event);
  for (DriverWatch& watch : watches_) {
    watch.start();
    watch.look_for_stiffness(event.time, force_along(watch.driver(), slip.after));
  }
}

void PullEvents::force_changed(std::string_view force) {
  forget_peaks();
  for (DriverWatch& watch : watches_) {
    if (drivers_[watch.driver()].name != force) continue;
    name_ = drivers_[watch.driver()].name;
    watch.close_slip(emit_);
    watch.turned();
  }
}

/// The pull or the forces that resist it are others now: watching begins afresh.
void PullEvents::force_switched(std::string_view) {
  if (follows_path()) return;
  static_force_.break_off();
  for (DriverWatch& watch : watches_) {
    name_ = drivers_[watch.driver()].name;
    watch.close_slip(emit_);
    watch.start();
  }
  find_wells(parts_.run.clock.now());
}

void PullEvents::look_at_end(const RunMoment& end) {
  static_force_.note_slipping();
  parts_.run.seen = parts_.run.clock.now();  // a run that resumes at its end has taken no step
  if (work_.is_known()) {
    keep_states({.count = 1,
                 .times = &end.time,
                 .positions = end.position,
                 .velocities = end.velocity,
                 .rates = end.rates});
  }
  watch(end.time, end.signals);
  static_force_.add_end(end.signals);
}

void PullEvents::finish(const RunMoment& end) {
  for (DriverWatch& watch : watches_) {
    name_ = drivers_[watch.driver()].name;
    watch.finish(end.time, emit_);
  }
}

void PullEvents::results(ResultTable& table, const double*) const {
  for (std::size_t k = 0; k < drivers_.size(); ++k) {
    ResultGroup& group = table.driver(drivers_[k]);
    group.add(kStaticForce, static_force_.of(k));
    const bool looked_for = std::any_of(
        watches_.begin(), watches_.end(),
        [k](const DriverWatch& watch) { return watch.driver() == k && watch.finds_slips(); });
    slips_.add_rows(group, k, looked_for);
  }
  slips_.add_errors(table);
}

}  // namespace

ObserverKind pull_events() {
  ObserverRows rows{"drivers", {&kStaticForce}};
  for (const ResultQuantity* row : SlipStatistics::rows()) rows.quantities.push_back(row);
  ObserverKind kind = kind_of<PullEvents>({rows});
  kind.watches = true;
  kind.events = {"slips", "reversals"};
  return kind;
}

}  // namespace tomlin::observers
