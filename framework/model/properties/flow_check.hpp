#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "framework/core/system/flow.hpp"

namespace tomlin::properties {

/// The flow of an operator against its contract (framework/core/system/flow.hpp).
class FlowCheck {
 public:
  using Numbers = std::vector<double>;
  /// Called with every comparison: the value found, the one expected, and what rounding allows.
  using Note = std::function<void(double found, double expected, double allowed)>;

  /// `at` stands before arrays of `dofs` velocities and `own` variables, which start as they are,
  /// and are so again after each function. `slopes`: d/dt of all of them at their present values,
  /// by the force that the flow stands for. `stored`: what the force stores then.
  FlowCheck(const Flow<double>& flow, const FlowStage<double>& at, std::size_t dofs,
            std::size_t own, std::function<Numbers()> slopes, std::function<double()> stored,
            Note note)
      : flow_(flow),
        at_(at),
        dofs_(dofs),
        own_(own),
        slopes_(std::move(slopes)),
        stored_(std::move(stored)),
        note_(std::move(note)),
        start_(present()),
        time_(resolved_time()) {
    at_.key = {17, 4};
    at_.step = 3;
    at_.heat = true;
  }

  /// Nothing happens in no time or to what is held; flows of parts make that of the whole, which is
  /// what rk4 comes to with its order; random ones differ by step, part and key.
  void check_solution(bool stochastic) {
    expect_same(after(0.0), start_);
    check_held(time_);
    if (stochastic) {
      check_keys(time_);
    } else {
      check_parts(time_);
      check_march(time_);
    }
    put(start_);
  }

  /// Expects the same bits from the same stage, whatever was asked before, and whether or not the
  /// heat is asked for.
  void check_repetition() {
    FlowStage<double> other = at_;
    other.step = 8;
    other.part = 1;
    const Numbers first = after(time_);
    const Numbers elsewhere = after(0.3 * time_, other);
    expect_same(after(time_), first);
    expect_same(after(0.3 * time_, other), elsewhere);
    FlowStage<double> unasked = at_;
    unasked.heat = false;
    for (const double h : times()) expect_same(after(h, unasked), after(h));
    put(start_);
  }

  /// The energy that is gone.
  void check_heat() {
    for (const double h : times()) {
      put(start_);
      const double before = kinetic() + stored_();
      const double heat = flow_.run(flow_.arguments, at_, h);
      const double left = kinetic() + stored_();
      note_(heat, before - left, kRounding * (std::abs(before) + std::abs(left)));
    }
    put(start_);
  }

 private:
  // Sums and products of a few dozen terms, and exponentials of some tens.
  static constexpr double kRounding = 256.0 * std::numeric_limits<double>::epsilon();
  /// Halved steps of rk4 make errors 16 times smaller; h^5 terms are a few percent of that.
  static constexpr double kLeastGain = 13.0;
  static constexpr double kMostGain = 19.7;

  /// Hardly anything, about one decay, and when little is left.
  std::array<double, 3> times() const { return {1e-9 * time_, time_, 30.0 * time_}; }

  Numbers present() const {
    Numbers all(at_.velocity, at_.velocity + dofs_);
    all.insert(all.end(), at_.own, at_.own + own_);
    return all;
  }
  void put(const Numbers& all) const {
    const auto end = all.begin() + static_cast<std::ptrdiff_t>(dofs_);
    std::copy(all.begin(), end, at_.velocity);
    std::copy(end, all.end(), at_.own);
  }
  Numbers after(double h, const FlowStage<double>& at) const {
    put(start_);
    flow_.run(flow_.arguments, at, h);
    return present();
  }
  Numbers after(double h) const { return after(h, at_); }

  static double largest(const Numbers& all) {
    double most = 0.0;
    for (const double x : all) most = std::max(most, std::abs(x));
    return most;
  }
  static Numbers sum(const Numbers& a, double factor, const Numbers& b) {
    Numbers c = a;
    for (std::size_t k = 0; k < c.size(); ++k) c[k] += factor * b[k];
    return c;
  }
  static double difference(const Numbers& a, const Numbers& b) { return largest(sum(a, -1.0, b)); }

  void expect_same(const Numbers& found, const Numbers& expected) const {
    const auto [at, other] = std::mismatch(found.begin(), found.end(), expected.begin());
    if (at != found.end()) return note_(*at, *other, -1.0);
    note_(0.0, 0.0, 0.0);
  }

  Numbers slopes_at(const Numbers& all) const {
    put(all);
    return slopes_();
  }
  double kinetic() const {
    double total = 0.0;
    for (std::size_t i = 0; i < dofs_; ++i) {
      const double v = at_.velocity[i];
      if (at_.inverse_mass[i] > 0.0) total += 0.5 * v * v / at_.inverse_mass[i];
    }
    return total;
  }

  /// In which numbers change by about themselves, at most.
  double resolved_time() const {
    const double fastest = largest(slopes_at(start_));
    put(start_);
    return fastest > 0.0 ? std::min(1.0, largest(start_) / fastest) : 1.0;
  }

  void check_held(double h) {
    put(start_);
    for (std::size_t i = 0; i < dofs_; ++i) {
      if (at_.inverse_mass[i] == 0.0) at_.velocity[i] = 0.0;
    }
    flow_.run(flow_.arguments, at_, h);
    for (std::size_t i = 0; i < dofs_; ++i) {
      if (at_.inverse_mass[i] == 0.0) note_(at_.velocity[i], 0.0, 0.0);
    }
  }

  void check_keys(double h) {
    if (after(h) == start_) return;  // of zero strength
    FlowStage<double> step = at_, part = at_, key = at_;
    step.step += 1;
    part.part += 1;
    key.key.stream += 1;
    for (const auto& other : {step, part, key}) {
      // One that is the same is no error.
      if (after(h, other) == after(h)) note_(0.0, largest(start_), -1.0);
    }
  }

  void check_parts(double time) {
    for (const double h : {time, 30.0 * time}) {
      const Numbers whole = after(h);
      put(start_);
      for (const double part : {0.3, 0.7}) flow_.run(flow_.arguments, at_, part * h);
      const double found = difference(present(), whole);
      note_(found, 0.0, kRounding * largest(start_) * growth(h));
    }
  }
  /// Growth of rounding by the flow, at the start and later: more if it is not linear, and drives
  /// neighbours apart; the steps that a flow takes round, too.
  double growth(double h) const {
    constexpr double kRelativePerturbation = 0x1p-24;
    double most = 0.0;
    for (const double from : {0.0, 0.1, 0.3, 0.6}) {
      const Numbers here = after(from * h);
      Numbers ends[2];
      for (Numbers& end : ends) {
        Numbers perturbed = here;
        for (std::size_t k = 0; &end == &ends[1] && k < perturbed.size(); ++k) {
          perturbed[k] += (k % 2 ? -kRelativePerturbation : kRelativePerturbation) *
                          std::max(std::abs(here[k]), 0.1 * largest(here));
        }
        put(perturbed);
        flow_.run(flow_.arguments, at_, (1.0 - from) * h);
        end = present();
      }
      most = std::max(most, difference(ends[0], ends[1]) / (kRelativePerturbation * largest(here)));
    }
    return 16.0 * std::max(1.0, most);
  }
  /// The error of rk4 has to fall as its order says, if not at once then with shorter steps, or be
  /// nothing but rounding.
  void check_march(double time) {
    constexpr int kMostMarches = 10240;
    const Numbers whole = after(time);
    const double rounding = 100.0 * kRounding * largest(start_);
    double coarse = difference(marched(time, 20), whole);
    double fine = coarse;
    for (int count = 40; count <= kMostMarches; count *= 2) {
      coarse = fine;
      fine = difference(marched(time, count), whole);
      if (!(fine > rounding)) return note_(fine, 0.0, rounding);
      const bool falls = coarse > kLeastGain * fine && coarse < kMostGain * fine;
      if (falls) return note_(fine, coarse / 16.0, coarse);
    }
    note_(fine, coarse / 16.0, -1.0);
  }
  Numbers marched(double time, int count) const {
    const double h = time / count;
    Numbers y = start_;
    for (int s = 0; s < count; ++s) {
      const Numbers k1 = slopes_at(y);
      const Numbers k2 = slopes_at(sum(y, 0.5 * h, k1));
      const Numbers k3 = slopes_at(sum(y, 0.5 * h, k2));
      const Numbers k4 = slopes_at(sum(y, h, k3));
      y = sum(y, h / 6.0, sum(sum(k1, 2.0, k2), 1.0, sum(k4, 2.0, k3)));
    }
    return y;
  }

  Flow<double> flow_;
  FlowStage<double> at_;
  std::size_t dofs_;
  std::size_t own_;
  std::function<Numbers()> slopes_;
  std::function<double()> stored_;
  Note note_;
  Numbers start_;
  double time_;
};

}  // namespace tomlin::properties
