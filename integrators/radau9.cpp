#include "integrators/radau9.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "framework/core/numbers/math.hpp"
#include "framework/core/records/integrator.hpp"
#include "framework/core/system/aligned.hpp"
#include "framework/core/system/evaluate.hpp"
#include "framework/core/system/scheme.hpp"
#include "framework/core/system/tolerance.hpp"
#include "integrators/adaptive.hpp"
#include "integrators/radau9_tableau.hpp"

namespace tomlin {
namespace {

using Description = AdaptiveDescription;
using Tableau = Radau9Tableau;
constexpr int kStages = Tableau::stages;
constexpr int kLast = kStages - 1;

// Step control. The constants were chosen on the rolling ring, where they cost least.
constexpr double kSafety = 0.75;
constexpr double kExponent = 1.0 / 6.0;  ///< the error is of order h^6
constexpr double kLeastFactor = 0.2;
constexpr double kMostFactor = 4.0;
constexpr double kLeastOldError = 1e-2;
constexpr double kFactorAfterNoSolution = 0.4;
/// The first step moves coordinates by so many tolerances, at its first slope.
constexpr double kFirstMove = 100.0;

// Newton's iterations.
constexpr int kMostIterations = 10;
constexpr double kIterationError = 0.01;      ///< largest when they end, as a part of the tolerance
constexpr double kSingleCorrection = 1e-3;    ///< of that: below it the first correction suffices
constexpr double kLargestContraction = 0.99;  ///< ratio of corrections: above it they diverge
/// K and G are taken at this part of a step: early ones converge slowly, late ones rest on guesses.
constexpr double kLinearisedAt = 0.75;
/// Most growth in a step: ln of the factor.
constexpr double kMostGrowth = 2.0;
constexpr int kMostHalvings = 200;
/// A polynomial leads so many of its steps ahead, and no further.
constexpr double kMostStepsAhead = 8.0;
/// Corrections of this part of a number are rounding.
constexpr double kRounding = 1e-13;

/// The integral of the polynomial that is 1 at the start and 0 at the nodes, by x.
constexpr double kRestOfStart[] = {1.0, -12.5, 50.0, -87.5, 70.0, -21.0};

// Running integrals. Their error is of order h^10 in a step, that of coordinates h^6.
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kIntegralsExponent = 0.6;
constexpr double kDenseExponent = 0.85;       ///< within a step, of order h^7
constexpr double kIntegralsTolerance = 10.0;  ///< in tolerances, of what is dissipated
/// A step shorter than this part of a period may err by as much as one of that length: where rates
/// jump, by a force or by what the last step's iterations left over, the error is in proportion to
/// the step, and so is what the step dissipates.
constexpr double kPartOfPeriod = 1e-4;
constexpr double kIterationErrorOfIntegrals = 0.1;  ///< as a part of their tolerance
constexpr int kMoreIterations = 10;                 ///< for them, where coordinates need no more
/// Roundings of a coordinate, and of a rate.
constexpr double kUlpsOfCoordinate = 16.0;
/// Corrections that shrink no faster, and are no larger, are rounding, too.
constexpr double kContractionOfRounding = 0.5;
constexpr double kMostUlps = 1e3;
constexpr double kUlpsOfRate = 8.0;
constexpr double kUlpsOfDifferences = 64.0;  ///< where a soft scene makes more of them

class Radau9 : public Integrator<double>, public ErrorControl, public DenseRates {
 public:
  Radau9(const Description& description, System<double>& system)
      : Integrator<double>(system),
        d_(description),
        scales_(tolerance_scales(system.view)),
        tangent_(*system.tangent),
        at_(tangent_.coordinates()),
        n_(at_.size()),
        width_(system.view.inertial ? 2 * n_ : n_),
        pairs_{tangent_.shifted(), tangent_.shifted()} {
    const SystemView<double>& s = system_.view;
    d_.absolute_tolerance /= scales_.length;
    tolerance_ = kIntegralsTolerance * std::max(d_.absolute_tolerance, d_.relative_tolerance);
    for (int i = 0; i < kStages; ++i) {
      z_[i].assign(width_, 0.0);
      slope_[i].assign(width_, 0.0);
      mode_[i].assign(width_, 0.0);
      rates_[i].assign(s.rates + kGap, 0.0);
      own_[i].assign(s.own + kGap, 0.0);
    }
    weight_.assign(width_, 1.0);
    error_.assign(width_, 0.0);
    product_.assign(n_, 0.0);
    product2_.assign(n_, 0.0);
    along_.assign(n_, 0.0);
    for (Numbers* v : {&position_, &velocity_, &start_position_, &start_velocity_}) {
      v->assign(s.dofs + kGap, 0.0);
    }
    for (Numbers* v : {&start_integrals_, &start_rates_, &spare_rates_, &spare_own_}) {
      v->assign(s.rates + kGap, 0.0);
    }
  }

  void declare(StateLayout& layout) override {
    layout.add_reals("radau9.first_slope", width_);
    layout.add_reals("radau9.first_rates", system_.view.rates);
    layout.add_reals("radau9.last_step", kStages * width_);
    layout.add_reals("radau9.control", 4);
    layout.add_integers("radau9.counts", 3);
  }

  void attach(RunState& state) override {
    first_slope_ = state.reals("radau9.first_slope");
    first_rates_ = state.reals("radau9.first_rates");
    last_z_ = state.reals("radau9.last_step");
    control_ = state.reals("radau9.control");
    counts_ = state.integers("radau9.counts");
  }

  StepReport step_from(double since, double h, bool) override {
    if (counts_[kStarted] != kYes) start(since, h);
    double next = control_[kNext];
    bool refused = false;
    for (;;) {
      next = std::min(next, d_.largest_step);
      const bool ends = kStretchOfStep * next >= h && h <= d_.largest_step;
      const double trial_step = ends ? h : next;
      if (counts_[kTaken] + counts_[kRefused] >= d_.most_steps) {
        return {0.0, StepFault::too_many_steps};
      }
      const Trial trial = attempt(since, trial_step, refused);
      if (trial.error <= 1.0 && trial.within_moves) {
        double factor = after_success(trial.error, trial_step);
        if (refused) factor = std::min(factor, 1.0);
        // A step cut short by the end of the run says nothing against a longer one.
        control_[kNext] =
            std::max(trial_step * factor, ends && !refused ? std::min(next, d_.largest_step) : 0.0);
        control_[kOldError] = std::max(trial.error, kLeastOldError);
        accept(trial_step);
        ++counts_[kTaken];
        return {trial_step, StepFault::none};
      }
      ++counts_[kRefused];
      refused = true;
      double factor = std::min(kFactorAfterNoSolution, trial.longest / trial_step);
      if (trial.within_moves && std::isfinite(trial.error)) {
        factor = std::clamp(kSafety * pow(trial.error, -kExponent), kLeastFactor, kSafety);
      }
      next = trial_step * factor;
      if (!(next >= d_.smallest_step)) {
        const bool valid = trial.within_moves && !std::isnan(trial.error);
        return {0.0, valid ? StepFault::step_too_small : StepFault::not_finite_or_too_far};
      }
    }
  }

  const double* first_rates() const override { return start_rates_.data(); }

  void forces_changed() override {
    if (counts_[kStarted] == kYes) counts_[kStarted] = kRefresh;
  }

  Capabilities<double> capabilities() override {
    return {.error_control = this, .dense_rates = this};
  }

  void finish_dense_from(double) override {}

  void interpolate(double theta, double* position, double* velocity,
                   double* integrals) const override {
    const SystemView<double>& s = system_.view;
    std::copy(s.position, s.position + s.dofs, position);
    std::copy(s.integrals, s.integrals + s.rates, integrals);
    if (theta != 1.0) {
      const Weights along = displacement_weights(theta);
      for (std::size_t k = 0; k < n_; ++k) {
        position[at_[k]] = start_position_[at_[k]] + combined(along, k);
      }
      // The polynomial through the rates at the nodes and at the start, which adds nothing at 1.
      const Weights area = quadrature_weights(theta);
      const Weights at_start = lagrange(0.0);
      double rest = 0.0;
      for (int k = kStages; k >= 0; --k) rest = std::fma(rest, theta, kRestOfStart[k]);
      for (std::size_t k = 0; k < s.rates; ++k) {
        const double missed = start_rates_[k] - combined_rates(at_start, k);
        integrals[k] =
            start_integrals_[k] + last_h_ * std::fma(theta * rest, missed, combined_rates(area, k));
      }
    }
    velocity_within(theta, velocity);
  }

  void between(double theta, double* velocity, double* rates) const override {
    velocity_within(theta, velocity);
    const Weights here = lagrange(theta);
    for (std::size_t k = 0; k < system_.view.used_rates; ++k) rates[k] = combined_rates(here, k);
  }

  std::uint64_t refused_steps() const override {
    return static_cast<std::uint64_t>(counts_[kRefused]);
  }

  void watch(const std::vector<WatchedIntegral>& integrals,
             const std::vector<double>& along) override {
    watched_ = integrals;
    last_integrals_.assign(watched_.size(), 0.0);
    for (std::size_t k = 0; k < n_; ++k) along_[k] = along[at_[k]];
  }
  double rounding_of_works() const override { return std::sqrt(control_[kRounded]); }

 private:
  using Numbers = AlignedVector<double>;
  using Weights = std::array<double, kStages>;
  using Values = std::array<double, kStages + 1>;  ///< at a step's start and its nodes
  static constexpr std::size_t kGap = 3 * kGroup;
  /// kOldStep: of the polynomial kept; 0 when there is none. kRounded: square of the error of works
  /// through rounding.
  enum { kNext, kOldError, kOldStep, kRounded };
  enum { kStarted, kTaken, kRefused };
  /// Whether slope and rates at the next step's start are known. kRefresh: all but that.
  enum { kNo, kYes, kRefresh };

  struct Trial {
    double error = std::numeric_limits<double>::infinity();  ///< no solution; NaN: no numbers
    bool within_moves = true;
    double longest = std::numeric_limits<double>::infinity();  ///< step that sees what grows
  };
  enum class Solution { found, none, not_finite };

  // ---- steps

  void start(double since, double h) {
    const SystemView<double>& s = system_.view;
    evaluate_at(s.position, s.velocity, s.integrals, first_rates_, since, first_slope_);
    system_.evaluations += 1;
    control_[kOldStep] = 0.0;
    control_[kOldError] = kLeastOldError;
    if (std::exchange(counts_[kStarted], kYes) == kRefresh) return;
    control_[kRounded] = 0.0;
    control_[kNext] = d_.initial_step;
    if (d_.initial_step > 0.0) return;
    weigh();
    const double guess = kFirstMove / (norm(first_slope_) + std::numeric_limits<double>::min());
    control_[kNext] = std::min(h, std::max(guess, d_.smallest_step));
  }

  double after_success(double error, double h) const {
    const double least = std::max(error, 1e-10);
    double factor = kSafety * pow(least, -kExponent);
    if (control_[kOldStep] > 0.0) {
      const double trend =
          std::min(1.0, h / control_[kOldStep]) * pow(control_[kOldError] / least, kExponent);
      factor = std::min(factor, factor * trend);
    }
    return std::clamp(factor, kLeastFactor, kMostFactor);
  }

  Trial attempt(double since, double h, bool refused) {
    weigh();
    predict(h);
    linearise(since, h);
    const double longest = longest_for_growth(h);
    if (longest < h) return {.longest = longest};
    const Solution solution = factor_modes(h) ? solve_stages(since, h) : Solution::none;
    if (solution == Solution::not_finite) {
      return {.error = std::numeric_limits<double>::quiet_NaN()};
    }
    if (solution == Solution::none) return {};
    const SystemView<double>& s = system_.view;
    for (const Numbers& z : z_) {
      for (std::size_t k = 0; k < n_; ++k) {
        if (!(std::abs(z[k]) <= s.largest_move[at_[k]])) return {.within_moves = false};
      }
    }
    const double of_integrals = error_of_integrals(h);
    Trial trial;
    trial.error = estimate(first_slope_, h);
    if (trial.error > 1.0 && (refused || !(control_[kOldStep] > 0.0))) {
      // Stiff modes once more: the slope where the first estimate leads.
      place(error_.data());
      evaluate_at(position_.data(), velocity_.data(), s.integrals, spare_rates_.data(), since,
                  slope_[0].data());
      system_.evaluations += 1;
      trial.error = estimate(slope_[0].data(), h);
    }
    if (of_integrals > 0.0) {
      trial.error = std::max(trial.error, pow(of_integrals, kIntegralsExponent));
    }
    if (within_step_ > 0.0) {
      trial.error = std::max(trial.error, pow(within_step_, kDenseExponent));
    }
    return trial;
  }

  void accept(double h) {
    SystemView<double>& s = system_.view;
    std::copy(s.position, s.position + s.dofs, start_position_.begin());
    std::copy(s.velocity, s.velocity + s.dofs, start_velocity_.begin());
    std::copy(s.integrals, s.integrals + s.rates, start_integrals_.begin());
    std::copy(first_rates_, first_rates_ + s.rates, start_rates_.begin());
    last_h_ = h;
    for (int i = 0; i < kStages; ++i) std::copy(z_[i].begin(), z_[i].end(), last_z_ + i * width_);
    // The slope at the end is the polynomial's.
    const Weights slopes = slope_weights(1.0);
    for (std::size_t k = 0; k < n_; ++k) {
      s.position[at_[k]] += z_[kLast][k];
      if (s.inertial) {
        s.velocity[at_[k]] += z_[kLast][n_ + k];
        first_slope_[k] = s.velocity[at_[k]];
        first_slope_[n_ + k] = combined(slopes, n_ + k) / h;
      } else {
        s.velocity[at_[k]] = first_slope_[k] = combined(slopes, k) / h;
      }
    }
    control_[kRounded] += rounded_ * rounded_;
    const Weights area = last_row();
    for (std::size_t k = 0; k < s.rates; ++k) s.integrals[k] += h * combined_rates(area, k);
    std::copy(rates_[kLast].begin(), rates_[kLast].begin() + s.rates, first_rates_);
    control_[kOldStep] = h;
  }

  // ---- the system of all stages

  void weigh() {
    const SystemView<double>& s = system_.view;
    for (std::size_t k = 0; k < width_; ++k) {
      const std::size_t at = at_[k % n_];
      const double size = std::abs(k < n_ ? s.position[at] : s.velocity[at]);
      weight_[k] = weight(size, scale_of(k));
    }
  }

  /// Factor that makes a coordinate a length: an angle becomes an arc at the scene's length.
  double unit(std::size_t k) const { return scales_.in_units[at_[k]]; }

  /// Scale of a coordinate, or of its velocity.
  double scale_of(std::size_t k) const {
    return k < n_ ? scales_.position[at_[k]] : scales_.velocity[at_[k - n_]];
  }

  double weight(double size, double scale) const {
    return scale / (d_.absolute_tolerance +
                    std::max(d_.relative_tolerance, kRounding) * size * scale + 1e-300);
  }

  template <class Array>
  double norm(const Array& x) const {
    double squares = 0.0;
    for (std::size_t k = 0; k < width_; ++k) {
      const double part = x[k] * weight_[k];
      squares += part * part;
    }
    return std::sqrt(squares / std::max(1.0, static_cast<double>(width_)));
  }

  bool leads(double h) const {
    return control_[kOldStep] > 0.0 && h <= kMostStepsAhead * control_[kOldStep];
  }

  /// The first guess of the way at a fraction x of the step: along the last polynomial, or
  /// straight on.
  void guess(double x, double h, double* z) const {
    if (!leads(h)) {
      for (std::size_t k = 0; k < width_; ++k) z[k] = x * h * first_slope_[k];
      return;
    }
    const Weights along = displacement_weights(1.0 + x * h / control_[kOldStep]);
    for (std::size_t k = 0; k < width_; ++k) {
      z[k] = combined(along, k) - last_z_[kLast * width_ + k];
    }
  }

  void predict(double h) {
    const SystemView<double>& s = system_.view;
    for (int i = 0; i < kStages; ++i) {
      guess(Tableau::c[i], h, z_[i].data());
      for (std::size_t k = 0; k < s.own; ++k) {
        own_[i][k] = s.integrals[k] + Tableau::c[i] * h * first_rates_[k];
      }
    }
  }

  /// position_ and velocity_ <- the step's start and this displacement.
  void place(const double* z) {
    const SystemView<double>& s = system_.view;
    std::copy(s.position, s.position + s.dofs, position_.begin());
    std::copy(s.velocity, s.velocity + s.dofs, velocity_.begin());
    for (std::size_t k = 0; k < n_; ++k) {
      position_[at_[k]] += z[k];
      if (s.inertial) velocity_[at_[k]] += z[n_ + k];
    }
  }

  /// The part of h in which nothing grows by more than exp(kMostGrowth). An L-stable scheme damps
  /// what grows far within a step, and its error estimate does not see it: the state would stay on
  /// top of a potential. A motion grows faster than exp(sigma t) where sigma^2 M + sigma G + K has
  /// a negative eigenvalue.
  double longest_for_growth(double h) {
    for (int halvings = 0; halvings < kMostHalvings; ++halvings, h *= 0.5) {
      const double sigma = kMostGrowth / h;
      if (!tangent_.factor(system_.view.inertial ? sigma * sigma : 0.0, sigma, 1.0)) continue;
      if (tangent_.negative() == 0) return h;
    }
    return h;
  }

  /// K and G on the way.
  void linearise(double since, double h) {
    const SystemView<double>& s = system_.view;
    double x = kLinearisedAt;
    guess(x, h, error_.data());
    bool near = true;
    for (std::size_t k = 0; k < n_; ++k) {
      near = near && std::abs(error_[k]) <= s.largest_move[at_[k]];
    }
    if (!near) {
      x = 0.0;
      std::fill(error_.begin(), error_.end(), 0.0);
    }
    place(error_.data());
    for (std::size_t k = 0; k < s.own; ++k) {
      spare_own_[k] = s.integrals[k] + x * h * first_rates_[k];
    }
    tangent_.linearise(position_.data(), velocity_.data(), spare_own_.data(), since + x * h,
                       spare_rates_.data());
    system_.evaluations += 1;
    system_.columns += tangent_.columns();
  }

  /// The factors of each mode's matrix.
  bool factor_modes(double h) {
    const SystemView<double>& s = system_.view;
    const double real = Tableau::real_mode / h;
    if (!tangent_.factor(s.inertial ? real * real : 0.0, real, 1.0)) return false;
    for (int p = 0; p < 2; ++p) {
      const std::complex<double> mu = pair(p, h);
      const double a = mu.real();
      const double b = mu.imag();
      const std::complex<double> square(a * a - b * b, 2.0 * a * b);
      if (!pairs_[p]->factor(s.inertial ? square : 0.0, mu, 1.0)) return false;
    }
    return true;
  }

  static std::complex<double> pair(int p, double h) {
    return {Tableau::pairs[p][0] / h, -Tableau::pairs[p][1] / h};
  }

  void evaluate_at(const double* position, const double* velocity, const double* own, double* rates,
                   double elapsed, double* slope) {
    const SystemView<double>& s = system_.view;
    evaluate(s, stage_of(s, position, velocity, own, rates, elapsed));
    for (std::size_t k = 0; k < n_; ++k) {
      const double response = s.force[at_[k]] * s.inverse_mass[at_[k]];
      slope[s.inertial ? n_ + k : k] = response;
      if (s.inertial) slope[k] = velocity[at_[k]];
    }
  }

  Solution solve_stages(double since, double h) {
    double last = 0.0;
    bool placed = false;  // coordinates and velocities are within their tolerance
    rounded_ = 0.0;
    for (int iteration = 0;
         iteration < (placed ? kMostIterations + kMoreIterations : kMostIterations); ++iteration) {
      for (int i = 0; i < kStages; ++i) {
        place(z_[i].data());
        evaluate_at(position_.data(), velocity_.data(), own_[i].data(), rates_[i].data(),
                    since + Tableau::c[i] * h, slope_[i].data());
      }
      system_.evaluations += kStages;
      const double moved = change_of_integrals(h);
      const double change = improve(h);
      if (!std::isfinite(change)) return Solution::not_finite;
      const double rate = iteration > 0 ? change / last : 0.0;
      if (!placed && iteration == 0) {
        placed = change <= kSingleCorrection * kIterationError;
      } else if (!placed) {
        if (rate >= kLargestContraction) return Solution::none;
        const double left = rate / (1.0 - rate) * change;
        placed = left <= kIterationError;
        if (left * pow(rate, kMostIterations - 1 - iteration) > kIterationError) {
          return Solution::none;
        }
      }
      if (placed && (unwatched() || (iteration > 0 && integrals_settled(h, moved, rate)))) {
        return Solution::found;
      }
      last = change;
    }
    return Solution::none;
  }

  // ---- running integrals

  /// The mean force of a driver is what is left of large parts that cancel, and so is its work:
  /// what is dissipated. Errors of both are held against that.

  /// Power that friction takes, at velocities u.
  double dissipation(const double* u) {
    tangent_.times_friction(u, product_.data());
    double power = 0.0;
    for (std::size_t k = 0; k < n_; ++k) power = std::fma(u[k], product_[k], power);
    return power;
  }

  /// By how much, as an energy, integrals over the step differ from those of the last iteration.
  double change_of_integrals(double h) {
    if (watched_.empty()) return 0.0;
    const Weights area = last_row();
    dissipated_ = 0.0;
    for (int i = 0; i < kStages; ++i) {
      power_[i + 1] = dissipation(slope_[i].data());
      dissipated_ = std::fma(h * area[i], power_[i + 1], dissipated_);
    }
    double most = std::abs(dissipated_ - std::exchange(last_dissipated_, dissipated_));
    scale_ = h * dissipation(along_.data());
    if (scale_ > 0.0) scale_ = std::max(scale_, dissipated_);
    for (std::size_t w = 0; w < watched_.size(); ++w) {
      const double now = h * watched_[w].speed * combined_rates(area, watched_[w].rate);
      most = std::max(most, std::abs(now - std::exchange(last_integrals_[w], now)));
    }
    return most;
  }

  /// If nothing is dissipated the whole of the work is stored; and if no driver is steady
  /// nothing is known of what is dissipated on average.
  bool unwatched() const { return watched_.empty() || scale_ == 0.0; }

  /// Whether another iteration would change them by no more than is allowed, or than rounding does;
  /// the last one has by `moved`.
  bool integrals_settled(double h, double moved, double rate) {
    const double allowed = kIterationErrorOfIntegrals * tolerance_ * scale_;
    if (rate < 1.0 && rate / (1.0 - rate) * moved <= allowed) return true;
    double largest = 0.0;
    for (const WatchedIntegral& w : watched_) {
      largest = std::max(largest, w.speed * largest_rate(w.rate));
    }
    const double ulps = largest_change_ / (kEpsilon * farthest() + 1e-300);
    const bool converges =
        ulps > kUlpsOfCoordinate && (rate < kContractionOfRounding || ulps > kMostUlps);
    if (converges && moved > kUlpsOfRate * kEpsilon * h * largest) return false;
    rounded_ = moved;
    return true;
  }

  double largest_rate(std::size_t k) const {
    double largest = 0.0;
    for (int i = 0; i < kStages; ++i) largest = std::max(largest, std::abs(rates_[i][k]));
    return largest;
  }

  /// Error of the quadratures of all that is watched, in units of the allowed one. Rounding of
  /// coordinates is no error of a step: a shorter one would not help.
  double error_of_integrals(double h) {
    within_step_ = 0.0;
    if (unwatched()) return 0.0;
    const double steps = steps_in_period(h);
    // Without a period the scene's time stands for it.
    const double steps_of_all = std::isfinite(steps) ? steps : scales_.time / h;
    const double allowed = tolerance_ * scale_ * std::max(1.0, kPartOfPeriod * steps_of_all);
    const double ulps = h * kUlpsOfDifferences * kEpsilon * farthest();
    const double rounding = ulps * stiffness() * fastest();
    double most = 0.0;
    const auto include = [&](const Values& values, double noise) {
      double within = 0.0;
      const double error = error_of_quadrature(h, values, within);
      if (within > noise) {
        within_step_ =
            std::max(within_step_, within / std::max(tolerance_ * scale_ * steps, noise));
      }
      if (error > noise) most = std::max(most, error / std::max(allowed, noise));
    };
    power_[0] = dissipation(first_slope_);
    include(power_, rounding);
    for (const WatchedIntegral& w : watched_) {
      Values values;
      values[0] = w.speed * first_rates_[w.rate];
      for (int i = 0; i < kStages; ++i) values[i + 1] = w.speed * rates_[i][w.rate];
      include(values, w.stiffness > 0.0 ? ulps * w.stiffness * w.speed : rounding);
    }
    return most;
  }

  /// A large second derivative of the energy at the last linearise().
  double stiffness() {
    double most = 0.0;
    for (const double sign : {1.0, -1.0}) {
      for (std::size_t k = 0; k < n_; ++k) error_[k] = (k % 2 == 0 ? 1.0 : sign) / unit(k);
      tangent_.times_stiffness(error_.data(), product_.data());
      for (std::size_t k = 0; k < n_; ++k) {
        most = std::max(most, std::abs(product_[k]) / unit(k));
      }
    }
    return most;
  }

  /// Windows begin and end within steps, and are no shorter than a period.
  double steps_in_period(double h) const {
    double most = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < n_; ++k) {
      if (along_[k] == 0.0) continue;
      most = std::min(most, system_.view.largest_move[at_[k]] / (h * std::abs(along_[k])));
    }
    return std::max(1.0, most);
  }

  double fastest() const {
    double most = 0.0;
    for (std::size_t k = 0; k < n_; ++k) {
      most = std::max(most, std::max(std::abs(along_[k]), std::abs(first_slope_[k])) * unit(k));
    }
    return most;
  }

  double farthest() const {
    double most = 0.0;
    for (std::size_t k = 0; k < n_; ++k) {
      most = std::max(most, std::abs(system_.view.position[at_[k]]) * unit(k));
    }
    return most;
  }

  /// A quadrature of order 9 does wrong what goes like P_9. Of the values' polynomial P_4 and P_5
  /// are known, and by how much they are smaller than P_2 and P_3: as fast the rest is taken to
  /// fall. Below rounding nothing is known, and nothing is wrong.
  static double error_of_quadrature(double h, const Values& values, double& within) {
    double squares[2] = {};
    double largest = 0.0;
    for (const double value : values) largest = std::max(largest, std::abs(value));
    for (int row = 0; row < 4; ++row) {
      double part = 0.0;
      for (int j = 0; j <= kStages; ++j) part += Tableau::legendre[row][j] * values[j];
      squares[row / 2] += part * part;
    }
    const double high = std::sqrt(squares[1]);
    if (high <= kUlpsOfRate * kEpsilon * largest) return 0.0;
    const double falls = squares[0] > squares[1] ? std::sqrt(squares[1] / squares[0]) : 1.0;
    within = h * high * falls;  // P_6
    return within * falls * std::sqrt(falls);
  }

  /// One correction of all stages; its size in tolerances.
  double improve(double h) {
    for (std::size_t k = 0; k < width_; ++k) {
      Weights w{};
      Weights f{};
      for (int i = 0; i < kStages; ++i) {
        for (int j = 0; j < kStages; ++j) {
          w[i] += Tableau::to_modes[i][j] * z_[j][k];
          f[i] += Tableau::to_modes[i][j] * slope_[j][k];
        }
      }
      mode_[0][k] = f[0] - Tableau::real_mode / h * w[0];
      for (int p = 0; p < 2; ++p) {
        const std::complex<double> mu = pair(p, h);
        const int i = 1 + 2 * p;
        mode_[i][k] = f[i] - (mu.real() * w[i] - mu.imag() * w[i + 1]);
        mode_[i + 1][k] = f[i + 1] - (mu.real() * w[i + 1] + mu.imag() * w[i]);
      }
    }
    solve_mode(Tableau::real_mode / h, mode_[0].data());
    for (int p = 0; p < 2; ++p) solve_pair(p, h, mode_[1 + 2 * p].data(), mode_[2 + 2 * p].data());
    double squares = 0.0;
    largest_change_ = 0.0;
    for (int i = 0; i < kStages; ++i) {
      for (std::size_t k = 0; k < width_; ++k) {
        double change = 0.0;
        for (int j = 0; j < kStages; ++j) change += Tableau::from_modes[i][j] * mode_[j][k];
        z_[i][k] += change;
        if (k < n_) largest_change_ = std::max(largest_change_, std::abs(change) * unit(k));
        const double part = change * weight_[k];
        squares += part * part;
      }
    }
    squares += improve_own(h);
    return std::sqrt(squares / std::max<double>(1.0, static_cast<double>(kStages * width_)));
  }

  /// Variables of prescribed bodies depend on nothing but time: right as soon as all rates are.
  double improve_own(double h) {
    const SystemView<double>& s = system_.view;
    double squares = 0.0;
    for (std::size_t k = 0; k < s.own_count; ++k) {
      const double importance = weight(std::abs(s.integrals[k]), scales_.own[k]);
      for (int i = 0; i < kStages; ++i) {
        double way = 0.0;
        for (int j = 0; j < kStages; ++j) way += Tableau::a[i][j] * rates_[j][k];
        const double now = s.integrals[k] + h * way;
        const double part = (now - std::exchange(own_[i][k], now)) * importance;
        squares += part * part;
      }
    }
    return squares;
  }

  /// r <- (mu - J)^-1 r, J the Jacobian of the slopes: velocities are eliminated.
  void solve_mode(double mu, double* r) {
    tangent_.times_friction(r, product_.data());
    if (!system_.view.inertial) {
      tangent_.solve(product_.data());
      std::copy(product_.begin(), product_.end(), r);
      return;
    }
    const std::vector<double>& mass = tangent_.masses();
    for (std::size_t k = 0; k < n_; ++k) product_[k] += mass[k] * (r[n_ + k] + mu * r[k]);
    tangent_.solve(product_.data());
    for (std::size_t k = 0; k < n_; ++k) {
      r[n_ + k] = mu * product_[k] - r[k];
      r[k] = product_[k];
    }
  }

  /// Solves for a complex mode, r + i s, likewise.
  void solve_pair(int p, double h, double* r, double* s) {
    const double a = pair(p, h).real();
    const double b = pair(p, h).imag();
    tangent_.times_friction(r, product_.data());
    tangent_.times_friction(s, product2_.data());
    if (!system_.view.inertial) {
      pairs_[p]->solve(product_.data(), product2_.data());
      std::copy(product_.begin(), product_.end(), r);
      std::copy(product2_.begin(), product2_.end(), s);
      return;
    }
    const std::vector<double>& mass = tangent_.masses();
    for (std::size_t k = 0; k < n_; ++k) {
      product_[k] += mass[k] * (r[n_ + k] + (a * r[k] - b * s[k]));
      product2_[k] += mass[k] * (s[n_ + k] + (a * s[k] + b * r[k]));
    }
    pairs_[p]->solve(product_.data(), product2_.data());
    for (std::size_t k = 0; k < n_; ++k) {
      r[n_ + k] = a * product_[k] - b * product2_[k] - r[k];
      s[n_ + k] = a * product2_[k] + b * product_[k] - s[k];
      r[k] = product_[k];
      s[k] = product2_[k];
    }
  }

  /// The difference to the embedded scheme, in tolerances, left in error_.
  double estimate(const double* first_slope, double h) {
    const SystemView<double>& s = system_.view;
    const double mu = Tableau::real_mode / h;
    for (std::size_t k = 0; k < width_; ++k) {
      double difference = h * Tableau::start * first_slope[k];
      for (int i = 0; i < kStages; ++i) difference += Tableau::error[i] * z_[i][k];
      error_[k] = mu * difference;
    }
    solve_mode(mu, error_.data());
    double squares = 0.0;
    for (std::size_t k = 0; k < width_; ++k) {
      const std::size_t at = at_[k % n_];
      const double before = k < n_ ? s.position[at] : s.velocity[at];
      const double size = std::max(std::abs(before), std::abs(before + z_[kLast][k]));
      const double part = error_[k] * weight(size, scale_of(k));
      squares += part * part;
    }
    squares += own_squares(h);
    return std::sqrt(squares / std::max(1.0, static_cast<double>(width_ + s.own_count)));
  }

  /// Squared error of variables of prescribed bodies, on which no force acts back.
  double own_squares(double h) const {
    const SystemView<double>& s = system_.view;
    double squares = 0.0;
    for (std::size_t k = 0; k < s.own_count; ++k) {
      double difference = h * Tableau::start * first_rates_[k];
      for (int i = 0; i < kStages; ++i) {
        difference += Tableau::error[i] * (own_[i][k] - s.integrals[k]);
      }
      const double size = std::max(std::abs(s.integrals[k]), std::abs(own_[kLast][k]));
      const double part = difference * weight(size, scales_.own[k]);
      squares += part * part;
    }
    return squares;
  }

  // ---- the polynomial of a step, at a fraction x of it

  static Weights lagrange(double x) {
    Weights l{};
    for (int j = 0; j < kStages; ++j) {
      for (int k = kStages - 1; k >= 0; --k) l[j] = std::fma(l[j], x, Tableau::basis[j][k]);
    }
    return l;
  }

  static Weights last_row() {
    Weights row{};
    std::copy(std::begin(Tableau::a[kLast]), std::end(Tableau::a[kLast]), row.begin());
    return row;
  }

  /// Weights of the stages' rates, for the integral from 0 to x.
  static Weights quadrature_weights(double x) {
    Weights area{};
    for (int j = 0; j < kStages; ++j) {
      for (int k = kStages - 1; k >= 0; --k) {
        area[j] = std::fma(area[j], x, Tableau::basis[j][k] / (k + 1));
      }
      area[j] *= x;
    }
    return area;
  }

  /// Weights of the stages' displacements: the polynomial through them and the start, in its
  /// product form, which holds beyond the step, too.
  static Weights displacement_weights(double x) {
    Weights along{};
    for (int j = 0; j < kStages; ++j) {
      along[j] = x / Tableau::c[j];
      for (int k = 0; k < kStages; ++k) {
        if (k != j) along[j] *= (x - Tableau::c[k]) / (Tableau::c[j] - Tableau::c[k]);
      }
    }
    return along;
  }

  /// Weights of the stages' displacements for h times the slope, interpolated between the stages.
  static Weights slope_weights(double x) {
    const Weights here = lagrange(x);
    Weights slope{};
    for (int i = 0; i < kStages; ++i) {
      for (int j = 0; j < kStages; ++j) slope[j] += here[i] * Tableau::inverse[i][j];
    }
    return slope;
  }

  double combined(const Weights& weights, std::size_t k) const {
    double sum = 0.0;
    for (int j = 0; j < kStages; ++j) sum += weights[j] * last_z_[j * width_ + k];
    return sum;
  }

  double combined_rates(const Weights& weights, std::size_t k) const {
    double sum = 0.0;
    for (int j = 0; j < kStages; ++j) sum += weights[j] * rates_[j][k];
    return sum;
  }

  void velocity_within(double theta, double* velocity) const {
    const SystemView<double>& s = system_.view;
    std::copy(s.velocity, s.velocity + s.dofs, velocity);
    if (theta == 1.0) return;
    if (s.inertial) {
      const Weights along = displacement_weights(theta);
      for (std::size_t k = 0; k < n_; ++k) {
        velocity[at_[k]] = start_velocity_[at_[k]] + combined(along, n_ + k);
      }
    } else {
      const Weights slope = slope_weights(theta);
      for (std::size_t k = 0; k < n_; ++k) velocity[at_[k]] = combined(slope, k) / last_h_;
    }
  }

  Description d_;  ///< but for the absolute tolerance, which is a part of the scene's length
  ToleranceScales<double> scales_;
  Tangent& tangent_;
  const std::vector<std::size_t>& at_;  ///< where the free coordinates stand
  std::size_t n_;
  std::size_t width_;       ///< numbers solved for: coordinates, and with inertia their velocities
  double tolerance_ = 0.0;  ///< of running integrals, as a part of what is dissipated
  std::array<std::unique_ptr<ShiftedTangent>, 2> pairs_;

  std::vector<WatchedIntegral> watched_;
  std::vector<double> last_integrals_;  ///< over the step, by the last iteration; energies
  Values power_{};
  double dissipated_ = 0.0;
  double last_dissipated_ = 0.0;
  double scale_ = 0.0;           ///< what errors of works are held against, an energy
  double largest_change_ = 0.0;  ///< of a coordinate, by the last iteration
  double within_step_ = 0.0;     ///< error of integrals there, in what is allowed
  double rounded_ = 0.0;         ///< error of works through rounding, in this step

  // Stages: displacements from the start, slopes, rates, internal variables; corrections by mode.
  std::array<Numbers, kStages> z_;
  std::array<Numbers, kStages> slope_;
  std::array<Numbers, kStages> rates_;
  std::array<Numbers, kStages> own_;
  std::array<Numbers, kStages> mode_;
  Numbers weight_;
  Numbers error_;
  Numbers product_;
  Numbers product2_;
  Numbers along_;  ///< velocities of a scene that moves with its drivers
  Numbers position_;
  Numbers velocity_;
  Numbers spare_rates_;
  Numbers spare_own_;

  // The last step.
  double last_h_ = 0.0;
  Numbers start_position_;
  Numbers start_velocity_;
  Numbers start_integrals_;
  Numbers start_rates_;

  double* first_slope_ = nullptr;
  double* first_rates_ = nullptr;
  double* last_z_ = nullptr;
  double* control_ = nullptr;
  std::int64_t* counts_ = nullptr;
};

/// |R(z)| of the Pade approximant (4, 5) of exp(z).
double growth(std::complex<double> z) {
  constexpr int k = kStages - 1;
  constexpr int m = kStages;
  std::complex<double> above = 0.0;
  std::complex<double> below = 0.0;
  std::complex<double> power = 1.0;
  double p = 1.0;
  double q = 1.0;
  for (int j = 0; j <= m; ++j) {
    above += p * power;
    below += (j % 2 == 0 ? q : -q) * power;
    power *= z;
    p *= static_cast<double>(k - j) / (static_cast<double>(k + m - j) * (j + 1));
    q *= static_cast<double>(m - j) / (static_cast<double>(k + m - j) * (j + 1));
  }
  return std::abs(above / below);
}

std::unique_ptr<Integrator<double>> bind(const void* description, System<double>& system) {
  return std::make_unique<Radau9>(*static_cast<const Description*>(description), system);
}

}  // namespace

IntegratorRecord radau9_record() {
  IntegratorRecord record;
  record.name = "radau9";
  record.summary = "implicit five-stage Radau IIA scheme, L-stable, adaptive, dense output";
  record.equation = "Y_i = y + h sum a_ij f(Y_j), five stages; error from an embedded order 5";
  record.source =
      "E. Hairer and G. Wanner, J. Comput. Appl. Math. 111 (1999) 93, "
      "doi:10.1016/S0377-0427(99)00134-X";
  record.order = 9;
  record.evaluations_per_step = 13;
  record.needs_tangent = true;
  describe_adaptive(record, 1e-7);
  record.growth = &growth;
  record.bind = {&bind};
  record.example = R"(# A tip that is driven a thousand times more slowly than it relaxes.
[[body]]
type = "point"
position = [0.0]
particle_mass = 1.0

[[force]]
type = "driving_spring"
stiffness = 1.0
velocity = [0.001]

[[force]]
type = "viscous_damping"
coefficient = 20.0

[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0

[run]
duration = 3000.0
integrator = { type = "radau9", absolute_tolerance = 1e-7, relative_tolerance = 1e-7 }

[measure]
from = 1.0
to = 3.0
in = "driver_periods"
)";
  return record;
}

}  // namespace tomlin
