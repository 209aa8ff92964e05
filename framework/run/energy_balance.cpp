#include "framework/run/energy_balance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

#include <fmt/format.h>

#include "framework/core/numbers/random.hpp"
#include "framework/core/system/tolerance.hpp"
#include "framework/run/brief_ledger.hpp"
#include "framework/run/context.hpp"
#include "framework/run/engine.hpp"
#include "framework/run/start_checks.hpp"
#include "framework/scene/natural_units.hpp"

namespace tomlin {
namespace {

/// Of the window, one block of steps in each. Fixed steps are many and cheap, adaptive ones few and
/// expensive.
constexpr std::int64_t kFixedStrata = 128;
constexpr std::int64_t kAdaptiveStrata = 32;
/// Steps in a block of the second engine.
constexpr std::uint64_t kFixedSteps = kBlock / 2;
constexpr std::uint64_t kAdaptiveSteps = 4;
/// A block of the run's own, with the energies at both of its ends, costs a tip as much as some 25
/// of its steps: so many of them are in a stratum, but for runs that are little longer than short.
constexpr double kStepsInStratum = 1024.0;
constexpr std::int64_t kFewestStrata = 16;
/// Runs of so many steps are looked at as a whole: by a second engine, or with a ledger of their
/// own, which costs a few per cent of each step.
constexpr double kShort = 4096.0;
constexpr double kShortWithLedger = 16384.0;
/// Numerical work beside the larger one of work and heat, or beside the energy where there is no
/// heat: a few per cent are what a coarse but sensible step costs.
constexpr double kNotSmall = 0.05;
/// Every step of an adaptive scheme may add its tolerance in parts of the energy, and flows have
/// errors in parts of theirs. All shipped scenes under dopri5, dop853 and radau9 stay below 100
/// such errors at tolerances of 1e-6 and finer.
constexpr double kTolerances = 300.0;
/// Standard errors that a sampled numerical work has to be away from zero: slips are rare and
/// large, so that a few blocks decide.
constexpr double kSurely = 4.0;
/// Heat, in parts of the energy, that is none: nothing damps, or friction has had no time to.
constexpr double kNoHeat = 1e-12;
/// Of the energy itself, that its changes are rounding.
constexpr double kRounding = 1e-11;
/// Blocks for a standard error.
constexpr std::int64_t kFewest = 8;

/// Work or heat of fewer times the mean energy than this is no flow through a body in a bath.
constexpr double kNetFlow = 100.0;

/// Of the places of blocks: the same in every run, so that results are reproducible.
constexpr RandomKey kKey{0x656e65726779, 0};

/// The scene with a ledger and nothing else that takes time.
std::shared_ptr<const Scene> with_ledger(const Scene& scene) {
  auto result = std::make_shared<Scene>(scene);
  result->run.ledger = true;
  result->run.until.reset();
  result->run.perturb.reset();
  result->run.accuracy.reset();
  result->output.every.reset();
  result->output.trajectory = false;
  result->observers.clear();
  result->measure = {};
  return result;
}

}  // namespace

namespace {

/// Returns the numerical work that the tolerance of an adaptive scheme allows; infinite where it
/// says nothing of it.
double allowed_by_tolerance(const SampledWork& found, const RunContext& run) {
  const RunSettings& settings = run.scene->run;
  const double length = tolerance_scales(run.model.system().view).length;
  const auto tolerance = tolerance_of(settings.integrator, length);
  if (run.plan.dt > 0.0 || !tolerance) return std::numeric_limits<double>::infinity();
  const double part = std::max(*tolerance, last_place_of(settings.number_type));
  const double energy = std::max(found.kinetic, found.stored);
  const auto steps = static_cast<double>(run.clock.steps());
  return kTolerances * part * (found.work + found.heat + steps * energy);
}

}  // namespace

std::optional<Warning> doubt_of_balance(const SampledWork& found, bool sampled, RunContext& run) {
  const bool damped = found.heat > kNoHeat * found.stored;
  const double energy = std::max(found.kinetic, found.stored);
  const double scale = std::max(found.work, damped ? found.heat : energy);
  // A bath gives and takes: what is left in sum is then chance, and no scale.
  if (has_thermostat(*run.scene) && std::max(found.work, found.heat) < kNetFlow * energy) return {};
  const double numerical = std::abs(found.numerical);
  const double chance = std::max(kSurely * found.uncertainty, kRounding * found.stored);
  const double allowed = std::min(kNotSmall * scale, allowed_by_tolerance(found, run));
  if (!(numerical > allowed && numerical > chance)) return {};
  const std::string beside =
      damped ? fmt::format("a work of {:.2g} and a heat of {:.2g}", found.work, found.heat)
             : fmt::format("an energy of {:.2g}", found.stored);
  return Warning{FaultCode::run_energy_balance,
                 fmt::format("the energy balance does not close: the numerical work, which the "
                             "integrator adds by itself, is {}{:.2g} beside {}: take shorter steps "
                             "or finer tolerances{}",
                             sampled ? "about " : "", found.numerical, beside,
                             sampled ? "; ledger = true gives the whole balance" : "")};
}

EnergyBalance::EnergyBalance(const std::shared_ptr<const Scene>& scene, const RunOptions& options)
    : scene_(scene) {
  options_.instruction_set = options.instruction_set;
  options_.team = options.team;
  options_.start_from = options.start_from;
  options_.watches_energy = false;
  options_.checks_step = false;               // the run's own is checked
  options_.observables = {"energy.work_in"};  // it looks at steps for nothing else
}

EnergyBalance::~EnergyBalance() = default;

void EnergyBalance::attach(double* reals, std::int64_t* integers) {
  sums_ = reals;
  place_ = integers;
}

void EnergyBalance::start(double from, double to) {
  from_ = from;
  to_ = to;
}

void EnergyBalance::prepare(RunContext& run) {
  if (!(run.plan.dt > 0.0)) {
    strata_ = kAdaptiveStrata;
    steps_ = kAdaptiveSteps;
    return make_twin(run.state);
  }
  ledger_ = std::make_unique<BriefLedger>(run);
  const bool own = ledger_->can_be_kept();
  const double steps = (to_ - from_) / run.plan.dt;
  whole_ = steps < (own ? kShortWithLedger : kShort);
  strata_ = own && !whole_ ? static_cast<std::int64_t>(std::clamp(
                                 steps / kStepsInStratum, static_cast<double>(kFewestStrata),
                                 static_cast<double>(kFixedStrata)))
                           : kFixedStrata;
  steps_ = own && whole_   ? static_cast<std::uint64_t>(std::max(1.0, std::nearbyint(steps)))
           : own || whole_ ? kBlock
                           : kFixedSteps;
  if (own) return;
  ledger_ = nullptr;
  make_twin(run.state);
}

void EnergyBalance::make_twin(RunState& state) {
  try {
    twin_ = std::make_unique<Engine>(with_ledger(*scene_), options_);
    integrals_.assign(twin_->model().system().view.rates, 0.0);
    twin_->advance(1);  // what is allocated at the first step is
    twin_->take_up_from(state);
    if (twin_->failed()) twin_ = nullptr;
  } catch (const InputError&) {
    twin_ = nullptr;  // a force that no ledger can be kept of under this scheme
  } catch (const std::bad_alloc&) {
    twin_ = nullptr;  // of a scene that fills the memory
  }
}

/// When the block of a stratum begins at the earliest.
double EnergyBalance::time_of(std::int64_t stratum) const {
  if (stratum >= strata_) return std::numeric_limits<double>::infinity();
  const double part =
      0.5 + 0.5 * uniform_symmetric(kKey, {static_cast<std::uint64_t>(stratum), 0, 0, 0});
  return from_ +
         (to_ - from_) * (static_cast<double>(stratum) + part) / static_cast<double>(strata_);
}

std::uint64_t EnergyBalance::look(RunContext& run) {
  constexpr auto kAnyNumber = std::numeric_limits<std::uint64_t>::max();
  if (!looks()) return kAnyNumber;
  const double now = run.clock.time();
  if (place_[kOpen] != 0) {
    // Where an event has split a step there are more of them.
    const double left = sums_[kBlockEnd] - now;
    if (left > kNoStep * run.plan.dt && !run.outcome.done()) {
      if (ledger_) ledger_->keep(run, true);  // of a run that resumes within a block, once more
      return static_cast<std::uint64_t>(std::max(1.0, std::nearbyint(left / run.plan.dt)));
    }
    const bool there = std::abs(left) <= kNoStep * run.plan.dt && !run.outcome.failure;
    if (ledger_ && !there && run.outcome.interrupted) return kAnyNumber;  // a resumed run closes it
    ledger_ ? close_own(run, there) : close_of_twin(run, there);
  }
  if (known_ != place_[kStratum]) next_ = time_of(known_ = place_[kStratum]);
  if (now < (whole_ ? from_ : next_) || now >= to_ || run.outcome.done()) return kAnyNumber;
  if (run.plan.dt == 0.0) {
    open(run);
  } else if (run.block_ends()) {
    open(run);
    if (place_[kOpen] != 0) return steps_;
  }
  return kAnyNumber;
}

double EnergyBalance::idle_until(const RunContext& run) const {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const double now = run.clock.time();
  if (!looks()) return kNever;
  // On a grid a block has to end where the second engine has stopped.
  if (place_[kOpen] != 0) return run.plan.dt > 0.0 ? now : sums_[kBlockEnd];
  if (now >= to_) return kNever;
  if (known_ != place_[kStratum]) return now;
  return whole_ ? from_ : next_;
}

/// From here on the run keeps the ledger itself.
void EnergyBalance::open_own(RunContext& run) {
  const SystemView<double>& view = run.model.system().view;
  const std::int64_t last = run.clock.grid_steps() + static_cast<std::int64_t>(steps_);
  sums_[kBlockBegin] = run.clock.time();
  sums_[kBlockEnd] = std::min(static_cast<double>(last) * run.plan.dt, run.plan.duration);
  sums_[kBlockEnergy] = stored_energy(run);
  ledger_->keep(run, true);
  std::copy_n(view.integrals, view.rates, sums_ + kReals);
  place_[kOpen] = 1;
}

/// A block that the run has not come to the end of counts for nothing.
void EnergyBalance::close_own(RunContext& run, bool there) {
  EnergyTerms terms = ledger_->terms(run, sums_ + kReals, sums_[kBlockBegin]);
  ledger_->keep(run, false);
  place_[kOpen] = 0;
  if (!there) return;
  const double begin = sums_[kBlockBegin];
  const double end = run.clock.time();
  const double stored = stored_energy(run);
  terms.stored = stored - std::exchange(sums_[kBlockEnergy], stored);
  const SystemView<double>& view = run.model.system().view;
  count(terms, begin, end, kinetic_energy(run.model, view.position, view.velocity, end));
  close(terms.numerical());
}

void EnergyBalance::close_of_twin(RunContext& run, bool there) {
  const double energy = there ? stored_energy(run) : sums_[kBlockEnergy];
  close(sums_[kOpenWork] + (energy - sums_[kBlockEnergy]));
}

void EnergyBalance::open(RunContext& run) {
  if (ledger_) return open_own(run);
  twin_->take_up();
  const SystemView<double>& view = twin_->model().system().view;
  std::copy_n(view.integrals, view.rates, integrals_.data());
  const double begin = twin_->time();
  const double stored = stored_energy(twin_->context());
  twin_->advance(steps_);
  const double end = twin_->time();
  if (twin_->failed() || !(end > begin)) {
    place_[kDropped] = 1;  // the run itself will say why
    return;
  }
  EnergyTerms terms = energy_terms(twin_->model(), integrals_.data(), view.integrals, begin, end);
  sums_[kBlockEnergy] = stored_energy(twin_->context());
  terms.stored = sums_[kBlockEnergy] - stored;
  count(terms, begin, end, kinetic_energy(twin_->model(), view.position, view.velocity, end));
  sums_[kBlockEnd] = end;
  sums_[kOpenWork] = terms.numerical();
  if (run.plan.dt > 0.0) {
    place_[kOpen] = 1;
  } else {
    close(terms.numerical());
  }
}

/// A block that ends with the energy sums_[kBlockEnergy].
void EnergyBalance::count(const EnergyTerms& terms, double begin, double end, double kinetic) {
  // In parts of what the first block has, and times in parts of the window: squares stay numbers.
  if (sums_[kUnit] == 0.0) {
    const double size = std::max({std::abs(terms.work), std::abs(terms.heat),
                                  std::abs(terms.stored), std::abs(sums_[kBlockEnergy])});
    sums_[kUnit] = size > 0.0 ? std::ldexp(1.0, std::ilogb(size)) : 1.0;
  }

  // The block stands for its stratum, and for those that it reaches over.
  const std::int64_t first = place_[kStratum];
  std::int64_t& next = place_[kStratum];
  for (++next; next < strata_ && time_of(next) < end;) ++next;
  const double length = end - begin;
  const double stratum = (to_ - from_) / static_cast<double>(strata_);
  const double stands_for =
      whole_ ? length : std::max(length, stratum * static_cast<double>(next - first));
  const double weight = stands_for / length;
  sums_[kTime] += stands_for;
  sums_[kWork] += weight * terms.size_of_work;
  sums_[kHeat] += weight * terms.size_of_heat;
  sums_[kKinetic] += stands_for * kinetic;
  sums_[kStored] += stands_for * std::abs(sums_[kBlockEnergy]);
  sums_[kBlockLength] = length;
  sums_[kBlockWeight] = weight;
}

void EnergyBalance::close(double numerical) {
  const double weight = sums_[kBlockWeight];
  const double part = weight * sums_[kBlockLength] / (to_ - from_);
  const double rate = numerical / sums_[kUnit] * ((to_ - from_) / sums_[kBlockLength]);
  sums_[kNumerical] += weight * numerical;
  // The part of the stratum that was looked at has no uncertainty.
  const double unseen = part * part * (1.0 - 1.0 / weight);
  sums_[kSquares] += unseen * rate * rate;
  sums_[kCross] += unseen * rate;
  sums_[kWeights] += unseen;
  place_[kOpen] = 0;
  ++place_[kBlocks];
}

std::optional<SampledWork> EnergyBalance::found() const {
  if (place_[kBlocks] == 0) return {};
  const double time = sums_[kTime];
  const double whole = (to_ - from_) / time;
  SampledWork found;
  found.work = whole * sums_[kWork];
  found.heat = whole * sums_[kHeat];
  found.kinetic = sums_[kKinetic] / time;
  found.stored = sums_[kStored] / time;
  found.numerical = whole * sums_[kNumerical];
  if (sums_[kWeights] > 0.0) {
    if (place_[kBlocks] < kFewest) return {};
    const double mean = whole * sums_[kNumerical] / sums_[kUnit];
    const auto blocks = static_cast<double>(place_[kBlocks]);
    const double variance =
        sums_[kSquares] - 2.0 * mean * sums_[kCross] + mean * mean * sums_[kWeights];
    found.uncertainty =
        whole * sums_[kUnit] * std::sqrt(std::max(0.0, variance) * blocks / (blocks - 1.0));
  }
  return found;
}

}  // namespace tomlin
