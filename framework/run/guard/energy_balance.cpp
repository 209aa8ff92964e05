#include "framework/run/guard/energy_balance.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "framework/core/numbers/random.hpp"
#include "framework/core/system/tolerance.hpp"
#include "framework/model/force_twin.hpp"
#include "framework/run/context.hpp"
#include "framework/run/guard/brief_ledger.hpp"
#include "framework/run/guard/start_checks.hpp"
#include "framework/run/results/observation.hpp"
#include "framework/run/steps/gauss_rule.hpp"
#include "framework/scene/natural_units.hpp"

namespace tomlin {
namespace {

/// So many steps are sampled of a run whose number of steps is known.
constexpr std::int64_t kMostSamples = 128;
/// Later strata of an adaptive run have this part of the number of steps before them.
constexpr std::int64_t kEarlierInStratum = 128;
/// The most that looking into steps takes of a run's evaluations.
constexpr double kPartOfEvaluations = 0.04;
/// A sampled step costs its nodes and both ends, where energies cost as much as forces.
constexpr double kEvaluationsOfStep = 4.0 + kGaussNodes;
/// A block of the run's own, with the energies at both of its ends, costs a tip as much as some 25
/// of its steps: so many of them are in a stratum, but for runs that are little longer than short.
constexpr double kStepsInStratum = 1024.0;
constexpr std::int64_t kFewestStrata = 16;
/// Runs of fewer steps are looked at as a whole, with a ledger of their own. In registers that
/// costs a per cent or two of each step, in arrays up to eight. Schemes that split friction off
/// have no ledger in lanes of a sweep, where a run would take all these steps alone.
constexpr double kShort = 16384.0;
constexpr double kShortInArrays = 4096.0;
constexpr double kShortWithSplitFriction = 1024.0;
/// Longer runs of the last two have more blocks, which find a force that is off by a fifth.
constexpr double kStepsInStratumInArrays = 125.0;
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
/// Changes of the energy below this part of it are rounding.
constexpr double kRounding = 1e-11;
/// Samples for a standard error.
constexpr std::int64_t kFewest = 8;

/// Work or heat of fewer times the mean energy than this is no flow through a body in a bath.
constexpr double kNetFlow = 100.0;

/// Key of the random positions of blocks: it is the same in every run, for reproducible results.
constexpr RandomKey kKey{0x656e65726779, 0};

/// Returns the numerical work that the tolerance of an adaptive scheme allows; infinite where it
/// says nothing of it.
double allowed_by_tolerance(const SampledWork& found, const RunContext& run) {
  const RunSettings& settings = run.scene->run;
  const double length = tolerance_scales(run.model.system().view).length;
  const auto tolerance = tolerance_of(settings.integrator, length);
  if (run.plan.dt > 0.0 || !tolerance) return std::numeric_limits<double>::infinity();
  const double part = std::max(*tolerance, epsilon_of(settings.number_type));
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

EnergyBalance::EnergyBalance() = default;
EnergyBalance::~EnergyBalance() = default;

void EnergyBalance::attach(double* reals, std::int64_t* integers) {
  sums_ = reals;
  progress_ = integers;
}

void EnergyBalance::start(double from, double to) {
  from_ = from;
  to_ = to;
}

void EnergyBalance::prepare(RunContext& run) {
  const bool fixed = run.plan.dt > 0.0;
  const double steps = fixed ? (to_ - from_) / run.plan.dt : 0.0;
  ledger_ = std::make_unique<BriefLedger>(run);
  if (ledger_->can_be_kept()) {
    const bool split = ledger_->splits_friction();
    const bool in_registers = ledger_->is_in_registers() && !split;
    const bool whole = steps < (split          ? kShortWithSplitFriction
                                : in_registers ? kShort
                                               : kShortInArrays);
    const double in_stratum = in_registers ? kStepsInStratum : kStepsInStratumInArrays;
    const double strata = std::clamp(steps / in_stratum, static_cast<double>(kFewestStrata),
                                     static_cast<double>(kMostSamples));
    stratum_ = std::max<std::int64_t>(std::llround(whole ? steps : steps / strata), 1);
    steps_ = whole ? stratum_ : kBlock;
    // Runs of a batch in lanes have the same rates from their start to their end.
    kept_throughout_ = whole && !split;
    if (kept_throughout_) ledger_->keep(run, true);
    return;
  }
  ledger_ = nullptr;
  // Dense output shows friction that a scheme splits off at the ends of steps alone.
  const bool splits_friction = run.model.system().view.flow_count > 0;
  if (has_thermostat(*run.scene) || splits_friction || !find_heats(run)) return;
  const int each = std::max(run.scheme.evaluations_per_step, 1);
  const double least = std::ceil(kEvaluationsOfStep / (kPartOfEvaluations * each));
  if (fixed && steps < static_cast<double>(kFewest) * least) return;
  stratum_ = std::llround(std::max(least, steps / static_cast<double>(kMostSamples)));
  grows_ = !fixed;
}

/// False where one is not known: particles of prescribed bodies have velocities where a force reads
/// them.
bool EnergyBalance::find_heats(RunContext& run) {
  const Model& model = run.model;
  for (const Model::Force& force : model.forces()) {
    if (force.driver) continue;
    Heat heat;
    heat.of_energy = force.traits.conservative;
    if (!force.heat(static_cast<std::ptrdiff_t>(heats_.size()), heat.operation)) continue;
    const bool knows_velocities =
        heat.of_energy || force.traits.depends_on_velocity ||
        std::none_of(force.bodies.begin(), force.bodies.end(),
                     [&](std::size_t body) { return model.bodies()[body].prescribed(); });
    if (!knows_velocities) return false;
    heats_.push_back(heat);
  }
  const SystemView<double>& view = run.model.system().view;
  heat_rates_.assign(heats_.size() + 2 * kGroup, 0.0);
  heat_sums_.assign(heats_.size(), 0.0);
  velocity_.assign(view.dofs + 2 * kGroup, 0.0);
  none_.assign(view.rates, 0.0);
  sums_of_rates_.assign(view.rates, 0.0);
  return true;
}

std::int64_t EnergyBalance::length_of_stratum() const {
  const std::int64_t part = grows_ ? progress_[kStratum] / kEarlierInStratum : 0;
  return std::max(stratum_, part);
}

std::int64_t EnergyBalance::idle_steps(const RunContext& run) {
  const double now = run.clock.time();
  if (!looks() || now < from_) return kNever;
  if (progress_[kOpen] == kYes && kept_throughout_) {
    const std::int64_t left = steps_ - (run.clock.steps() - progress_[kBlockFirst]);
    const auto in_window = static_cast<std::int64_t>((to_ - now) / run.plan.dt);
    return std::max<std::int64_t>(std::min(left, in_window), 0);
  }
  if (progress_[kOpen] != kNo) return 0;
  if (progress_[kStarted] == 0) {
    progress_[kStarted] = 1;
    progress_[kFirst] = run.clock.steps();
  }
  const std::int64_t taken = run.clock.steps() - progress_[kFirst];
  if (now <= to_) progress_[kSeen] = taken;
  if (!(now < to_) || run.outcome.done()) return kNever;
  if (known_ != progress_[kStratum]) {
    known_ = progress_[kStratum];
    const auto stratum = static_cast<std::uint64_t>(known_);
    const double part = 0.5 + 0.5 * uniform_symmetric(kKey, {stratum, 0, 0, 0});
    const auto offsets = static_cast<double>(length_of_stratum() - steps_ + 1);
    next_ = known_ + static_cast<std::int64_t>(part * offsets);
  }
  if (taken < next_) return next_ - taken;
  // Blocks of a run's own are whole ones, as other runs in lanes have them.
  return ledger_ && !run.block_ends() ? kBlock - run.clock.grid_steps() % kBlock : 0;
}

std::int64_t EnergyBalance::look(RunContext& run) {
  if (progress_[kOpen] != kNo) {
    const std::int64_t left = go_on_with_block(run);
    if (left > 0) return left;
  }
  const std::int64_t idle = idle_steps(run);
  if (idle > 0) return idle;
  if (!ledger_) {
    sums_[kStoredEnergy] = stored_energy(run);
    looks_into_step_ = true;
    return 1;
  }
  const bool lacks_first = !ledger_->is_kept() && ledger_->lacks_first_step(run);
  ledger_->keep(run, true);
  progress_[kOpen] = kFromNextStep;
  progress_[kBlockFirst] = run.clock.steps();
  if (lacks_first) return 1;
  open_block(run);
  return steps_;
}

/// Returns how many steps are left of it; 0: it is closed.
std::int64_t EnergyBalance::go_on_with_block(RunContext& run) {
  ledger_->keep(run, true);  // of a run that resumes within a block, once more
  const bool ends = !(run.clock.time() < to_) || run.outcome.done();
  const std::int64_t taken = run.clock.steps() - progress_[kBlockFirst];
  if (ends && run.outcome.interrupted) return kNever;  // a resumed run closes it
  if (progress_[kOpen] == kFromNextStep && !ends) {
    if (taken > 0) open_block(run);
    return taken > 0 ? steps_ : 1;
  }
  if (progress_[kOpen] == kYes && !ends && taken < steps_) return steps_ - taken;
  close_block(run, progress_[kOpen] == kYes ? taken : 0);
  return 0;
}

/// Accounts begin here.
void EnergyBalance::open_block(RunContext& run) {
  const SystemView<double>& view = run.model.system().view;
  sums_[kBlockBegin] = run.clock.time();
  sums_[kStoredEnergy] = stored_energy(run);
  std::copy_n(view.integrals, view.rates, sums_ + kReals);
  progress_[kOpen] = kYes;
  progress_[kBlockFirst] = run.clock.steps();
}

/// A block in which the run has failed counts for nothing.
void EnergyBalance::close_block(RunContext& run, std::int64_t steps) {
  const EnergyTerms terms = ledger_->terms(run, sums_ + kReals, sums_[kBlockBegin]);
  if (!kept_throughout_) ledger_->keep(run, false);
  progress_[kOpen] = kNo;
  if (steps > 0 && !run.outcome.failure) count(run, terms, stored_energy(run), steps);
}

void EnergyBalance::look_into(RunContext& run, Observation& observation, const DoubleDouble& begin,
                              double next_since) {
  looks_into_step_ = false;
  const System<double>& system = run.model.system();
  const std::uint64_t evaluations = system.evaluations;
  const std::uint64_t ahead = run.integrator->evaluations_ahead();
  std::fill(sums_of_rates_.begin(), sums_of_rates_.end(), 0.0);
  std::fill(heat_sums_.begin(), heat_sums_.end(), 0.0);
  observation.at_nodes(begin, run.clock.now(), next_since, {},
                       [&](const RunMoment& at, double weight) { add_node(run, at, weight); });
  // None of that is part of the run: the next step makes its first evaluation itself.
  if (run.integrator->evaluations_ahead() > ahead) run.integrator->rebased();
  run.model.system().evaluations = evaluations;
  EnergyTerms terms = energy_terms(run.model, none_.data(), sums_of_rates_.data(),
                                   static_cast<double>(begin), run.clock.time());
  for (std::size_t k = 0; k < heats_.size(); ++k) {
    heats_[k].of_energy ? terms.add_work(-heat_sums_[k]) : terms.add_heat(heat_sums_[k]);
  }
  count(run, terms, stored_energy(run), 1);
}

void EnergyBalance::add_node(RunContext& run, const RunMoment& at, double weight) {
  Model& model = run.model;
  const SystemView<double>& view = model.system().view;
  for (std::size_t k = 0; k < sums_of_rates_.size(); ++k) {
    sums_of_rates_[k] = std::fma(weight, at.rates[k], sums_of_rates_[k]);
  }
  const double* velocity = at.velocity;
  if (!view.inertial) {
    model.drift_velocity(velocity_.data());
    velocity = velocity_.data();
  }
  place_velocities(model.bodies(), model.dimension(), at.position, velocity, view.mapped_velocity);
  const Stage<double> here =
      stage_of(view, at.position, velocity, at.integrals, heat_rates_.data(), at.elapsed);
  for (std::size_t k = 0; k < heats_.size(); ++k) {
    heats_[k].operation.run(heats_[k].operation.arguments, here);
    heat_sums_[k] = std::fma(weight, heat_rates_[k], heat_sums_[k]);
  }
}

/// Counts a sample of so many steps, which end with the energy `stored`.
void EnergyBalance::count(const RunContext& run, EnergyTerms terms, double stored,
                          std::int64_t steps) {
  terms.stored = stored - std::exchange(sums_[kStoredEnergy], stored);
  // Energies are counted in units of the first sample, so that their squares do not overflow.
  if (sums_[kUnit] == 0.0) {
    const double size = std::max(
        {std::abs(terms.work), std::abs(terms.heat), std::abs(terms.stored), std::abs(stored)});
    sums_[kUnit] = size > 0.0 ? std::ldexp(1.0, std::ilogb(size)) : 1.0;
  }

  // A sample stands for its stratum; the last one of a window may be all that there is of it.
  const std::int64_t stratum = length_of_stratum();
  progress_[kStratum] += stratum;
  const auto length = static_cast<double>(steps);
  const double stands_for = steps_ == stratum_ ? length : static_cast<double>(stratum);
  const double weight = stands_for / length;
  const SystemView<double>& view = run.model.system().view;
  const double kinetic = kinetic_energy(run.model, view.position, view.velocity, run.clock.time());
  const double numerical = terms.numerical();
  sums_[kSteps] += stands_for;
  sums_[kWork] += weight * terms.size_of_work;
  sums_[kHeat] += weight * terms.size_of_heat;
  sums_[kKinetic] += stands_for * kinetic;
  sums_[kStored] += stands_for * std::abs(stored);
  sums_[kNumerical] += weight * numerical;
  // The part of the stratum that was looked at has no uncertainty.
  const double unseen = stands_for * stands_for * (1.0 - 1.0 / weight);
  const double rate = numerical / (sums_[kUnit] * length);
  sums_[kSquares] += unseen * rate * rate;
  sums_[kCross] += unseen * rate;
  sums_[kWeights] += unseen;
  ++progress_[kSamples];
}

std::optional<SampledWork> EnergyBalance::found() const {
  if (progress_[kSamples] == 0) return {};
  const double steps = sums_[kSteps];
  const double whole = static_cast<double>(progress_[kSeen]) / steps;
  SampledWork found;
  found.work = whole * sums_[kWork];
  found.heat = whole * sums_[kHeat];
  found.kinetic = sums_[kKinetic] / steps;
  found.stored = sums_[kStored] / steps;
  found.numerical = whole * sums_[kNumerical];
  if (sums_[kWeights] > 0.0) {
    if (progress_[kSamples] < kFewest) return {};
    const double mean = sums_[kNumerical] / (sums_[kUnit] * steps);
    const auto samples = static_cast<double>(progress_[kSamples]);
    const double variance =
        sums_[kSquares] - 2.0 * mean * sums_[kCross] + mean * mean * sums_[kWeights];
    found.uncertainty =
        whole * sums_[kUnit] * std::sqrt(std::max(0.0, variance) * samples / (samples - 1.0));
  }
  return found;
}

}  // namespace tomlin
