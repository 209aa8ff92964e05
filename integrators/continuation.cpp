#include "integrators/continuation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "framework/core/numbers/math.hpp"
#include "framework/core/numbers/random.hpp"
#include "framework/core/system/scheme.hpp"
#include "framework/core/system/tolerance.hpp"
#include "integrators/equilibrium.hpp"
#include "integrators/path_step.hpp"

namespace tomlin {
namespace {

using Description = ContinuationDescription;

// Lengths of steps along the curve, in natural units (see Equilibrium).
constexpr double kFirstStep = 0.02;
constexpr double kLongest = 0.5;
constexpr double kShortest = 1e-10;
constexpr double kSafety = 0.9;
constexpr double kExponent = 0.125;  ///< the error is of eighth order
/// Between points the curve is at least so much closer than where it was foretold from them.
constexpr double kBetterThanForetold = 1e-2;
constexpr double kLeastError = 1e-6;
constexpr double kLeastFactor = 0.2;
constexpr double kMostFactor = 4.0;
constexpr double kFactorAfterFailure = 0.25;  ///< after Newton's method has failed
constexpr double kStretchToEnd = 1.5;         ///< of the time that is left
constexpr double kSlowestPace = 1e3;  ///< pace of a scene, for the one that it begins a branch with
constexpr double kWithoutFreedom = 4.0;  ///< pace of a scene where nothing is free, in steps

// Newton's method on a plane.
constexpr int kMostCorrections = 8;
constexpr double kQuadraticallyClose = 1e-8;  ///< its next correction is below rounding
constexpr double kRounding = 1e-13;
constexpr double kNoiseFactor = 30.0;
constexpr double kLargestContraction = 0.5;
/// The curve turns less than 60 degrees in a step.
constexpr double kSteepestTurn = 2.0;

/// Steps are searched for the curve's turning back at so many points.
constexpr int kSearchPoints = 64;
constexpr int kHalvings = 60;
/// A fold is found when time changes there by no more than this part of the way.
constexpr double kAtFold = 1e-7;
constexpr int kMostFoldTries = 4;
/// A bifurcation is bracketed to this part of a step.
constexpr double kBracket = 1e-8;
/// K must be positive before a fold by this part of the way to it from the last point.
constexpr double kJustBefore = 1e-3;
/// Below this part of its own unit time stands still, and velocities have no meaning.
constexpr double kNoTime = 1e-12;

// First displacements, in natural units.
constexpr double kPastFold = 1e-2;
constexpr double kOffUnstable = 1e-4;
constexpr double kRandomPart = 1e-3;
constexpr int kMostKicks = 10;
// Ties. Forces in units of the typical stiffness, times a natural unit.
constexpr double kUlpsOfForce = 16.0;  ///< below that rounding decides
/// Equilibria closer than this part of their distance from the start are one.
constexpr double kApart = 0.5;
constexpr double kNoDistance = 1e-9;
/// Forces that change by more than this part along the direction of instability break symmetry.
constexpr double kInCommon = 1e-4;
/// Random numbers of a run that is not disturbed.
constexpr RandomKey kUndisturbedKey{0, 2};
/// Numbers for the random force have positions of their own in their stream.
constexpr std::uint64_t kOfRandomForce = 8;
/// Slips in a row without any time between them.
constexpr std::int64_t kMostSlipsAtOnce = 1000;

class Continuation : public Integrator<double>, public EquilibriumPath, public ErrorControl {
 public:
  Continuation(const Description& description, System<double>& system)
      : Integrator<double>(system), d_(description), balance_(system), n_(balance_.size()) {
    d_.tolerance = std::max(d_.tolerance, kRounding);
    const std::size_t rates = system.view.rates;
    for (Node& node : nodes_) {
      node.position.assign(n_, 0.0);
      node.slope.assign(n_, 0.0);
    }
    for (auto& one : rates_of_step_) one.assign(rates + 2 * kGroup, 0.0);
    for (auto* vector : {&across_, &correction_, &along_time_, &foretold_, &kick_, &random_kick_,
                         &other_, &random_force_}) {
      vector->assign(n_, 0.0);
    }
    start_position_.assign(system.view.dofs, 0.0);
    start_integrals_.assign(rates, 0.0);
  }

  void declare(StateLayout& layout) override {
    layout.add_reals("continuation.control", kControls);
    layout.add_reals("continuation.slope", n_);
    layout.add_reals("continuation.force_in_time", n_);
    layout.add_reals("continuation.rates", system_.view.rates);
    layout.add_reals("continuation.equilibrium", balance_.control_count());
    layout.add_integers("continuation.counts", kCounts);
  }

  void attach(RunState& state) override {
    control_ = state.reals("continuation.control");
    slope_ = state.reals("continuation.slope");
    force_in_time_ = state.reals("continuation.force_in_time");
    end_rates_ = state.reals("continuation.rates");
    balance_.attach(state.reals("continuation.equilibrium"));
    counts_ = state.integers("continuation.counts");
  }

  Capabilities<double> capabilities() override { return {.path = this, .error_control = this}; }
  std::uint64_t refused_steps() const override {
    return static_cast<std::uint64_t>(counts_[kRefused]);
  }
  /// Drivers go another way: the tangent is another one.
  void forces_changed() override { counts_[kKnown] = 0; }

  // ---- the path

  StepFault settle(double ahead) override {
    control_[kNext] = kFirstStep;
    balance_.start_at(0.0);
    tied_.reset();
    std::fill(kick_.begin(), kick_.end(), 0.0);
    balance_.apply(nullptr);
    const StepFault fault = come_to_rest(0.0, ahead);
    if (fault != StepFault::none || n_ == 0 || !(disturbance_ > 0.0)) return fault;
    if (turns_freely()) return fault;
    find_random_force();
    balance_.apply(random_force_.data());
    std::fill(kick_.begin(), kick_.end(), 0.0);
    return come_to_rest(0.0, ahead);
  }

  bool ends() const override { return counts_[kEnd] != kGoesOn; }

  StepFault slip(double since, double ahead) override {
    balance_.start_at(since);
    std::fill(kick_.begin(), kick_.end(), 0.0);
    tied_.reset();
    if (counts_[kEnd] == kFold) {
      const double length = balance_.norm(slope_);
      for (std::size_t k = 0; k < n_; ++k) kick_[k] = kPastFold * slope_[k] / length;
    } else {
      balance_.linearise(kick_.data(), since);
      balance_.softest(kick_.data());
      choose_side(since);
    }
    const bool fold = counts_[kEnd] == kFold;
    counts_[kEnd] = kGoesOn;
    if (++counts_[kSlipsAtOnce] > kMostSlipsAtOnce) return StepFault::no_equilibrium;
    const StepFault fault = come_to_rest(since, ahead);
    jumped_ = fold || balance_.largest(foretold_.data()) > kPastFold;
    return fault;
  }

  bool jumped() const override { return jumped_; }

  std::optional<std::size_t> tied() const override { return tied_; }

  void disturb(double size, std::uint64_t seed, std::uint64_t stream) override {
    disturbance_ = size;
    random_ = {seed, stream};
  }

  double moment(std::size_t k, double* position, double* velocity, double* rates) const override {
    const double theta = static_cast<double>(k) / static_cast<double>(kMoments - 1);
    state_within(theta, position, velocity);
    const auto weight = rate_weights(theta);
    combine_rates(weight, rates);
    return k + 1 == kMoments ? 1.0 : std::min(1.0, time_within(theta) / taken_);
  }

  EquilibriumState state(double since) override {
    EquilibriumState state;
    balance_.start_at(since);
    std::fill(kick_.begin(), kick_.end(), 0.0);
    balance_.linearise(kick_.data(), since);
    balance_.find_neutral();
    state.neutral = balance_.neutral();
    balance_.describe(state.softest, state.log_determinant);
    for (std::size_t d = 0; d < state.neutral; ++d) {
      const double* direction = balance_.neutral(d);
      std::size_t most = 0;
      for (std::size_t k = 1; k < n_; ++k) {
        if (std::abs(direction[k] / balance_.unit(k)) >
            std::abs(direction[most] / balance_.unit(most))) {
          most = k;
        }
      }
      state.neutral_at.push_back(system_.tangent->coordinates()[most]);
    }
    return state;
  }

  // ---- steps

  StepReport step_from(double since, double rest, bool) override {
    const double h = std::min(rest, d_.largest_step);
    if (counts_[kKnown] == 0) begin_branch(since, rest);
    if (n_ == 0) control_[kPace] = kWithoutFreedom * h;
    start_step(since);
    double next = control_[kNext];
    for (;;) {
      if (counts_[kTaken] + counts_[kRefused] >= d_.most_steps) {
        return {0.0, StepFault::too_many_steps};
      }
      const double length = std::min({next, kLongest, kStretchToEnd * h / nodes_[0].time_slope});
      const std::optional<double> error = attempt(length, std::nullopt);
      if (!error || !(*error <= 1.0)) {
        ++counts_[kRefused];
        next = length * (error ? std::max(kLeastFactor, shrunk(*error)) : kFactorAfterFailure);
        if (!(next >= kShortest)) return {0.0, StepFault::step_too_small};
        continue;
      }
      const double factor = growth(length, *error);
      if (const auto end = cut(h)) {
        if (*end == kFailed) {
          ++counts_[kRefused];
          next = kFactorAfterFailure * length;
          if (!(next >= kShortest)) return {0.0, StepFault::step_too_small};
          continue;
        }
        counts_[kEnd] = *end;
      }
      control_[kNext] = std::max(factor * length, kShortest);
      control_[kOldLength] = length;
      control_[kOldError] = std::max(*error, kLeastError);
      return accept(h);
    }
  }

  const double* first_rates() const override { return rates_of_step_[0].data(); }
  void finish_dense_from(double) override {}

  void interpolate(double theta, double* position, double* velocity,
                   double* integrals) const override {
    const double fraction = when(theta * taken_);
    state_within(fraction, position, velocity);
    const SystemView<double>& view = system_.view;
    const auto weight = integral_weights(fraction);
    for (std::size_t k = 0; k < view.rates; ++k) {
      double sum = 0.0;
      for (std::size_t j = 0; j < kRateNodes; ++j) {
        sum = std::fma(weight[j] * time_slope_[j], rates_of_step_[j][k], sum);
      }
      integrals[k] = std::fma(length_, sum, start_integrals_[k]);
    }
  }

 private:
  enum { kNext, kPace, kFirstPace, kTimeSlope, kOldLength, kOldError, kControls };
  enum { kKnown, kTaken, kRefused, kEnd, kSlipsAtOnce, kCounts };
  enum End : std::int64_t { kGoesOn, kFold, kBifurcation, kFailed };

  /// A point of the curve relative to the step's start; slopes are with respect to the length along
  /// the first tangent.
  struct Node {
    std::vector<double> position;
    std::vector<double> slope;
    double time = 0.0;
    double time_slope = 0.0;
    std::size_t negative = 0;
  };

  static double shrunk(double error) {
    return error > 0.0 ? kSafety * pow(error, -kExponent) : kMostFactor;
  }

  /// From one step to the next; errors that have grown from the last step on will go on growing
  /// (Gustafsson's predictive controller).
  double growth(double length, double error) const {
    double factor = shrunk(error);
    if (control_[kOldLength] > 0.0) {
      const double trend = control_[kOldError] / std::max(error, kLeastError);
      factor = std::min(factor, factor * length / control_[kOldLength] * pow(trend, kExponent));
    }
    return std::clamp(factor, kLeastFactor, kMostFactor);
  }

  /// Weight of time in the length of the curve: what the scene moves by in it, in natural units.
  double speed() const { return 1.0 / control_[kPace]; }

  // ---- disturbances

  /// Whether there is a free rotation among the neutral directions: a displacement along it, which
  /// is straight, has restoring forces of higher order. A steady force does not rotate with the
  /// body and would orient it.
  bool turns_freely() {
    constexpr double kAway = 0.1;  // in natural units
    constexpr double kNoForce = 1e-6;
    balance_.start_at(0.0);
    for (std::size_t d = 0; d < balance_.neutral(); ++d) {
      const double* direction = balance_.neutral(d);
      for (std::size_t k = 0; k < n_; ++k) other_[k] = kAway * direction[k];
      balance_.evaluate(other_.data(), 0.0);
      for (std::size_t k = 0; k < n_; ++k) {
        const double force = std::abs(balance_.force()[k] * balance_.unit(k));
        if (!(force <= kNoForce * balance_.stiffness_scale())) return true;
      }
    }
    return false;
  }

  /// The steady force of a disturbed run: it would displace the equilibrium that the scene is in by
  /// a random vector, whose components are a quarter to three quarters of the disturbance. Streams
  /// of an odd number and the even one after it have opposite forces.
  ///
  /// A tilt e of a pitchfork a x^2/2 + b x^4/4 - e x leaves the equilibrium that it prefers stable
  /// throughout, and that further from all others than any small displacement reaches: at least
  /// 3 (e / 2b)^(1/3). Such a path loses its side only to a force above e.
  void find_random_force() {
    balance_.start_at(0.0);
    std::fill(other_.begin(), other_.end(), 0.0);
    balance_.linearise(other_.data(), 0.0);
    const RandomKey pair{random_.seed, (random_.stream + 1) / 2};
    const double size = random_.stream % 2 == 1 ? disturbance_ : -disturbance_;
    const double* in_units = tolerance_scales(system_.view).in_units;
    const auto& coordinates = system_.tangent->coordinates();
    for (std::size_t k = 0; k < n_; ++k) {
      const double x = uniform_symmetric(pair, {k, kOfRandomForce, 0, 0});
      const double part = 0.5 * x + (x < 0.0 ? -0.25 : 0.25);
      other_[k] = size / in_units[coordinates[k]] * part;
    }
    system_.tangent->times_stiffness(other_.data(), random_force_.data());
  }

  // ---- relaxing

  /// From the present state, displaced by `kick_`, to a stable rest.
  StepFault come_to_rest(double now, double ahead) {
    std::vector<double>& offset = foretold_;
    offset = kick_;
    bool decided = true;
    if (!relax(offset, now, 1.0, decided)) return StepFault::no_equilibrium;
    if (!decided) {
      // Once more, where what is random in a displacement is turned round.
      other_ = kick_start_;
      bool unused = true;
      if (relax(other_, now, -1.0, unused)) compare(offset, other_);
      balance_.linearise(offset.data(), now);
      balance_.find_neutral();
    }
    const auto& coordinates = system_.tangent->coordinates();
    for (std::size_t k = 0; k < n_; ++k) system_.view.position[coordinates[k]] += offset[k];
    begin_branch(now, ahead);
    return StepFault::none;
  }

  /// From an unstable rest it is displaced again, and something random has a say in it.
  bool relax(std::vector<double>& offset, double now, double sign, bool& decided) {
    kick_start_ = offset;
    for (int kicks = 0;; ++kicks) {
      if (!balance_.descend(offset.data(), now)) return false;
      balance_.linearise(offset.data(), now);
      balance_.find_neutral();
      const bool polished = balance_.polish(offset.data(), now);
      if (polished && (n_ == 0 || (balance_.factor(nullptr) && balance_.negative() == 0)))
        return true;
      if (kicks == kMostKicks) return false;
      decided = false;
      choose_kick(offset, now);
      for (std::size_t k = 0; k < n_; ++k) offset[k] += kick_[k] + sign * random_kick_[k];
    }
  }

  /// Two equilibria that are as near: a tie, if they are two.
  void compare(const std::vector<double>& one, const std::vector<double>& another) {
    for (std::size_t k = 0; k < n_; ++k) correction_[k] = one[k] - another[k];
    const double apart = balance_.norm(correction_.data());
    const double away = std::max(balance_.norm(one.data()), balance_.norm(another.data()));
    if (!(apart > kApart * away) || !(away > kNoDistance)) return;
    std::size_t most = 0;
    for (std::size_t k = 1; k < n_; ++k) {
      if (std::abs(correction_[k] / balance_.unit(k)) >
          std::abs(correction_[most] / balance_.unit(most))) {
        most = k;
      }
    }
    tied_ = system_.tangent->coordinates()[most];
  }

  /// Chooses the side on which a lost stability is left along the direction in `kick_`, of norm 1:
  /// the one that the force along it points to, or is going to point to. Where these are rounding
  /// both are tried; if two equilibria are found it is a tie, and the side is the one to which
  /// friction points when the drivers move slowly, or else an arbitrary one.
  void choose_side(double since) {
    double force = 0.0;
    double farthest = 1.0;
    const auto& coordinates = system_.tangent->coordinates();
    std::size_t most = 0;
    for (std::size_t k = 0; k < n_; ++k) {
      const double unit = balance_.unit(k);
      force = std::fma(balance_.force()[k], kick_[k], force);
      farthest = std::max(farthest, std::abs(system_.view.position[coordinates[k]]) / unit);
      if (std::abs(kick_[k] / unit) > std::abs(kick_[most] / balance_.unit(most))) most = k;
    }
    constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
    const double typical = balance_.stiffness_scale();
    const double rounding = kUlpsOfForce * kEpsilon * typical * farthest;
    // A fold is where forces change with time along the direction of instability.
    double along = 0.0;
    double change = typical / control_[kPace];
    for (std::size_t k = 0; k < n_; ++k) {
      along = std::fma(kick_[k], force_in_time_[k], along);
      change = std::max(change, std::abs(force_in_time_[k] * balance_.unit(k)));
    }
    const bool ahead = std::abs(along) > kInCommon * change;
    const bool known = std::abs(force) > rounding;
    const bool undecided = !ahead && !known;
    double side = (ahead && !known ? along : force) < 0.0 ? -1.0 : 1.0;
    if (undecided && disturbance_ > 0.0) {
      // To either side in turn, so that two streams of random numbers see both.
      side = (kick_[most] < 0.0) == (random_.stream % 2 == 1) ? 1.0 : -1.0;
    } else if (undecided) {
      side = side_of_friction(most);
    }
    for (double& x : kick_) x *= side * kOffUnstable;
    if (!undecided) return;
    // Both sides, from the same point.
    std::vector<double>& one = foretold_;
    std::vector<double>& another = other_;
    const std::vector<double> kick = kick_;
    bool unused = true;
    one = kick;
    for (std::size_t k = 0; k < n_; ++k) another[k] = -kick[k];
    if (relax(one, since, 1.0, unused) && relax(another, since, 1.0, unused)) compare(one, another);
    kick_ = kick;
  }

  /// Drag along the direction in `kick_` as the scene moves on; else a side that is always the
  /// same, its largest part (coordinate k) being positive.
  double side_of_friction(std::size_t k) {
    constexpr double kAboveRounding = 1e-9;
    system_.tangent->times_friction(slope_, correction_.data());
    double drag = 0.0;
    double size = 0.0;
    for (std::size_t i = 0; i < n_; ++i) {
      drag = std::fma(-correction_[i], kick_[i], drag);
      size = std::max(size, std::abs(correction_[i] * balance_.unit(i)));
    }
    if (std::abs(drag) > kAboveRounding * size) return drag < 0.0 ? -1.0 : 1.0;
    return kick_[k] < 0.0 ? -1.0 : 1.0;
  }

  /// The way that the drivers are going to push, and a little of everything.
  void choose_kick(const std::vector<double>& offset, double now) {
    constexpr double kFirstMoment = 1e-6;  // in the scene's time
    constexpr double kLastMoment = 1e18;
    constexpr double kPush = 1e-4;  // of the scale of forces
    balance_.evaluate(offset.data(), now);
    copy(balance_.force(), n_, correction_.data());
    double length = 0.0;
    for (double part = kFirstMoment; part < kLastMoment; part *= 10.0) {
      balance_.evaluate(offset.data(), now + part * tolerance_scales(system_.view).time);
      for (std::size_t k = 0; k < n_; ++k) {
        const double unit = balance_.unit(k);
        kick_[k] = (balance_.force()[k] - correction_[k]) * unit * unit;
      }
      length = balance_.norm(kick_.data());
      if (!(length < kPush * balance_.stiffness_scale())) break;
    }
    const bool pushed = length > 0.0 && std::isfinite(length);
    const bool turned = random_.stream == 1;
    for (std::size_t k = 0; k < n_; ++k) {
      kick_[k] = pushed ? kOffUnstable * kick_[k] / length : 0.0;
      random_kick_[k] = (turned ? -1.0 : 1.0) * kOffUnstable * kRandomPart * balance_.unit(k) *
                        uniform_symmetric(turned ? kUndisturbedKey : random_, {k, 0, 0, 0});
    }
  }

  /// The tangent, and what else is to be known, at an equilibrium that no step has come to.
  void begin_branch(double since, double ahead) {
    const double h = ahead > 0.0 ? ahead : tolerance_scales(system_.view).time;
    balance_.start_at(since);
    std::vector<double>& here = nodes_[0].position;
    std::fill(here.begin(), here.end(), 0.0);
    balance_.linearise(here.data(), since);
    balance_.find_neutral();
    copy(balance_.rates(), system_.view.rates, end_rates_);
    control_[kPace] = h;
    constexpr double kPartOfRun = 1e-3;
    for (const double pace : {kPartOfRun * h, 0.0}) {
      const double guess = pace > 0.0 ? pace : control_[kPace];
      balance_.look_at_time(here.data(), since, guess);
      balance_.evaluate(here.data(), since);
      balance_.time_derivative(here.data(), since, guess, force_in_time_);
      copy(force_in_time_, n_, correction_.data());
      if (n_ > 0 && balance_.factor(nullptr)) balance_.solve(correction_.data());
      const double speed = n_ > 0 ? balance_.norm(correction_.data()) : 0.0;
      control_[kPace] = speed > 1.0 / h ? 1.0 / speed : h;
    }
    copy(correction_.data(), n_, slope_);
    control_[kFirstPace] = control_[kPace];
    control_[kTimeSlope] = 1.0;
    control_[kOldLength] = 0.0;
    counts_[kKnown] = 1;
    const SystemView<double>& view = system_.view;
    std::fill(view.velocity, view.velocity + view.dofs, 0.0);
    const auto& coordinates = system_.tangent->coordinates();
    for (std::size_t k = 0; k < n_; ++k) view.velocity[coordinates[k]] = slope_[k];
  }

  // ---- one step

  void start_step(double since) {
    balance_.start_at(since);
    const SystemView<double>& view = system_.view;
    copy(view.position, view.dofs, start_position_.data());
    copy(view.integrals, view.rates, start_integrals_.data());
    copy(end_rates_, view.rates, rates_of_step_[0].data());
    since_ = since;
    Node& first = nodes_[0];
    const double moved = n_ > 0 ? balance_.norm(slope_) : 0.0;
    const double waited = speed() * control_[kTimeSlope];
    const double norm = std::sqrt(moved * moved + waited * waited);
    for (std::size_t k = 0; k < n_; ++k) {
      first.position[k] = 0.0;
      first.slope[k] = slope_[k] / norm;
      across_[k] = first.slope[k] / (balance_.unit(k) * balance_.unit(k));
    }
    first.time = 0.0;
    first.time_slope = control_[kTimeSlope] / norm;
    across_time_ = speed() * speed() * first.time_slope;
    first.negative = 0;
  }

  /// All points of a step of this length along the first tangent; the last at a given time where
  /// there is one. Its error by the tolerance; nothing when it cannot be made.
  std::optional<double> attempt(double length, std::optional<double> end_time) {
    length_ = length;
    for (std::size_t j = 1; j < kPathNodes; ++j) {
      const HermiteWeights weights(j, path_node(j));
      Node& node = nodes_[j];
      combine(weights.value, weights.slope, j, node.position.data(), node.time);
      const bool last = j + 1 == kPathNodes;
      if (last) {
        foretold_ = node.position;
        foretold_time_ = node.time;
      }
      const bool at_time = last && end_time;
      if (at_time) node.time = *end_time;
      if (!correct(node, path_node(j) * length, at_time)) return std::nullopt;
      copy(balance_.rates(), system_.view.rates, rates_of_step_[2 * j].data());
      if (!find_tangent(node)) return std::nullopt;
    }
    const Node& last = nodes_[kPathNodes - 1];
    for (std::size_t k = 0; k < n_; ++k) correction_[k] = last.position[k] - foretold_[k];
    double error = n_ > 0 ? balance_.largest(correction_.data()) : 0.0;
    error = std::max(error, speed() * std::abs(last.time - foretold_time_));
    return kBetterThanForetold * error / std::max(d_.tolerance, kNoiseFactor * balance_.noise());
  }

  /// F(q, t) = 0 on the plane at `length`, or at the node's time.
  bool correct(Node& node, double length, bool at_time) {
    double before = std::numeric_limits<double>::infinity();
    const double noise = kNoiseFactor * balance_.noise();
    const double enough =
        std::max(std::clamp(0.1 * d_.tolerance, kRounding, kQuadraticallyClose), noise);
    if (n_ == 0) {
      if (!at_time) node.time = length / across_time_;
      balance_.evaluate(node.position.data(), since_ + node.time);
      return true;
    }
    for (int k = 0; k < kMostCorrections; ++k) {
      balance_.linearise(node.position.data(), since_ + node.time);
      double off = length - across_time_ * node.time;
      for (std::size_t i = 0; i < n_; ++i) off = std::fma(-across_[i], node.position[i], off);
      double in_time = 0.0;
      if (!solve_plane(off, at_time, in_time)) return false;
      const double size =
          std::max(balance_.largest(correction_.data()), speed() * std::abs(in_time));
      if (!(size <= kLongest) || (k > 1 && size > kLargestContraction * before && size > enough)) {
        return false;
      }
      if (size <= kRounding) return true;
      for (std::size_t i = 0; i < n_; ++i) node.position[i] += correction_[i];
      node.time += in_time;
      if (size <= enough) {
        balance_.evaluate(node.position.data(), since_ + node.time);
        return true;
      }
      before = size;
    }
    return false;
  }

  /// K dq = F + F_t dt with across.dq + across_time dt = off; or dt = 0. Leaves dq in correction_.
  /// K and the plane are factored together: K alone is singular at a fold.
  bool solve_plane(double off, bool at_time, double& in_time) {
    copy(balance_.force(), n_, correction_.data());
    if (at_time) {
      if (!balance_.factor(nullptr)) return false;
      balance_.solve(correction_.data());
      in_time = 0.0;
      return true;
    }
    if (!balance_.factor(across_.data())) return false;
    const double weight = balance_.stiffness_scale();
    for (std::size_t i = 0; i < n_; ++i) {
      correction_[i] += weight * off * across_[i];
      along_time_[i] = force_in_time_[i] - weight * across_time_ * across_[i];
    }
    balance_.solve(correction_.data());
    balance_.solve(along_time_.data());
    double numerator = off;
    double denominator = across_time_;
    for (std::size_t i = 0; i < n_; ++i) {
      numerator = std::fma(-across_[i], correction_[i], numerator);
      denominator = std::fma(across_[i], along_time_[i], denominator);
    }
    in_time = numerator / denominator;
    for (std::size_t i = 0; i < n_; ++i) {
      correction_[i] = std::fma(in_time, along_time_[i], correction_[i]);
    }
    return std::isfinite(in_time);
  }

  /// The tangent at a point that has been corrected, and its stability.
  bool find_tangent(Node& node) {
    if (n_ == 0) {
      node.time_slope = 1.0 / across_time_;
      return true;
    }
    balance_.time_derivative(node.position.data(), since_ + node.time, control_[kFirstPace],
                             force_in_time_);
    if (!balance_.factor(across_.data())) return false;
    const double weight = balance_.stiffness_scale();
    for (std::size_t i = 0; i < n_; ++i) {
      correction_[i] = weight * across_[i];
      along_time_[i] = force_in_time_[i] - weight * across_time_ * across_[i];
    }
    balance_.solve(correction_.data());
    balance_.solve(along_time_.data());
    double numerator = 1.0;
    double denominator = across_time_;
    for (std::size_t i = 0; i < n_; ++i) {
      numerator = std::fma(-across_[i], correction_[i], numerator);
      denominator = std::fma(across_[i], along_time_[i], denominator);
    }
    node.time_slope = numerator / denominator;
    for (std::size_t i = 0; i < n_; ++i) {
      node.slope[i] = std::fma(node.time_slope, along_time_[i], correction_[i]);
    }
    const double steepness =
        std::max(balance_.largest(node.slope.data()), speed() * std::abs(node.time_slope));
    if (!(steepness <= kSteepestTurn)) return false;
    node.negative = balance_.factor(nullptr) ? balance_.negative() : 1;
    return true;
  }

  // ---- where a step ends

  /// Finds what is first within the step that has been made: the end of its time, a fold, or other
  /// loss of stability. The step is then made anew up to there. Nothing: it stands as it is.
  std::optional<End> cut(double h) {
    const double fold = first_zero([this](double theta) { return time_slope_within(theta); });
    const double end = first_zero([this, h](double theta) { return h - time_within(theta); });
    const double unstable = first_unstable(fold);
    if (end < fold && end < unstable) {
      const End kind = end_in_time(end, h);
      // Stability may have been lost between the last stable point and the end of the time.
      const double lost = kind == kGoesOn ? first_unstable(2.0) : 2.0;
      return lost <= 1.0 ? end_at_bifurcation(last_before(lost), lost) : kind;
    }
    if (fold < unstable) {
      const double before = fold - kJustBefore * (fold - last_before(fold));
      if (is_held_at(before)) return end_at_fold(fold);
      return end_at_bifurcation(last_before(before), before);
    }
    if (unstable <= 1.0) return end_at_bifurcation(last_before(unstable), unstable);
    return std::nullopt;
  }

  /// The first of the step's points before a fold where K is not positive; 2 where there is none.
  double first_unstable(double fold) const {
    for (std::size_t j = 1; j < kPathNodes; ++j) {
      if (nodes_[j].negative > 0 && path_node(j) < fold) return path_node(j);
    }
    return 2.0;
  }

  static double last_before(double theta) {
    double before = 0.0;
    for (std::size_t j = 1; j < kPathNodes; ++j) {
      if (path_node(j) < theta) before = path_node(j);
    }
    return before;
  }

  End end_in_time(double theta, double h) {
    const auto error = attempt(theta * length_, h);
    return error && *error <= 1.0 ? kGoesOn : kFailed;
  }

  /// The time of a fold is stationary: an error of its position counts squared.
  End end_at_fold(double theta) {
    double length = theta * length_;
    for (int tries = 0; tries < kMostFoldTries; ++tries) {
      const auto error = attempt(length, std::nullopt);
      if (!error || !(*error <= 1.0)) return kFailed;
      const Node& last = nodes_[kPathNodes - 1];
      if (speed() * std::abs(last.time_slope) <= kAtFold) break;
      const Node& before = nodes_[kPathNodes - 2];
      const double interval = (1.0 - path_node(kPathNodes - 2)) * length;
      length -= last.time_slope * interval / (last.time_slope - before.time_slope);
    }
    return kFold;
  }

  /// By halving, up to where the equilibrium is just unstable. There K is singular, and points can
  /// no longer be corrected: the step's own polynomial is what there is.
  End end_at_bifurcation(double stable, double unstable) {
    while (unstable - stable > kBracket) {
      const double middle = 0.5 * (stable + unstable);
      (is_held_at(middle) ? stable : unstable) = middle;
    }
    restrict_to(unstable);
    return kBifurcation;
  }

  /// Whether K is positive there, on the step's polynomial.
  bool is_held_at(double theta) {
    double time = 0.0;
    const HermiteWeights weights(kPathNodes, theta);
    combine(weights.value, weights.slope, kPathNodes, foretold_.data(), time);
    balance_.linearise(foretold_.data(), since_ + time);
    return balance_.factor(nullptr) && balance_.negative() == 0;
  }

  /// The step up to theta, as it is interpolated.
  void restrict_to(double theta) {
    std::array<Node, kPathNodes> part;
    for (std::size_t j = 0; j < kPathNodes; ++j) {
      Node& node = part[j];
      const HermiteWeights weights(kPathNodes, theta * path_node(j));
      node.position.resize(n_);
      node.slope.resize(n_);
      combine(weights.value, weights.slope, kPathNodes, node.position.data(), node.time);
      combine(weights.value_of_slope, weights.slope_of_slope, kPathNodes, node.slope.data(),
              node.time_slope);
      for (double& slope : node.slope) slope /= length_;
      node.time_slope /= length_;
    }
    nodes_ = std::move(part);
    length_ *= theta;
    for (std::size_t j = 1; j < kPathNodes; ++j) {
      balance_.evaluate(nodes_[j].position.data(), since_ + nodes_[j].time);
      copy(balance_.rates(), system_.view.rates, rates_of_step_[2 * j].data());
    }
  }

  /// The first theta in (0, 1] where a function that starts above zero reaches it; 2 where it does
  /// not. A dip between two looks is found by its lowest point.
  template <class Function>
  static double first_zero(Function function) {
    double thetas[3] = {0.0, 0.0, 0.0};
    double values[3] = {0.0, 0.0, 0.0};
    for (int k = 0; k <= kSearchPoints; ++k) {
      const double theta = static_cast<double>(k) / kSearchPoints;
      std::rotate(thetas, thetas + 1, thetas + 3);
      std::rotate(values, values + 1, values + 3);
      thetas[2] = theta;
      values[2] = function(theta);
      if (k == 0) continue;
      if (k > 1 && values[1] < values[0] && values[1] < values[2] && values[2] > 0.0) {
        const double lowest = lowest_point(function, thetas[0], thetas[2]);
        if (function(lowest) <= 0.0) return crossing(function, thetas[0], lowest);
      }
      if (values[2] <= 0.0) return crossing(function, thetas[1], thetas[2]);
    }
    return 2.0;
  }

  template <class Function>
  static double lowest_point(Function function, double low, double high) {
    constexpr double kGolden = 0.38196601125010515;
    for (int k = 0; k < kHalvings; ++k) {
      const double a = low + kGolden * (high - low);
      const double b = high - kGolden * (high - low);
      (function(a) < function(b) ? high : low) = function(a) < function(b) ? b : a;
    }
    return 0.5 * (low + high);
  }

  template <class Function>
  static double crossing(Function function, double above, double below) {
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = 0.5 * (above + below);
      (function(middle) > 0.0 ? above : below) = middle;
    }
    return below;
  }

  StepReport accept(double h) {
    const Node& last = nodes_[kPathNodes - 1];
    const bool whole = std::abs(last.time - h) <= kRounding * h;
    taken_ = whole ? h : last.time;
    if (!(taken_ > 0.0)) taken_ = std::numeric_limits<double>::min();
    evaluate_between();
    SystemView<double>& view = system_.view;
    const auto weight = integral_weights(1.0);
    for (std::size_t k = 0; k < view.rates; ++k) {
      double sum = 0.0;
      for (std::size_t j = 0; j < kRateNodes; ++j) {
        sum = std::fma(weight[j] * time_slope_[j], rates_of_step_[j][k], sum);
      }
      view.integrals[k] = std::fma(length_, sum, start_integrals_[k]);
    }
    state_within(1.0, view.position, view.velocity);
    copy(last.slope.data(), n_, slope_);
    control_[kTimeSlope] = last.time_slope;
    copy(rates_of_step_[kRateNodes - 1].data(), view.rates, end_rates_);
    slow_down(last);
    if (speed() * taken_ > kNoTime) counts_[kSlipsAtOnce] = 0;
    ++counts_[kTaken];
    return {taken_, StepFault::none};
  }

  /// A branch may begin where the scene is soft and moves fast. As long as the way weighs more than
  /// time does, the curve has no sharp bends.
  void slow_down(const Node& last) {
    const double moved = n_ > 0 ? balance_.norm(last.position.data()) : 0.0;
    const double slowest = kSlowestPace * control_[kFirstPace];
    if (control_[kPace] * moved < taken_) {
      control_[kPace] = moved * slowest > taken_ ? taken_ / moved : slowest;
    }
  }

  /// Rates at the points between the nodes, on the polynomial.
  void evaluate_between() {
    for (std::size_t j = 0; j < kRateNodes; ++j) {
      if (j % 2 == 0) {
        time_slope_[j] = nodes_[j / 2].time_slope;
        continue;
      }
      const HermiteWeights weights(kPathNodes, kRateNode[j]);
      double time = 0.0;
      combine(weights.value, weights.slope, kPathNodes, foretold_.data(), time);
      balance_.evaluate(foretold_.data(), since_ + time);
      copy(balance_.rates(), system_.view.rates, rates_of_step_[j].data());
      time_slope_[j] = time_slope_within(kRateNode[j]);
    }
  }

  // ---- within a step

  template <class Weights>
  void combine(const Weights& value, const Weights& slope, std::size_t count, double* position,
               double& time) const {
    time = 0.0;
    for (std::size_t k = 0; k < n_; ++k) position[k] = 0.0;
    for (std::size_t j = 0; j < count; ++j) {
      const Node& node = nodes_[j];
      time += value[j] * node.time + length_ * slope[j] * node.time_slope;
      for (std::size_t k = 0; k < n_; ++k) {
        position[k] += value[j] * node.position[k] + length_ * slope[j] * node.slope[k];
      }
    }
  }

  double time_within(double theta) const {
    const HermiteWeights weights(kPathNodes, theta);
    double time = 0.0;
    for (std::size_t j = 0; j < kPathNodes; ++j) {
      time += weights.value[j] * nodes_[j].time + length_ * weights.slope[j] * nodes_[j].time_slope;
    }
    return time;
  }

  double time_slope_within(double theta) const {
    const HermiteWeights weights(kPathNodes, theta);
    double slope = 0.0;
    for (std::size_t j = 0; j < kPathNodes; ++j) {
      slope += weights.value_of_slope[j] * nodes_[j].time / length_ +
               weights.slope_of_slope[j] * nodes_[j].time_slope;
    }
    return slope;
  }

  /// Fraction of the step at a time since its start.
  double when(double time) const {
    if (time <= 0.0) return 0.0;
    if (time >= taken_) return 1.0;
    double low = 0.0;
    double high = 1.0;
    double theta = time / taken_;
    for (int k = 0; k < kHalvings; ++k) {
      const double ahead = time_within(theta) - time;
      if (ahead == 0.0) break;
      (ahead > 0.0 ? high : low) = theta;
      const double newton = theta - ahead / (length_ * time_slope_within(theta));
      const double next = newton > low && newton < high ? newton : 0.5 * (low + high);
      if (next == theta) break;
      theta = next;
    }
    return theta;
  }

  void state_within(double theta, double* position, double* velocity) const {
    const SystemView<double>& view = system_.view;
    const HermiteWeights weights(kPathNodes, theta);
    const double per_time = 1.0 / std::max(time_slope_within(theta), kNoTime / speed());
    if (position != start_position_.data()) copy(start_position_.data(), view.dofs, position);
    std::fill(velocity, velocity + view.dofs, 0.0);
    const auto& coordinates = system_.tangent->coordinates();
    for (std::size_t k = 0; k < n_; ++k) {
      double offset = 0.0;
      double slope = 0.0;
      for (std::size_t j = 0; j < kPathNodes; ++j) {
        const Node& node = nodes_[j];
        offset += weights.value[j] * node.position[k] + length_ * weights.slope[j] * node.slope[k];
        slope += weights.value_of_slope[j] * node.position[k] / length_ +
                 weights.slope_of_slope[j] * node.slope[k];
      }
      position[coordinates[k]] += offset;
      velocity[coordinates[k]] = slope * per_time;
    }
  }

  void combine_rates(const std::array<double, kRateNodes>& weight, double* rates) const {
    for (std::size_t k = 0; k < system_.view.rates; ++k) {
      double sum = 0.0;
      for (std::size_t j = 0; j < kRateNodes; ++j) {
        sum = std::fma(weight[j], rates_of_step_[j][k], sum);
      }
      rates[k] = sum;
    }
  }

  static void copy(const double* from, std::size_t n, double* to) { std::copy(from, from + n, to); }

  Description d_;
  Equilibrium balance_;
  std::size_t n_;

  // In the run state.
  double* control_ = nullptr;
  double* slope_ = nullptr;
  double* force_in_time_ = nullptr;  ///< dF/dt, [n]
  double* end_rates_ = nullptr;
  std::int64_t* counts_ = nullptr;

  // The last step.
  std::array<Node, kPathNodes> nodes_;
  std::array<AlignedVector<double>, kRateNodes> rates_of_step_;
  std::array<double, kRateNodes> time_slope_{};
  std::vector<double> start_position_;
  std::vector<double> start_integrals_;
  double since_ = 0.0;
  double taken_ = 0.0;
  double length_ = 0.0;

  // The planes across the first tangent, and scratch.
  std::vector<double> across_;
  double across_time_ = 0.0;
  std::vector<double> correction_;
  std::vector<double> along_time_;
  std::vector<double> foretold_;
  double foretold_time_ = 0.0;
  std::vector<double> kick_;
  std::vector<double> random_kick_;
  std::vector<double> kick_start_;  ///< displacement that the last relaxation began with
  std::vector<double> other_;
  bool jumped_ = false;
  std::optional<std::size_t> tied_;
  double disturbance_ = 0.0;
  std::vector<double> random_force_;  ///< the same in all of a run
  RandomKey random_ = kUndisturbedKey;
};

double no_fixed_step(const void*) { return 0.0; }

double any_step(double, double) { return std::numeric_limits<double>::infinity(); }

double tolerance(const void* description) {
  return static_cast<const Description*>(description)->tolerance;
}

std::vector<Complaint> complaints(const void*) { return {}; }

std::unique_ptr<Integrator<double>> bind(const void* description, System<double>& system) {
  return std::make_unique<Continuation>(*static_cast<const Description*>(description), system);
}

std::int64_t most_steps(const void* description) {
  return static_cast<const Description*>(description)->most_steps;
}

}  // namespace

IntegratorRecord continuation_record() {
  IntegratorRecord record;
  record.name = "continuation";
  record.summary = "follows equilibria as drivers move, and slips where they end: quasistatic";
  record.equation = "F(q, t) = 0 with K = -dF/dq > 0, by pseudo-arclength; slips: G dq/dt = F(q)";
  record.source =
      "E. L. Allgower and K. Georg, Introduction to Numerical Continuation Methods (SIAM, "
      "2003), doi:10.1137/1.9780898719154; H. B. Keller, Numerical solution of bifurcation "
      "and nonlinear eigenvalue problems, in Applications of Bifurcation Theory, edited by P."
      " H. Rabinowitz (Academic Press, 1977) 359";
  record.order = 8;
  record.adaptive = true;
  record.evaluations_per_step = 20;
  record.needs_tangent = true;
  record.follows_equilibria = true;
  record.make_description = &make_description<Description>;
  record.parameters = {
      parameter(
          "tolerance", &Description::tolerance, dimension::none,
          "largest error per step, as a part of a lattice period (or half the shortest bond); "
          "1e-13 at least")
          .in(positive)
          .by_default(1e-9),
      parameter("largest_step", &Description::largest_step, dimension::time, "never step further")
          .in(positive)
          .by_default(1e300),
      parameter("most_steps", &Description::most_steps, dimension::none,
                "a run that needs more fails")
          .in(positive)
          .by_default(std::int64_t{10'000'000})};
  record.step = &no_fixed_step;
  record.stable_step = &any_step;
  record.tolerance = &tolerance;
  record.most_steps = &most_steps;
  record.complaints = &complaints;
  record.bind = {&bind};
  record.example = R"(# A tip that sticks and slips, driven infinitely slowly.
[[body]]
type = "point"
position = [0.0]
particle_mass = 1.0

[[force]]
type = "driving_spring"
stiffness = 1.0
velocity = [1.0]

[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0

[run]
dynamics = "quasistatic"
duration = 4.0
integrator = { type = "continuation", tolerance = 1e-9 }
ledger = true

[measure]
from = 2.0
to = 4.0
in = "driver_periods"
)";
  return record;
}

}  // namespace tomlin
