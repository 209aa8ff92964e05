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
constexpr double kStepsOfShortRun = 16384.0;
constexpr double kStepsOfShortRunInArrays = 4096.0;
constexpr double kStepsOfShortRunWithSplitFriction = 1024.0;
/// Longer runs of the last two have more blocks, which find a force that is off by a fifth.
constexpr double kStepsInStratumInArrays = 125.0;
/// Numerical work beside the larger one of work and heat, or beside the energy where there is no
/// heat: a few per cent are what a coarse but sensible step costs.
constexpr double kNumericalWorkPart = 0.05;
/// Every step of an adaptive scheme may add its tolerance in parts of the energy, and flows have
/// errors in parts of theirs. All shipped scenes under dopri5, dop853 and radau9 stay below 100
/// such errors at tolerances of 1e-6 and finer.
constexpr double kTolerancesPerStep = 300.0;
/// Standard errors that a sampled numerical work has to be away from zero: slips are rare and
/// large, so that a few blocks decide.
constexpr double kStandardErrors = 4.0;
/// Heat, in parts of the energy, that is none: nothing damps, or friction has had no time to.
constexpr double kRoundingOfHeat = 1e-12;
/// Changes of the energy below this part of it are rounding.
constexpr double kRoundingOfEnergy = 1e-11;
/// Samples for a standard error.
constexpr std::int64_t kFewestSamples = 8;

/// Work or heat of fewer times the mean energy than this is no flow through a body in a bath.
constexpr double kNetFlowInEnergies = 100.0;

/// Key of the random positions of blocks: it is the same in every run, for reproducible results.
constexpr RandomKey kRandomKey{0x656e65726779, 0};

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
  return kTolerancesPerStep * part * (found.work + found.heat + steps * energy);
}

}  // namespace

std::optional<Warning> doubt_of_balance(const SampledWork& found, bool sampled, RunContext& run) {
  const bool damped = found.heat > kRoundingOfHeat * found.stored;
  const double energy = std::max(found.kinetic, found.stored);
  const double scale = std::max(found.work, damped ? found.heat : energy);
  // A bath gives and takes: what is left in sum is then chance, and no scale.
  if (has_thermostat(*run.scene) && std::max(found.work, found.heat) < kNetFlowInEnergies * energy)
    return {};
  const double numerical = std::abs(found.numerical);
  const double chance =
      std::max(kStandardErrors * found.uncertainty, kRoundingOfEnergy * found.stored);
  const double allowed = std::min(kNumericalWorkPart * scale, allowed_by_tolerance(found, run));
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

void EnergyBalance::declare(StateLayout& layout) const {
  layout.add_reals("energy_balance", kReals + run_.model.system().view.rates);
  layout.add_integers("energy_balance", kIntegers);
}

void EnergyBalance::attach(RunState& state) {
  sums_ = state.reals("energy_balance");
  progress_ = state.integers("energy_balance");
}

void EnergyBalance::prepare() {
  const bool fixed = run_.plan.dt > 0.0;
  const double steps = fixed ? (to_ - from_) / run_.plan.dt : 0.0;
  ledger_.emplace(run_);
  if (ledger_->can_be_kept()) {
    const bool split = ledger_->splits_friction();
    const bool in_registers = ledger_->is_in_registers() && !split;
    const bool whole = steps < (split          ? kStepsOfShortRunWithSplitFriction
                                : in_registers ? kStepsOfShortRun
                                               : kStepsOfShortRunInArrays);
    const double in_stratum = in_registers ? kStepsInStratum : kStepsInStratumInArrays;
    const double strata = std::clamp(steps / in_stratum, static_cast<double>(kFewestStrata),
                                     static_cast<double>(kMostSamples));
    stratum_ = std::max<std::int64_t>(std::llround(whole ? steps : steps / strata), 1);
    steps_ = whole ? stratum_ : kBlock;
    // Runs of a batch in lanes have the same rates from their start to their end.
    kept_throughout_ = whole && !split;
    if (kept_throughout_) ledger_->keep(true);
    return;
  }
  ledger_.reset();
  // Dense output shows friction that a scheme splits off at the ends of steps alone.
  const bool splits_friction = run_.model.system().view.flow_count > 0;
  if (has_thermostat(*run_.scene) || splits_friction || !find_heats()) return;
  const int each = std::max(run_.scheme.evaluations_per_step, 1);
  const double least = std::ceil(kEvaluationsOfStep / (kPartOfEvaluations * each));
  if (fixed && steps < static_cast<double>(kFewestSamples) * least) return;
  stratum_ = std::llround(std::max(least, steps / static_cast<double>(kMostSamples)));
  grows_ = !fixed;
}

/// False where one is not known: particles of prescribed bodies have velocities where a force reads
/// them.
bool EnergyBalance::find_heats() {
  const Model& model = run_.model;
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
  const SystemView<double>& view = run_.model.system().view;
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

std::int64_t EnergyBalance::idle_steps() {
  const double now = run_.clock.time();
  if (stratum_ == 0 || now < from_) return kNever;
  if (progress_[kOpen] == kYes && kept_throughout_) {
    const std::int64_t left = steps_ - (run_.clock.steps() - progress_[kBlockFirst]);
    const auto in_window = static_cast<std::int64_t>((to_ - now) / run_.plan.dt);
    return std::max<std::int64_t>(std::min(left, in_window), 0);
  }
  if (progress_[kOpen] != kNo) return 0;
  if (progress_[kStarted] == 0) {
    progress_[kStarted] = 1;
    progress_[kFirst] = run_.clock.steps();
  }
  const std::int64_t taken = run_.clock.steps() - progress_[kFirst];
  if (now <= to_) progress_[kSeen] = taken;
  if (!(now < to_) || run_.outcome.done()) return kNever;
  if (known_ != progress_[kStratum]) {
    known_ = progress_[kStratum];
    const auto stratum = static_cast<std::uint64_t>(known_);
    const double part = 0.5 + 0.5 * uniform_symmetric(kRandomKey, {stratum, 0, 0, 0});
    const auto offsets = static_cast<double>(length_of_stratum() - steps_ + 1);
    next_ = known_ + static_cast<std::int64_t>(part * offsets);
  }
  if (taken < next_) return next_ - taken;
  // Blocks of a run's own are whole ones, as other runs in lanes have them.
  return ledger_ && !run_.block_ends() ? kBlock - run_.clock.grid_steps() % kBlock : 0;
}

std::int64_t EnergyBalance::look() {
  if (progress_[kOpen] != kNo) {
    const std::int64_t left = go_on_with_block();
    if (left > 0) return left;
  }
  const std::int64_t idle = idle_steps();
  if (idle > 0) return idle;
  if (!ledger_) {
    sums_[kStoredEnergy] = stored_energy(run_);
    looks_into_step_ = true;
    return 1;
  }
  const bool lacks_first = !ledger_->is_kept() && ledger_->lacks_first_step();
  ledger_->keep(true);
  progress_[kOpen] = kFromNextStep;
  progress_[kBlockFirst] = run_.clock.steps();
  if (lacks_first) return 1;
  open_block();
  return steps_;
}

/// Returns how many steps are left of it; 0: it is closed.
std::int64_t EnergyBalance::go_on_with_block() {
  ledger_->keep(true);  // of a run that resumes within a block, once more
  const bool ends = !(run_.clock.time() < to_) || run_.outcome.done();
  const std::int64_t taken = run_.clock.steps() - progress_[kBlockFirst];
  if (ends && run_.outcome.interrupted) return kNever;  // a resumed run closes it
  if (progress_[kOpen] == kFromNextStep && !ends) {
    if (taken > 0) open_block();
    return taken > 0 ? steps_ : 1;
  }
  if (progress_[kOpen] == kYes && !ends && taken < steps_) return steps_ - taken;
  close_block(progress_[kOpen] == kYes ? taken : 0);
  return 0;
}

/// Accounts begin here.
void EnergyBalance::open_block() {
  const SystemView<double>& view = run_.model.system().view;
  sums_[kBlockBegin] = run_.clock.time();
  sums_[kStoredEnergy] = stored_energy(run_);
  std::copy_n(view.integrals, view.rates, sums_ + kReals);
  progress_[kOpen] = kYes;
  progress_[kBlockFirst] = run_.clock.steps();
}

/// A block in which the run has failed counts for nothing.
void EnergyBalance::close_block(std::int64_t steps) {
  const EnergyTerms terms = ledger_->terms(sums_ + kReals, sums_[kBlockBegin]);
  if (!kept_throughout_) ledger_->keep(false);
  progress_[kOpen] = kNo;
  if (steps > 0 && !run_.outcome.failure) count(terms, stored_energy(run_), steps);
}

void EnergyBalance::look_into(Observation& observation, const DoubleDouble& begin,
                              double next_since) {
  looks_into_step_ = false;
  const System<double>& system = run_.model.system();
  const std::uint64_t evaluations = system.evaluations;
  const std::uint64_t ahead = run_.integrator->evaluations_ahead();
  std::fill(sums_of_rates_.begin(), sums_of_rates_.end(), 0.0);
  std::fill(heat_sums_.begin(), heat_sums_.end(), 0.0);
  observation.at_nodes(begin, run_.clock.now(), next_since, {},
                       [&](const RunMoment& at, double weight) { add_node(at, weight); });
  // None of that is part of the run: the next step makes its first evaluation itself.
  if (run_.integrator->evaluations_ahead() > ahead) run_.integrator->rebased();
  run_.model.system().evaluations = evaluations;
  EnergyTerms terms = energy_terms(run_.model, none_.data(), sums_of_rates_.data(),
                                   static_cast<double>(begin), run_.clock.time());
  for (std::size_t k = 0; k < heats_.size(); ++k) {
    terms.add_out(heats_[k].of_energy, heat_sums_[k]);
  }
  count(terms, stored_energy(run_), 1);
}

void EnergyBalance::add_node(const RunMoment& at, double weight) {
  Model& model = run_.model;
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
void EnergyBalance::count(EnergyTerms terms, double stored, std::int64_t steps) {
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
  const SystemView<double>& view = run_.model.system().view;
  const double kinetic =
      kinetic_energy(run_.model, view.position, view.velocity, run_.clock.time());
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
    if (progress_[kSamples] < kFewestSamples) return {};
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
