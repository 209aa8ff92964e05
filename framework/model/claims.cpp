#include "framework/model/claims.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include <fmt/format.h>

#include "framework/core/force.hpp"
#include "framework/model/force_alone.hpp"

namespace tomlin {
namespace {

/// Displacements, in parts of the shortest length: springs stay far from turning over.
constexpr double kDisplacement = 0.1;
/// The longest difference, likewise. Errors fall as (2 pi/50)^2 = 0.016 from one order to the next.
constexpr double kLongestDifference = 0.02;
/// Central differences at h, h/2, h/4, h/8 leave an error of order h^8.
constexpr int kDifferences = 4;
/// The last two orders of the extrapolation differ by more than the last one is off.
constexpr double kTrust = 10.0;
/// An energy whose slope has not settled to this is not smooth enough to have one.
constexpr double kSettled = 1e-3;
/// A sum of some hundred terms loses some tens of units in the last place of its size.
constexpr double kRounding = 64.0 * std::numeric_limits<double>::epsilon();
constexpr double kTau = 6.283185307179586476925286766559;

/// The same numbers with every library: distributions of the standard library differ.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  /// Between -1 and 1.
  double symmetric() {
    constexpr double kSteps = 9007199254740992.0;  // 2^53
    return 2.0 * (static_cast<double>(engine_() >> 11) / kSteps) - 1.0;
  }
  std::size_t below(std::size_t n) { return engine_() % n; }

 private:
  std::mt19937_64 engine_;
};

using Variable = ForceAlone::Variable;

/// One force and the states at which its claims are looked at.
class Examination {
 public:
  Examination(ForceAlone& alone, double length, const ClaimOptions& options)
      : alone_(alone), length_(length), options_(options) {
    latest_ = latest_time();
  }

  ClaimResult conservative();
  ClaimResult internal();
  ClaimResult dissipative();
  ClaimResult periodic();

 private:
  struct State {
    std::vector<double> x;  ///< of each variable
    double time = 0.0;
  };
  using LookAt = std::function<void(const State&, Random&)>;

  /// A claim, after `look_at` has seen every state.
  ClaimResult over_all_states(const char* claim, const char* meaning, const LookAt& look_at);
  /// A difference that could be zero, at a state where `size` is the size of what is compared.
  void note(double difference, double size, double allowed, const std::string& where = "");

  void slope_along(const State& state, const std::vector<double>& direction,
                   const std::string& where);
  void place(const State& state);
  void move_to(const State& state, const std::vector<double>& direction, double h);
  double work(const std::vector<double>& direction, double time);
  double latest_time() const;
  std::string name_of(const Variable& variable) const;
  std::size_t count() const { return alone_.variables().size(); }

  ForceAlone& alone_;
  double length_;
  ClaimOptions options_;
  double latest_ = 0.0;
  ClaimResult now_;
  double strain_ = 0.0;  ///< the largest part of what is allowed
};

/// Drivers are looked at while they are about a length away from their start.
double Examination::latest_time() const {
  double latest = alone_.model().scene().run.duration;
  if (const Drive* drive = alone_.force().bound->drive()) {
    for (const double velocity : drive->velocity) {
      if (velocity != 0.0) latest = std::min(latest, length_ / std::abs(velocity));
    }
  }
  return latest;
}

ClaimResult Examination::over_all_states(const char* claim, const char* meaning,
                                         const LookAt& look_at) {
  const Model::Force& force = alone_.force();
  now_ = {force.name, force.record->name, claim, meaning, true, 0.0, 0.0, 0, ""};
  strain_ = -1.0;
  Random random(options_.seed);
  alone_.restart();
  State start;
  for (const Variable& variable : alone_.variables()) start.x.push_back(alone_.position(variable));
  // The start comes last: where forces balance, sizes are known from where they do not.
  for (int k = options_.displaced_states; k >= 0; --k) {
    State state = start;
    if (k > 0) {
      for (std::size_t i = 0; i < count(); ++i) {
        state.x[i] += kDisplacement * length_ * alone_.variables()[i].unit * random.symmetric();
      }
      state.time = 0.5 * (1.0 + random.symmetric()) * latest_;
    }
    look_at(state, random);
    ++now_.states;
  }
  alone_.restart();
  return now_;
}

void Examination::note(double difference, double size, double allowed, const std::string& where) {
  const bool holds = difference <= allowed;  // false for what is no number
  const double strain = difference == 0.0 ? 0.0
                        : holds || (difference > allowed && allowed > 0.0)
                            ? difference / allowed
                            : std::numeric_limits<double>::infinity();
  now_.holds = now_.holds && holds;
  if (strain < strain_) return;
  strain_ = strain;
  now_.error = size > 0.0 ? difference / size : difference;
  now_.allowed = size > 0.0 ? std::max(allowed, 0.0) / size : 0.0;
  now_.worst = where;
}

void Examination::place(const State& state) {
  for (std::size_t i = 0; i < count(); ++i) alone_.position(alone_.variables()[i]) = state.x[i];
}

void Examination::move_to(const State& state, const std::vector<double>& direction, double h) {
  for (std::size_t i = 0; i < count(); ++i) {
    alone_.position(alone_.variables()[i]) = state.x[i] + h * direction[i];
  }
}

/// Of the force along a direction, at the present positions.
double Examination::work(const std::vector<double>& direction, double time) {
  const double* force = alone_.forces(time);
  double sum = 0.0;
  for (std::size_t i = 0; i < count(); ++i) {
    sum += force[alone_.variables()[i].at] * direction[i];
  }
  return sum;
}

/// Central differences of the energy along a direction, extrapolated to h = 0, against the force.
void Examination::slope_along(const State& state, const std::vector<double>& direction,
                              const std::string& where) {
  const double longest = kLongestDifference * length_;
  double rounding = 0.0;  // of an energy
  double effort = 0.0;    // work without regard to sign
  const auto gauge = [&](double h) {
    move_to(state, direction, h);
    const double* force = alone_.forces(state.time);
    double size = 0.0;
    double sum = 0.0;
    for (std::size_t i = 0; i < count(); ++i) {
      const Variable& variable = alone_.variables()[i];
      const double f = std::abs(force[variable.at]);
      size += f * (std::abs(state.x[i]) + length_ * variable.unit);
      sum += f * std::abs(direction[i]);
    }
    rounding = std::max(rounding, kRounding * (size + std::abs(alone_.energy(state.time))));
    effort = std::max(effort, sum);
  };
  gauge(longest);
  gauge(-longest);

  // Romberg: row by row, each column an order of h^2 better.
  std::array<std::array<double, kDifferences>, kDifferences> slope{};
  double h = longest;
  for (int row = 0; row < kDifferences; ++row, h *= 0.5) {
    move_to(state, direction, h);
    const double above = alone_.energy(state.time);
    move_to(state, direction, -h);
    slope[row][0] = (above - alone_.energy(state.time)) / (2.0 * h);
    double gain = 4.0;
    for (int column = 1; column <= row; ++column, gain *= 4.0) {
      slope[row][column] =
          (gain * slope[row][column - 1] - slope[row - 1][column - 1]) / (gain - 1.0);
    }
  }
  const double best = slope[kDifferences - 1][kDifferences - 1];
  const double unsettled = std::abs(best - slope[kDifferences - 1][kDifferences - 2]);
  const double floor = rounding / (2.0 * h);

  place(state);
  const double difference = std::abs(best + work(direction, state.time));
  const bool smooth = unsettled <= kSettled * effort + floor;
  note(difference, effort, smooth ? floor + kTrust * unsettled : -1.0, where);
}

/// All coordinates at once, where a fault of any part shows, and one alone, where it shows best.
ClaimResult Examination::conservative() {
  return over_all_states("conservative", "force = -gradient of its energy",
                         [&](const State& state, Random& random) {
                           std::vector<double> direction(count());
                           for (std::size_t i = 0; i < count(); ++i) {
                             direction[i] = alone_.variables()[i].unit * random.symmetric();
                           }
                           slope_along(state, direction, "all coordinates together");
                           const std::size_t chosen = random.below(count());
                           const Variable& variable = alone_.variables()[chosen];
                           std::fill(direction.begin(), direction.end(), 0.0);
                           direction[chosen] = variable.unit;
                           slope_along(state, direction, name_of(variable));
                         });
}

ClaimResult Examination::internal() {
  double largest = 0.0;  // over the states so far
  // Through the sides of a box partners pull from elsewhere: torques do not cancel there.
  const std::vector<bool>& periodic = alone_.model().scene().box.periodic;
  const bool open = std::find(periodic.begin(), periodic.end(), true) == periodic.end();
  return over_all_states(
      "internal", open ? "forces and torques sum to zero" : "forces sum to zero",
      [&](const State& state, Random&) {
        place(state);
        const double* force = alone_.forces(state.time);
        double reach = length_;
        for (std::size_t i = 0; i < count(); ++i) {
          const Variable& variable = alone_.variables()[i];
          largest = std::max(largest, std::abs(force[variable.at]) * variable.unit);
          if (variable.axis >= 0) reach = std::max(reach, std::abs(state.x[i]));
        }
        ForceAlone::Wrench total;
        for (const std::size_t body : alone_.force().bodies) {
          const ForceAlone::Wrench wrench = alone_.wrench(body);
          for (int a = 0; a < 3; ++a) {
            total.force[a] += wrench.force[a];
            total.torque[a] += wrench.torque[a];
          }
        }
        const double terms = static_cast<double>(count());
        for (int a = 0; a < 3; ++a) {
          note(std::abs(total.force[a]), largest * terms, kRounding * largest * terms, "force");
          if (!open) continue;
          note(std::abs(total.torque[a]), largest * reach * terms,
               kRounding * largest * reach * terms, "torque");
        }
      });
}

ClaimResult Examination::dissipative() {
  return over_all_states(
      "dissipative", "its power is never positive", [&](const State& state, Random& random) {
        place(state);
        std::vector<double> velocity(count());
        for (std::size_t i = 0; i < count(); ++i) {
          const Variable& variable = alone_.variables()[i];
          velocity[i] = length_ * variable.unit * random.symmetric();
          alone_.velocity(variable) = velocity[i];
        }
        const double power = work(velocity, state.time);
        const double* force = alone_.forces(state.time);
        double size = 0.0;
        for (std::size_t i = 0; i < count(); ++i) {
          size += std::abs(force[alone_.variables()[i].at] * velocity[i]);
        }
        note(std::isfinite(power) ? std::max(power, 0.0) : power, size, kRounding * size);
      });
}

ClaimResult Examination::periodic() {
  double largest = 0.0;  // over the states so far: a force may vanish at the start
  return over_all_states(
      "periodic", "a shift by its period changes nothing", [&](const State& state, Random&) {
        const Scene& scene = alone_.model().scene();
        const SceneForce& from = scene.forces.front();
        place(state);
        const double* force = alone_.forces(state.time);
        std::vector<double> before;
        double reach = length_;
        for (std::size_t i = 0; i < count(); ++i) {
          const Variable& variable = alone_.variables()[i];
          before.push_back(force[variable.at]);
          largest = std::max(largest, std::abs(before.back()) * variable.unit);
          if (variable.axis >= 0) reach = std::max(reach, std::abs(state.x[i]));
        }
        for (int axis = 0; axis < scene.dimension; ++axis) {
          const double period = from.record->period(from.description.get(), axis);
          if (!(period > 0.0)) continue;
          std::vector<double> along(count(), 0.0);
          for (std::size_t i = 0; i < count(); ++i) {
            if (alone_.variables()[i].axis == axis) along[i] = period;
          }
          move_to(state, along, 1.0);
          const double* after = alone_.forces(state.time);
          std::size_t worst = 0;
          double most = -1.0;
          for (std::size_t i = 0; i < count(); ++i) {
            const Variable& variable = alone_.variables()[i];
            const double change = std::abs(after[variable.at] - before[i]) * variable.unit;
            if (change <= most) continue;
            most = change;
            worst = i;
          }
          // Places are rounded, and what a force makes of it grows with its own steepness.
          const double rounding = kRounding * (1.0 + kTau * (reach + period) / length_);
          note(most, largest, rounding * largest * static_cast<double>(count()),
               name_of(alone_.variables()[worst]));
        }
      });
}

std::string Examination::name_of(const Variable& variable) const {
  const Model::CoordinateName name = alone_.model().name_of(variable.at);
  const std::string particle = name.particle < 0 ? "" : fmt::format(", particle {}", name.particle);
  return name.body + particle + ", " + name.axis;
}

/// The shortest distance between particles that follow one another.
double shortest_spacing(const Model::Body& body) {
  double shortest = 0.0;
  for (std::size_t i = 1; i < body.bound.start.size(); ++i) {
    double square = 0.0;
    for (std::size_t d = 0; d < body.bound.start[i].size(); ++d) {
      const double apart = body.bound.start[i][d] - body.bound.start[i - 1][d];
      square += apart * apart;
    }
    const double distance = std::sqrt(square);
    if (distance > 0.0 && (shortest == 0.0 || distance < shortest)) shortest = distance;
  }
  return shortest;
}

double shortest_length(const Model& model) {
  double shortest = 0.0;
  const auto consider = [&](double length) {
    if (length > 0.0 && (shortest == 0.0 || length < shortest)) shortest = length;
  };
  for (const Model::Force& force : model.forces()) consider(force.bound->shortest_bond());
  for (const SceneForce& force : model.scene().forces) {
    for (int axis = 0; axis < model.dimension(); ++axis) {
      consider(force.record->period(force.description.get(), axis));
    }
  }
  for (const Model::Body& body : model.bodies()) {
    consider(body.rolling_radius);
    consider(shortest_spacing(body));
  }
  return shortest > 0.0 ? shortest : 1.0;
}

}  // namespace

std::vector<ClaimResult> check_claims(const Scene& scene, const ClaimOptions& options) {
  const double length = shortest_length(Model(std::make_shared<Scene>(scene)));
  std::vector<ClaimResult> results;
  for (std::size_t k = 0; k < scene.forces.size(); ++k) {
    ForceAlone alone(scene, k);
    if (!alone.built() || alone.variables().empty()) continue;
    const Traits traits = scene.forces[k].traits();
    Examination examination(alone, length, options);
    if (traits.conservative) results.push_back(examination.conservative());
    if (traits.internal) results.push_back(examination.internal());
    if (traits.dissipative) results.push_back(examination.dissipative());
    if (traits.periodic) results.push_back(examination.periodic());
  }
  return results;
}

}  // namespace tomlin
