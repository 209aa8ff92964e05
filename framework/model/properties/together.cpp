#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/numbers/constants.hpp"
#include "framework/core/text/axis_names.hpp"
#include "framework/model/properties/force_under_test.hpp"

/// All forces of a scene at once: kernels that are right alone may still tread on each other.
namespace tomlin::properties {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
/// Largest change of a rotation, in revolutions.
constexpr double kRotationChange = 0.05;
/// Displacements in parts of a length.
constexpr double kDisplacement = 0.1;

/// Builds with assertions begin an evaluation by filling the arrays of forces: what stands in them
/// is decided here.
#ifdef NDEBUG
constexpr std::size_t kFirstOperation = 0;
#else
constexpr std::size_t kFirstOperation = 1;
#endif

/// Some forces of the scene, bound; positions are relative to the origin of all of them.
class Bound {
 public:
  Bound(const Scene& scene, std::vector<SceneForce> forces, const IntegratorRecord& scheme,
        const Origin* origin = nullptr, bool backwards = false)
      : model_(with_forces(scene, std::move(forces), scheme)) {
    AssemblyPlan plan = model_.plan();
    if (origin != nullptr) plan.origin = *origin;
    plan.backwards = backwards;
    assembly_ = std::make_unique<Assembly<double>>(plan);
    StateLayout layout;
    assembly_->declare_controls(layout);
    controls_ = RunState(layout);
    assembly_->attach_controls(controls_);
    // Kernels may read a group past the end.
    for (auto* numbers : {&position, &velocity}) numbers->assign(view().dofs + 2 * kGroup, 0.0);
    for (auto* numbers : {&integrals, &rates}) numbers->assign(view().rates + 2 * kGroup, 0.0);
    assembly_->start(position.data(), velocity.data(), integrals.data(), nullptr);
    assembly_->start_controls();
    assembly_->rebase(plan.origin);
  }

  const Model& model() const { return model_; }
  const Origin& origin() const { return model_.origin(); }
  const Assembly<double>& assembly() const { return *assembly_; }
  const SystemView<double>& view() const { return assembly_->system().view; }

  void spoil() {
    assembly_->spoil_forces();
    std::fill_n(rates.begin(), view().used_rates, kNoNumber);
  }
  /// Zeros in place of forces, which no kernel can tell from having to set.
  void clear() {
    for (const auto& body : assembly_->bodies()) {
      const BodySlot<double>& slot = body.bound.slot;
      if (slot.rigid) std::fill_n(view().force + slot.centre, kGroup, 0.0);
      double* const from = (slot.mapped ? view().mapped_force : view().force) + slot.offset;
      const auto axes = static_cast<std::size_t>(model_.dimension());
      std::fill_n(from, axes * slot.stride, 0.0);
    }
  }
  void evaluate(double time) {
    assembly_->begin_step(DoubleDouble(time));
    const Stage<double> stage =
        stage_of(view(), position.data(), velocity.data(), integrals.data(), rates.data(), 0.0);
    for (std::size_t k = kFirstOperation; k < view().operation_count; ++k) {
      view().operations[k].run(view().operations[k].arguments, stage);
    }
  }

  AlignedVector<double> position, velocity, integrals, rates;

 private:
  Model model_;
  std::unique_ptr<Assembly<double>> assembly_;
  RunState controls_;
};

/// A number that forces add up to.
struct Number {
  enum class Of { coordinate, rate } of = Of::coordinate;
  std::size_t at = 0;  ///< of a coordinate
  std::string body;    ///< or driver
  std::ptrdiff_t particle = -1;
  std::string name;       ///< "x", "rotation", "power"
  std::size_t index = 0;  ///< of the body, or among the driver's rates
};

/// Sizes of what a rigid or prescribed body's particles contribute.
struct Shares {
  std::array<double, 3> force{};
  double torque = 0.0;
  double power = 0.0;
};

Shares shares_of(const Bound& bound, std::size_t body) {
  const BodySlot<double>& slot = bound.assembly().bodies()[body].bound.slot;
  const auto& arms = bound.assembly().bodies()[body].arms;
  const SystemView<double>& view = bound.view();
  Shares shares;
  for (std::size_t i = 0; i < slot.count; ++i) {
    double lever = 0.0;
    for (const double part : arms[i]) lever += std::abs(part);
    for (int d = 0; d < bound.model().dimension(); ++d) {
      const std::size_t at = slot.offset + d * slot.stride + i;
      const double size = std::abs(view.mapped_force[at]);
      shares.force[d] += size;
      shares.torque += kTau * lever * size;
      shares.power += size * std::abs(view.mapped_velocity[at]);
    }
  }
  return shares;
}

class Together {
 public:
  Together(const Scene& scene, double length, const PropertyOptions& options)
      : scheme_(without_demands(*scene.run.integrator.record)),
        all_(scene, scene.forces, scheme_),
        backwards_(scene, scene.forces, scheme_, nullptr, true),
        none_(scene, {}, scheme_, &all_.origin()),
        length_(length),
        options_(options) {
    for (const SceneForce& force : scene.forces) {
      auto alone =
          std::make_unique<Bound>(scene, std::vector<SceneForce>{force}, scheme_, &all_.origin());
      if (!alone->assembly().forces().empty()) alone_.push_back(std::move(alone));
    }
    list_numbers();
    start_ = State{};
    start_.x.assign(all_.position.begin(), all_.position.end());
    start_.v.assign(all_.velocity.begin(), all_.velocity.end());
    start_.own.assign(all_.integrals.begin(),
                      all_.integrals.begin() + static_cast<std::ptrdiff_t>(own_count()));
  }

  std::optional<PropertyResult> result() {
    if (alone_.empty() || numbers_.empty()) return std::nullopt;
    result_ = {kAllForces, "", "sum", "together they are the sum of each alone", true, 0.0,
               0.0,        0,  {}};
    Random random(options_.seed);
    for (int k = 0; k < options_.displaced_states; ++k) compare_at(displaced(random));
    State start = start_;
    start.kind = StateKind::start;
    compare_at(start);
    return result_;
  }

 private:
  std::size_t own_count() const { return all_.view().own_count; }

  /// Coordinates, held ones too, then what forces integrate and report.
  void list_numbers() {
    const int axes = all_.model().dimension();
    for (std::size_t b = 0; b < all_.assembly().bodies().size(); ++b) {
      const auto& body = all_.assembly().bodies()[b].bound;
      const BodySlot<double>& slot = body.slot;
      const auto add = [&](std::size_t at, std::ptrdiff_t particle, const char* name) {
        numbers_.push_back({Number::Of::coordinate, at, body.name, particle, name, b});
      };
      for (int d = 0; d < axes; ++d) {
        if (slot.rigid) add(slot.centre + static_cast<std::size_t>(d), -1, kAxisNames[d]);
        for (std::size_t i = 0; !slot.mapped && i < slot.count; ++i) {
          add(slot.offset + static_cast<std::size_t>(d) * slot.stride + i,
              static_cast<std::ptrdiff_t>(i), kAxisNames[d]);
        }
      }
      if (slot.rigid && axes == 2) add(slot.centre + kRotation, -1, "rotation");
    }
    // Own variables come in the order of the forces, after those of prescribed motions.
    std::size_t steered = own_count();
    for (const auto& alone : alone_) {
      steered -= alone->assembly().forces().front().variables->own_count();
    }
    steered_ = steered;
    for (const auto& driver : all_.assembly().drivers()) {
      for (int d = 0; d <= axes; ++d) {
        numbers_.push_back({Number::Of::rate, 0, driver.name, -1,
                            d == axes ? "power" : kAxisNames[d], static_cast<std::size_t>(d)});
      }
    }
  }

  State displaced(Random& random) {
    State state = start_;
    state.kind = StateKind::near;
    const SystemView<double>& view = all_.view();
    for (std::size_t i = 0; i < view.dofs; ++i) {
      if (!(view.inverse_mass[i] > 0.0)) continue;
      state.x[i] += kDisplacement * length_ * random.symmetric();
      state.v[i] = length_ * random.symmetric();
    }
    for (const auto& body : all_.assembly().bodies()) {
      if (!body.bound.slot.rigid || all_.model().dimension() != 2) continue;
      const std::size_t at = body.bound.slot.centre + kRotation;
      if (!(view.inverse_mass[at] > 0.0)) continue;
      state.x[at] = start_.x[at] + kRotationChange * random.symmetric();
      state.v[at] = random.symmetric();
    }
    for (double& own : state.own) own += kDisplacement * length_ * random.symmetric();
    double latest = all_.model().scene().run.duration;
    for (const auto& driver : all_.assembly().drivers()) {
      for (const double velocity : driver.drive->velocity) {
        if (velocity != 0.0) latest = std::min(latest, length_ / std::abs(velocity));
      }
    }
    state.time = 0.5 * (1.0 + random.symmetric()) * latest;
    return state;
  }

  /// Own variables of one force alone follow those of prescribed motions.
  void put(const State& state, Bound& bound, std::size_t first_own, std::size_t own) const {
    std::copy(state.x.begin(), state.x.end(), bound.position.begin());
    std::copy(state.v.begin(), state.v.end(), bound.velocity.begin());
    const auto from = [&](std::size_t k) {
      return state.own.begin() + static_cast<std::ptrdiff_t>(k);
    };
    std::copy(from(0), from(steered_), bound.integrals.begin());
    std::copy(from(first_own), from(first_own + own),
              bound.integrals.begin() + static_cast<std::ptrdiff_t>(steered_));
  }

  void compare_at(const State& state) {
    std::vector<double> sum(numbers_.size(), 0.0);
    std::vector<double> size(numbers_.size(), 0.0);
    std::vector<double> own_rates;
    std::vector<std::vector<double>> parts;
    std::size_t own = steered_;
    put(state, none_, steered_, 0);
    none_.clear();
    none_.evaluate(state.time);
    for (std::size_t k = 0; k < numbers_.size(); ++k) sum[k] = part_of(none_, numbers_[k]);
    for (const auto& alone : alone_) {
      const std::size_t count = alone->assembly().forces().front().variables->own_count();
      put(state, *alone, own, count);
      own += count;
      alone->clear();
      alone->evaluate(state.time);
      add(*alone, sum, size);
      parts.emplace_back();
      for (const Number& number : numbers_) parts.back().push_back(part_of(*alone, number));
      const auto first = alone->rates.begin() + static_cast<std::ptrdiff_t>(steered_);
      own_rates.insert(own_rates.end(), first, first + static_cast<std::ptrdiff_t>(count));
    }
    // Numbers of single forces that are not finite are checked elsewhere.
    for (const double total : sum) {
      if (!std::isfinite(total)) return;
    }
    ++result_.states;
    for (std::size_t k = 0; k < alone_.size(); ++k) {
      alone_[k]->spoil();
      alone_[k]->evaluate(state.time);
      compare_bits(*alone_[k], parts[k], state);
    }
    for (Bound* bound : {&all_, &backwards_}) {
      put(state, *bound, steered_, own_count() - steered_);
      bound->spoil();
      bound->evaluate(state.time);
      std::vector<double> found(numbers_.size());
      for (std::size_t k = 0; k < numbers_.size(); ++k) {
        found[k] = part_of(*bound, numbers_[k]);
        const double allowed = kRounding * size[k] + kSmallest;
        note(found[k], sum[k], size[k], allowed, state, numbers_[k]);
      }
      for (std::size_t k = 0; k < own_rates.size(); ++k) {
        note(bound->rates[steered_ + k], own_rates[k], std::abs(own_rates[k]), 0.0, state,
             {Number::Of::rate, 0, "a force's own variable", -1, "", 0});
      }
      bound->evaluate(state.time);
      compare_bits(*bound, found, state);
    }
  }

  void compare_bits(const Bound& bound, const std::vector<double>& expected, const State& state) {
    for (std::size_t k = 0; k < numbers_.size(); ++k) {
      const double again = part_of(bound, numbers_[k]);
      const bool same =
          std::bit_cast<std::uint64_t>(again) == std::bit_cast<std::uint64_t>(expected[k]);
      if (!same) note(again, expected[k], std::abs(expected[k]), 0.0, state, numbers_[k]);
    }
  }

  /// Share of some of the forces in a number: a driver's is zero where it is not among them.
  static double part_of(const Bound& bound, const Number& number) {
    if (number.of == Number::Of::coordinate) return bound.view().force[number.at];
    for (const auto& driver : bound.assembly().drivers()) {
      if (driver.name != number.body) continue;
      return bound.rates[static_cast<std::size_t>(driver.first_rate) + number.index];
    }
    return 0.0;
  }

  void add(const Bound& alone, std::vector<double>& sum, std::vector<double>& size) const {
    for (std::size_t k = 0; k < numbers_.size(); ++k) {
      const Number& number = numbers_[k];
      const double part = part_of(alone, number);
      const double of_none = part_of(none_, number);
      sum[k] += part - of_none;
      size[k] += std::abs(part) + 2.0 * std::abs(of_none);
      if (number.of == Number::Of::rate) {
        size[k] += shares_of_driver(alone, number.body, number.index);
      } else if (number.particle < 0) {
        const Shares shares = shares_of(alone, number.index);
        size[k] += number.name == "rotation" ? shares.torque : shares.force[number.at % kGroup];
      }
    }
  }

  /// Shares of what acts on the particles of a driver that is a prescribed body.
  static double shares_of_driver(const Bound& alone, const std::string& name, std::size_t index) {
    for (std::size_t b = 0; b < alone.assembly().bodies().size(); ++b) {
      const auto& body = alone.assembly().bodies()[b];
      if (!body.prescribed() || body.bound.name != name) continue;
      const Shares shares = shares_of(alone, b);
      const bool is_power = index == static_cast<std::size_t>(alone.model().dimension());
      return is_power ? shares.power : shares.force[index];
    }
    return 0.0;
  }

  void note(double found, double expected, double size, double allowed, const State& state,
            const Number& number) {
    const double difference = found == expected ? 0.0 : std::abs(found - expected);
    const bool holds = difference <= allowed;  // false for NaN
    const double strain = holds ? (allowed > 0.0 ? difference / allowed : 0.0)
                          : difference > 0.0 && allowed > 0.0
                              ? difference / allowed
                              : std::numeric_limits<double>::infinity();
    result_.holds = result_.holds && holds;
    if (!(strain > strain_)) return;
    strain_ = strain;
    result_.error = size > 0.0 ? difference / size : difference;
    result_.allowed = size > 0.0 ? allowed / size : 0.0;
    result_.worst = {};
    result_.worst.state = name_of(state.kind);
    result_.worst.body = number.body;
    result_.worst.particle = number.particle;
    result_.worst.coordinate = number.name;
    result_.worst.time = state.time;
    result_.worst.found = found;
    result_.worst.expected = expected;
  }

  IntegratorRecord scheme_;
  Bound all_;
  Bound backwards_;
  Bound none_;  ///< bodies that move as prescribed have a force that keeps them moving even so
  std::vector<std::unique_ptr<Bound>> alone_;
  double length_;
  PropertyOptions options_;
  std::size_t steered_ = 0;
  std::vector<Number> numbers_;
  State start_;
  PropertyResult result_;
  double strain_ = -1.0;
};

}  // namespace

std::optional<PropertyResult> sum_of_all(const Scene& scene, double length,
                                         const PropertyOptions& options) {
  return Together(scene, length, options).result();
}

}  // namespace tomlin::properties
