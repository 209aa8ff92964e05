#include "forcefields/driving_spring.hpp"

#include <algorithm>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/core/elements/site_force.hpp"
#include "framework/core/records/facets.hpp"
#include "framework/core/records/force.hpp"
#include "framework/core/text/axis_names.hpp"
#include "framework/core/text/fault_code.hpp"

TOMLIN_DECLARE_KERNELS(DrivingSpring)

namespace tomlin {
namespace {

using Description = DrivingSpringDescription;

std::vector<Complaint> complaints(const Description& d, const SceneOutline& scene) {
  std::vector<Complaint> found;
  const auto axes = static_cast<std::size_t>(scene.dimension);
  const std::size_t given = d.stiffness.numbers.size();
  if (given != 1 && given != axes) {
    found.push_back({.key = "stiffness",
                     .why = fmt::format("{} numbers for {} dimensions", given, axes),
                     .admissible = "one for all axes, or one per axis",
                     .code = FaultCode::scene_wrong_count});
    return found;
  }
  for (const std::string& axis : d.axes.words) {
    if (static_cast<int>(*value_named<Axis>(axis)) < scene.dimension) continue;
    found.push_back({.key = "axes",
                     .why = fmt::format("\"{}\" is no axis of a scene with {} dimension{}", axis,
                                        axes, axes == 1 ? "" : "s"),
                     .code = FaultCode::scene_out_of_range});
  }
  double most = 0.0;
  for (int axis = 0; axis < scene.dimension; ++axis) most = std::max(most, stiffness_on(d, axis));
  if (found.empty() && !(most > 0.0)) {
    found.push_back({.key = "stiffness",
                     .why = "out of range: zero along every axis",
                     .admissible = "a number > 0 along one axis at least",
                     .code = FaultCode::scene_out_of_range});
  }
  return found;
}

/// Either kind of bound spring, with a support that follows from the time alone.
template <class Base, class Real, int D>
class Driven : public Base, public Control, public PulledEnd {
 public:
  template <class... Arguments>
  Driven(const Description& description, const Binding<Real>& binding, Arguments&&... arguments)
      : Base(description, binding, std::forward<Arguments>(arguments)...),
        velocity_(description.velocity.components),
        reverse_(description.reverse),
        starts_at_point_(description.start.components.empty()),
        of_each_(description.attach.kind == Attachment::Kind::each_particle) {
    drive_.velocity = description.velocity.components;
    const double springs = of_each_ ? static_cast<double>(this->body_.slot.count) : 1.0;
    for (int k = 0; k < D; ++k) {
      drive_.stiffness.push_back(springs * stiffness_on(description, k));
      if (!description.start.components.empty()) {
        drive_.start.push_back(relative_to(binding.origin, k, description.start.components[k]));
      } else if (description.attach.kind == Attachment::Kind::particle) {
        drive_.start.push_back(this->body_.start[description.attach.particle][k]);
      } else if (of_each_) {
        // Equal springs pull together as one from the plain mean of their ends.
        InterleavedSum<double> ends;
        for (std::size_t i = 0; i < this->body_.slot.count; ++i) {
          ends.add(i, this->body_.start[i][k]);
        }
        drive_.start.push_back(ends.total() / static_cast<double>(this->body_.slot.count));
      } else {
        drive_.start.push_back(this->body_.start_centre[k]);
      }
    }
    drive_.travel.assign(D, 0.0);
    rebase(binding.origin);
  }

  bool depends_on_time() const override { return true; }

  /// A kernel computes the support from the time in lanes, unless the spring may reverse.
  std::vector<Pass<Real>> passes() override {
    std::vector<Pass<Real>> all = Base::passes();
    if constexpr (std::is_same_v<Real, double>) {
      const auto* const first = reinterpret_cast<const double*>(&this->with_frame_);
      for (int k = 0; k < D && reverse_.when.empty(); ++k) {
        const double* const travel = &this->parameters_.travel[k];
        all.front().lanes.travels.push_back({static_cast<std::size_t>(travel - first),
                                             &velocity_[static_cast<std::size_t>(k)], &shift_[k]});
      }
    }
    return all;
  }

  /// Elapsed time and travel in twice double precision: a driver 1e9 periods on still knows its
  /// position within the cell to the last digit.
  void begin_step(const DoubleDouble& time) override {
    for (int k = 0; k < D; ++k) {
      if (control_ != nullptr) {
        drive_.velocity[k] = control_[kSign] * velocity_[k];
        this->parameters_.velocity[k] = Real(drive_.velocity[k]);
      }
      const DoubleDouble travel = travelled_on(k, time) - shift_[k];
      this->parameters_.travel[k] = from_double_double<Real>(travel);
      drive_.travel[k] = static_cast<double>(travel);
    }
  }

  void rebase(const Origin& origin) override {
    Base::rebase(origin);
    for (int k = 0; k < D; ++k) {
      const auto cells = static_cast<double>(origin.cells[k] - this->first_origin_.cells[k]);
      shift_[k] = DoubleDouble(cells) * origin.unit[k];
    }
  }

  const Drive* drive() const override { return &drive_; }

  std::vector<DoubleDouble> travelled(const DoubleDouble& time) const override {
    std::vector<DoubleDouble> travel(D);
    for (int k = 0; k < D; ++k) travel[static_cast<std::size_t>(k)] = travelled_on(k, time);
    return travel;
  }
  void begin_at(const std::vector<DoubleDouble>& travel) override {
    for (int k = 0; k < D; ++k) began_[k] = travel[static_cast<std::size_t>(k)];
  }

  void rests_at_first() override { rests_ = true; }
  void set_out(const DoubleDouble& time, const std::vector<DoubleDouble>& travel) override {
    for (int k = 0; k < D; ++k) keep_travel(k, travel[static_cast<std::size_t>(k)]);
    keep_since(time);
    control_[kSign] = 1.0;
  }
  bool starts_at_point() const override { return starts_at_point_; }
  bool is_of_each_particle() const override { return of_each_; }

  const Passing* waits_for() const override { return reverse_.when.empty() ? nullptr : &reverse_; }
  std::size_t control_count() const override { return waits_for() || rests_ ? kTravel + 2 * D : 0; }
  void attach_control(double* control) override { control_ = control; }
  void start_control() override {
    if (control_ == nullptr) return;
    std::fill(control_, control_ + control_count(), 0.0);
    for (int k = 0; k < D; ++k) keep_travel(k, began_[k]);
    control_[kSign] = rests_ ? 0.0 : 1.0;
    control_[kTimesLeft] = waits_for() ? static_cast<double>(reverse_.times) : 0.0;
  }
  bool waits() const override { return control_ != nullptr && control_[kTimesLeft] > 0.0; }

  /// A new segment of its way: it starts here and now, backwards.
  void passed(const DoubleDouble& time) override {
    for (int k = 0; k < D; ++k) keep_travel(k, travelled_on(k, time));
    keep_since(time);
    control_[kSign] = -control_[kSign];
    control_[kTimesLeft] -= 1.0;
  }

 private:
  /// Entries of the control: sign of the velocity (0: it has not set out), reversals that are left,
  /// when the last one was, and the travel of the support by then, high and low parts.
  enum { kSign, kTimesLeft, kSince, kTravel = kSince + 2 };

  void keep_since(const DoubleDouble& time) {
    control_[kSince] = time.hi;
    control_[kSince + 1] = time.lo;
  }
  void keep_travel(int k, const DoubleDouble& travel) {
    control_[kTravel + 2 * k] = travel.hi;
    control_[kTravel + 2 * k + 1] = travel.lo;
  }

  DoubleDouble travelled_on(int k, const DoubleDouble& time) const {
    if (control_ == nullptr) {
      const DoubleDouble since_start = time * velocity_[k];
      return began_[k] == DoubleDouble() ? since_start : began_[k] + since_start;
    }
    const DoubleDouble since(control_[kSince], control_[kSince + 1]);
    const DoubleDouble before(control_[kTravel + 2 * k], control_[kTravel + 2 * k + 1]);
    return before + (time - since) * (control_[kSign] * velocity_[k]);
  }

  std::vector<double> velocity_;  ///< as given
  Passing reverse_;
  bool starts_at_point_ = false;
  bool of_each_ = false;
  bool rests_ = false;     ///< until it sets out
  DoubleDouble began_[D];  ///< how far it had travelled at time 0
  double* control_ = nullptr;
  DoubleDouble shift_[D];
  Drive drive_;
};

template <class Real>
std::unique_ptr<BoundForce<Real>> bind(const Description& d, const Binding<Real>& binding) {
  return for_dimension<Real>(binding.dimension, [&]<int D>() -> std::unique_ptr<BoundForce<Real>> {
    if (d.attach.kind == Attachment::Kind::each_particle) {
      return std::make_unique<Driven<ParticleForce<DrivingSpring, Real, D>, Real, D>>(
          d, binding, kernels::DrivingSpring, kRankCheap, d.start.components);
    }
    const std::ptrdiff_t particle = d.attach.kind == Attachment::Kind::particle
                                        ? static_cast<std::ptrdiff_t>(d.attach.particle)
                                        : kCentreOfMass;
    return std::make_unique<Driven<AttachedForce<DrivingSpring, Real, D>, Real, D>>(
        d, binding, kernels::DrivingSpring, kRankCheap, particle, d.start.components);
  });
}

}  // namespace

double stiffness_on(const Description& d, int axis) {
  const auto& axes = d.axes.words;
  const char* const name = kAxisNames[static_cast<std::size_t>(axis)];
  if (!axes.empty() && std::find(axes.begin(), axes.end(), name) == axes.end()) return 0.0;
  const auto& numbers = d.stiffness.numbers;
  return numbers.size() == 1 ? numbers.front() : numbers.at(static_cast<std::size_t>(axis));
}

ForceRecord driving_spring_record() {
  auto record = record_of<Description>();
  record.name = "driving_spring";
  record.summary = "a spring whose support moves at constant velocity";
  record.equation =
      "F = stiffness * (start + velocity * t - x), axis by axis, on the attached point x";
  record.source =
      "A. Sircar and P. K. Patra, A simple generalization of Prandtl-Tomlinson model to study"
      " nanoscale rolling friction, J. Appl. Phys. 127 (2020), doi:10.48550/arXiv.1912.00232,"
      " eqs. (4) to (6); L. Prandtl, Z. Angew. Math. Mech. 8 (1928) 85, "
      "doi:10.1002/zamm.19280080202";
  record.element = Element::body;
  record.traits = traits_of_sites<DrivingSpring>();
  record.parameters = {
      parameter("stiffness", &Description::stiffness, dimension::stiffness,
                "of the spring, one for all axes or one per axis (0: free along it); of each "
                "particle's spring with attach = \"each_particle\"")
          .in(non_negative),
      parameter("axes", &Description::axes, dimension::none,
                "along which the spring acts: \"x\", \"y\", \"z\"; all by default")
          .one_of({"x", "y", "z"})
          .or_absent(),
      parameter("velocity", &Description::velocity, dimension::velocity, "of the support"),
      parameter("attach", &Description::attach, dimension::none,
                "\"centre_of_mass\", \"each_particle\" or { particle = i }")
          .by_default(Attachment{}),
      parameter("start", &Description::start, dimension::length,
                "position of the support when the spring becomes active, at t = 0 without "
                "`active`; the attached point by default")
          .or_absent(),
      parameter("reverse", &Description::reverse, dimension::none,
                "reverse when an observable passes a value: { when = "
                "\"bodies.NAME.centre_of_mass.x\", above = VALUE }, or below; times = 1; with both "
                "and without times, alternately as long as the run lasts")
          .or_absent()};
  record.complaints = of_description<&complaints>;
  record.bind = {of_description<&bind<double>>, of_description<&bind<Quad>>};
  record.example = R"(# A damped particle follows a spring.
[[body]]
type = "point"
position = [0.0]
particle_mass = 1.0

[[force]]
type = "driving_spring"
stiffness = 2.0
velocity = [0.1]

[[force]]
type = "viscous_damping"
coefficient = 1.0

[run]
duration = 10.0
integrator = { type = "rk4", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
