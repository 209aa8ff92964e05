#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/system/flow.hpp"
#include "tests/support/order.hpp"

namespace tomlin::test {

/// Holds the flow of an operator against its contract (framework/core/system/flow.hpp).
class FlowCheck {
 public:
  using Numbers = std::vector<double>;

  /// `at` stands before arrays of `dofs` velocities and `own` variables, which start as they are.
  /// `slopes`: d/dt of all of them at their present values, by the force that the flow stands for.
  /// `stored`: what the force stores then.
  FlowCheck(const Flow<double>& flow, const FlowStage<double>& at, std::size_t dofs,
            std::size_t own, std::function<Numbers()> slopes, std::function<double()> stored)
      : flow_(flow),
        at_(at),
        dofs_(dofs),
        own_(own),
        slopes_(std::move(slopes)),
        stored_(std::move(stored)),
        start_(present()) {
    at_.key = {17, 4};
    at_.step = 3;
    at_.heat = true;
  }

  /// The claims that do not hold:
  ///   flow          nothing happens in no time or to what is held; flows of parts make that of the
  ///                 whole, which is what rk4 comes to with its order; random ones differ by step,
  ///                 part and key
  ///   flow repeats  the same bits from the same stage, whatever was asked before
  ///   heat of flow  the energy that is gone
  std::set<std::string> broken(bool stochastic) {
    const double time = resolved_time();
    look_at_repetition(time);
    for (const double h : {1e-9 * time, time, 30.0 * time}) look_at_heat(h);
    if (after(0.0) != start_) fault("flow");
    look_at_held(time);
    if (stochastic) {
      look_at_keys(time);
    } else {
      look_at_parts(time);
      look_at_march(time);
    }
    put(start_);
    return broken_;
  }

 private:
  // Sums and products of a few dozen terms, and exponentials of some tens.
  static constexpr double kRounding = 256.0 * std::numeric_limits<double>::epsilon();

  void fault(const char* claim) { broken_.insert(claim); }

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

  Numbers slopes_at(const Numbers& all) const {
    put(all);
    return slopes_();
  }

  /// In which numbers change by about themselves, at most.
  double resolved_time() const {
    const double fastest = largest(slopes_at(start_));
    return fastest > 0.0 ? std::min(1.0, largest(start_) / fastest) : 1.0;
  }

  void look_at_repetition(double time) {
    FlowStage<double> other = at_;
    other.step = 8;
    other.part = 1;
    const Numbers first = after(time);
    const Numbers elsewhere = after(0.3 * time, other);
    if (after(time) != first || after(0.3 * time, other) != elsewhere) fault("flow repeats");
  }

  void look_at_heat(double h) {
    const auto kinetic = [&] {
      double total = 0.0;
      for (std::size_t i = 0; i < dofs_; ++i) {
        const double v = at_.velocity[i];
        if (at_.inverse_mass[i] > 0.0) total += 0.5 * v * v / at_.inverse_mass[i];
      }
      return total;
    };
    put(start_);
    const double before = kinetic() + stored_();
    const double heat = flow_.run(flow_.arguments, at_, h);
    const double left = kinetic() + stored_();
    if (!(std::abs(before - left - heat) <= kRounding * (std::abs(before) + std::abs(left)))) {
      fault("heat of flow");
    }
    FlowStage<double> unasked = at_;
    unasked.heat = false;
    if (after(h, unasked) != after(h)) fault("flow repeats");
  }

  void look_at_held(double h) {
    put(start_);
    for (std::size_t i = 0; i < dofs_; ++i) {
      if (at_.inverse_mass[i] == 0.0) at_.velocity[i] = 0.0;
    }
    flow_.run(flow_.arguments, at_, h);
    for (std::size_t i = 0; i < dofs_; ++i) {
      if (at_.inverse_mass[i] == 0.0 && at_.velocity[i] != 0.0) fault("flow");
    }
  }

  void look_at_keys(double h) {
    if (after(h) == start_) return;  // of zero strength
    FlowStage<double> step = at_, part = at_, key = at_;
    step.step += 1;
    part.part += 1;
    key.key.stream += 1;
    for (const auto& other : {step, part, key}) {
      if (after(h, other) == after(h)) fault("flow");
    }
  }

  void look_at_parts(double time) {
    for (const double h : {time, 30.0 * time}) {
      const Numbers whole = after(h);
      put(start_);
      for (const double part : {0.3, 0.7}) flow_.run(flow_.arguments, at_, part * h);
      if (!(difference(present(), whole) <= kRounding * largest(start_))) fault("flow");
    }
  }

  /// The error of rk4 has to fall as its order says.
  void look_at_march(double time) {
    constexpr Window kFourthOrder{3.7, 4.3};
    const Numbers whole = after(time);
    const double rounding = 100.0 * kRounding * largest(start_);
    Numbers steps, errors;
    for (const int count : {20, 40, 80}) {
      const double h = time / count;
      Numbers y = start_;
      for (int s = 0; s < count; ++s) {
        const Numbers k1 = slopes_at(y);
        const Numbers k2 = slopes_at(sum(y, 0.5 * h, k1));
        const Numbers k3 = slopes_at(sum(y, 0.5 * h, k2));
        const Numbers k4 = slopes_at(sum(y, h, k3));
        y = sum(y, h / 6.0, sum(sum(k1, 2.0, k2), 1.0, sum(k4, 2.0, k3)));
      }
      steps.push_back(h);
      errors.push_back(difference(y, whole));
    }
    if (*std::max_element(errors.begin(), errors.end()) <= rounding) return;
    const double order = fitted_order(steps, errors, rounding);
    const bool falls =
        std::isnan(order) ? errors.back() <= 100.0 * rounding : kFourthOrder.holds(order);
    if (!falls) fault("flow");
  }

  Flow<double> flow_;
  FlowStage<double> at_;
  std::size_t dofs_;
  std::size_t own_;
  std::function<Numbers()> slopes_;
  std::function<double()> stored_;
  Numbers start_;
  std::set<std::string> broken_;
};

}  // namespace tomlin::test
