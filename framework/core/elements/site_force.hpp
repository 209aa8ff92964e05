#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "framework/core/elements/element.hpp"
#include "framework/core/elements/kernel_tables.hpp"
#include "framework/core/numbers/double_double.hpp"
#include "framework/core/numbers/number_types.hpp"
#include "framework/core/numbers/sum.hpp"
#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/force.hpp"

/// Bound forces on sites, made from an evaluator: on every particle of a body, or on one attached
/// point of it. The hot loops come from the kernel tables; what runs rarely is written here.
namespace tomlin {

/// In place of a particle's index.
inline constexpr std::ptrdiff_t kCentreOfMass = -1;

/// Numbers of one particle of a body.
template <int D, class Real>
Vec<Real, D> vector_at(const BodySlot<Real>& slot, const Real* plain, const Real* mapped,
                       std::size_t particle) {
  const Real* from = (slot.mapped ? mapped : plain) + slot.offset + particle;
  Vec<Real, D> x;
  for (int d = 0; d < D; ++d) x[d] = from[d * slot.stride];
  return x;
}

/// False where a component is infinite, or no number.
template <class Real, int D>
bool is_finite(const Vec<Real, D>& x) {
  bool finite = true;
  for (int d = 0; d < D; ++d) finite = finite && x[d] - x[d] == Real(0.0);
  return finite;
}

/// d2V/dx_a dx_b of a site, from the derivative of the force.
template <class E, class Real, int D, class Use>
void for_curvature(const typename E::template Parameters<Real, D>& p, const Site<Real, D>& site,
                   Use&& use) {
  const auto force =
      force_on<E, Dual<Real, D>, D>(in_type<E, Dual<Real, D>, Real, D>(p), differentiable(site));
  for (int a = 0; a < D; ++a) {
    for (int b = 0; b < D; ++b) use(a, b, static_cast<double>(-force[a].derivative[b]));
  }
}

/// The period of a force along an axis; 0 where it has none.
template <class E>
double period_along(const typename E::Description& description, int axis) {
  if constexpr (requires { E::period(description, axis); }) return E::period(description, axis);
  return 0.0;
}

/// Position of a force's zero along an axis.
template <class E>
double offset_along(const typename E::Description& description, int axis) {
  if constexpr (requires { E::offset(description, axis); }) return E::offset(description, axis);
  return 0.0;
}

template <class E, class Real, int D>
Frame<Real, D> frame_at(const typename E::Description& description, const Origin& origin) {
  Frame<Real, D> frame{};
  for (int axis = 0; axis < D; ++axis) {
    const DoubleDouble shift =
        DoubleDouble(static_cast<double>(origin.cells[axis])) * DoubleDouble(origin.unit[axis]);
    frame.origin[axis] = from_double_double<Real>(shift);
    const double period = period_along<E>(description, axis);
    if (!(period > 0.0)) continue;
    std::int64_t periods = 0;
    const DoubleDouble from_zero = shift - DoubleDouble(offset_along<E>(description, axis));
    frame.wave_number[axis] = Real(1.0) / Real(period);
    frame.phase[axis] = Real(remainder_of(from_zero, period, periods)) / Real(period);
  }
  return frame;
}

/// Numbers of a body that replicas in lanes have alike.
template <class Real>
std::vector<std::int64_t> structure_of(const BodySlot<Real>& body, std::ptrdiff_t rate) {
  std::vector<std::int64_t> numbers;
  for (const std::size_t one : {body.offset, body.stride, body.count, body.centre}) {
    numbers.push_back(static_cast<std::int64_t>(one));
  }
  numbers.insert(numbers.end(), {body.mapped ? 1 : 0, body.rigid ? 1 : 0, rate});
  return numbers;
}

/// A structure that holds nothing but doubles.
template <class Numbers>
std::span<const double> numbers_in(const Numbers& numbers) {
  static_assert(sizeof(Numbers) % sizeof(double) == 0);
  return {reinterpret_cast<const double*>(&numbers), sizeof(Numbers) / sizeof(double)};
}

/// Common parts of sites of either kind: parameters, frame, rates, bounds.
template <class E, class Real, int D>
class ForceOnSites : public BoundForce<Real>,
                     public Curvature<Real>,
                     public FrictionCoefficients,
                     public Driving {
 public:
  using Parameters = typename E::template Parameters<Real, D>;
  using Description = typename E::Description;

  ForceOnSites(const typename E::Description& description, const Binding<Real>& binding)
      : description_(description),
        with_frame_(parameters_at(description, binding.origin)),
        parameters_(with_frame_.own),
        body_(*binding.bodies.front()),
        first_origin_(binding.origin) {}
  ForceOnSites(const ForceOnSites&) = delete;

  std::size_t rate_count() const override { return kDoesWork ? D + 1 : 0; }

  /// A class that overrides this calls it: the frame of the sites is set here.
  void rebase(const Origin& origin) override { follow(with_frame_, description_, origin); }

  double curvature_bound() const override {
    return largest([](const Description& d) { return bound_of(d); });
  }
  double curvature_bound_along(int axis) const override {
    return largest([axis](const Description& d) { return bound_along(d, axis); });
  }

  double friction_bound() const override {
    return largest([](const Description& d) {
      if constexpr (requires { E::friction_bound(d); }) return E::friction_bound(d);
      return 0.0;
    });
  }

  static constexpr bool kDoesWork = DoesWork<E, D>;

 protected:
  static constexpr bool kHasFriction = requires(const Parameters& p) { E::friction(p); };

  bool varies() const { return !variations_.empty(); }
  Description description_at(std::size_t particle) const {
    Description description = description_;
    assign_particle(variations_, particle, &description);
    return description;
  }

  /// Updates the numbers that follow from the position of the origin.
  static void follow(SiteParameters<E, Real, D>& p, const typename E::Description& description,
                     const Origin& origin) {
    p.frame = frame_at<E, Real, D>(description, origin);
    // An evaluator may have parameters that follow from the origin in another way.
    if constexpr (requires { E::template rebase<Real, D>(p.own, description, origin); }) {
      E::template rebase<Real, D>(p.own, description, origin);
    }
  }
  static SiteParameters<E, Real, D> parameters_at(const typename E::Description& description,
                                                  const Origin& origin) {
    SiteParameters<E, Real, D> p{E::template parameters<Real, D>(description), {}};
    follow(p, description, origin);
    return p;
  }

  Description description_;
  SiteParameters<E, Real, D> with_frame_;
  Parameters& parameters_;
  BoundBody<Real> body_;
  Origin first_origin_;
  std::vector<Variation> variations_;  ///< parameters that differ between particles

 private:
  static double bound_of(const Description& d) {
    if constexpr (requires { E::template curvature_bound<D>(d); }) {
      return E::template curvature_bound<D>(d);
    }
    return -1.0;
  }
  static double bound_along(const Description& d, int axis) {
    if constexpr (requires { E::template curvature_bound_along<D>(d, axis); }) {
      return E::template curvature_bound_along<D>(d, axis);
    }
    return bound_of(d);
  }

  /// Largest value over all particles of a bound that follows from a description.
  template <class Bound>
  double largest(Bound bound) const {
    double most = bound(description_);
    for (std::size_t i = 0; varies() && i < body_.slot.count; ++i) {
      most = std::max(most, bound(description_at(i)));
    }
    return most;
  }
};

/// The evaluator on every particle of a body. `start`, in the scene's coordinates, is where
/// drivers' ends are at time 0; empty: each at its own particle. Parameters may differ between the
/// particles, for evaluators that neither drive nor read starts.
template <class E, class Real, int D>
class ParticleForce : public ForceOnSites<E, Real, D> {
  using Base = ForceOnSites<E, Real, D>;

 public:
  ParticleForce(const typename E::Description& description, const Binding<Real>& binding,
                const KernelTables& tables, int rank, const std::vector<double>& start = {})
      : Base(description, binding),
        kernels_(tables.on<Real>(binding.set).site),
        lanes_(tables.on<Real>(binding.set).lanes),
        point_(tables.on<Real>(binding.set).point),
        heat_kernel_(tables.on<Real>(binding.set).heat[D - 1]),
        energy_(tables.on<Real>(binding.set).site_energy[D - 1]),
        rank_(rank) {
    arguments_.body = this->body_.slot;
    arguments_.parameters = &this->with_frame_;
    if (!binding.variations.empty()) {
      this->variations_.assign(binding.variations.begin(), binding.variations.end());
      varied_kernel_ = tables.on<Real>(binding.set).varied_site[D - 1];
      heat_kernel_ = tables.on<Real>(binding.set).varied_heat[D - 1];
      energy_ = tables.on<Real>(binding.set).varied_site_energy[D - 1];
      vary(binding.origin);
    }
    if constexpr (E::reads.table) arguments_.table = E::table(this->description_);
    if constexpr (E::reads.start) {
      start_.assign(D * this->body_.slot.stride, Real(0.0));
      for (std::size_t i = 0; i < this->body_.slot.count; ++i) {
        for (int d = 0; d < D; ++d)
          start_[d * this->body_.slot.stride + i] = Real(
              start.empty() ? this->body_.start[i][d] : relative_to(binding.origin, d, start[d]));
      }
      arguments_.start = start_.data();
    }
  }

  std::vector<Pass<Real>> passes() override {
    const std::vector<Region> writes = {{this->body_.index, false}};
    if (varies()) return {{nullptr, varied_kernel_, &arguments_, writes, rank_, lane_form()}};
    PointForce<Real> point;
    if (D == 1 && this->body_.slot.count == 1 && !E::reads.table) {
      point = {point_, &this->with_frame_, start_.empty() ? Real(0.0) : start_[0], arguments_.rate};
    }
    return {
        {kernels_.set[D - 1], kernels_.add[D - 1], &arguments_, writes, rank_, lane_form(), point}};
  }

  void rebase(const Origin& origin) override {
    Base::rebase(origin);
    if (varies()) vary(origin);
  }

  void place_rates(std::ptrdiff_t first) override { arguments_.rate = first; }

  Real energy(const Stage<Real>& stage) const override {
    return energy_ ? energy_(&arguments_, stage) : Real(0.0);
  }

  bool heat(std::ptrdiff_t rate, Operation<Real>& operation) override {
    if (!heat_kernel_) return false;
    heat_ = {this->body_.slot, &this->with_frame_, arguments_.each, rate};
    heat_lanes_ = lane_form();
    heat_lanes_.kernel = (varies() ? lanes_.varied_heat : lanes_.heat)[D - 1];
    heat_lanes_.structure = structure_of(this->body_.slot, rate);
    operation = {heat_kernel_, &heat_, &heat_lanes_};
    return true;
  }

  bool is_friction() const override { return Base::kHasFriction; }

  void hessian(const Stage<Real>& stage, HessianSink& sink) const override {
    if constexpr (HasEnergy<E, D, Site>) {
      for (std::size_t i = 0; i < this->body_.slot.count; ++i) {
        for_curvature<E, Real, D>(at(i).own, site(stage, i), [&](int a, int b, double value) {
          sink.site(this->body_.index, i, a, b, value);
        });
      }
    }
  }

  void friction(FrictionSink& sink) const override {
    if constexpr (Base::kHasFriction) {
      for (std::size_t i = 0; i < this->body_.slot.count; ++i) {
        const auto coefficient = static_cast<double>(E::friction(at(i).own));
        sink.site(this->body_.index, i, coefficient);
        if constexpr (requires(const typename E::Description& d) { E::temperature(d); }) {
          const double temperature = E::temperature(description_at(i));
          if (temperature > 0.0) sink.bath(this->body_.index, i, coefficient, temperature);
        }
      }
    }
  }

 private:
  using Base::description_at;
  using Base::varies;
  LaneForm lane_form() const {
    LaneForm form;
    if constexpr (std::is_same_v<Real, double>) {
      form.kernel = (varies() ? lanes_.varied_site : lanes_.site)[D - 1];
      form.numbers = {
          varies() ? std::span<const double>(by_number_) : numbers_in(this->with_frame_), start_};
      form.structure = structure_of(this->body_.slot, arguments_.rate);
      form.follows_time = this->depends_on_time();
    }
    return form;
  }
  const SiteParameters<E, Real, D>& at(std::size_t particle) const {
    return varies() ? each_[particle] : this->with_frame_;
  }
  /// Every particle's parameters, and the same number by number for the kernels. The padding
  /// repeats the last particle's.
  void vary(const Origin& origin) {
    using Each = SiteParameters<E, Real, D>;
    struct Numbers {
      Real value[sizeof(Each) / sizeof(Real)];
    };
    const BodySlot<Real>& slot = this->body_.slot;
    each_.resize(slot.count);
    by_number_.resize(slot.stride * (sizeof(Each) / sizeof(Real)));
    for (std::size_t i = 0; i < slot.stride; ++i) {
      const std::size_t particle = std::min(i, slot.count - 1);
      if (i == particle) each_[i] = Base::parameters_at(description_at(i), origin);
      const auto numbers = std::bit_cast<Numbers>(each_[particle]);
      for (std::size_t k = 0; k < std::size(numbers.value); ++k) {
        by_number_[k * slot.stride + i] = numbers.value[k];
      }
    }
    arguments_.each = by_number_.data();
  }

  Site<Real, D> site(const Stage<Real>& stage, std::size_t i) const {
    const BodySlot<Real>& slot = this->body_.slot;
    Site<Real, D> site{};
    site.position = vector_at<D>(slot, stage.position, stage.mapped_position, i);
    if constexpr (E::reads.velocity) {
      site.velocity = vector_at<D>(slot, stage.velocity, stage.mapped_velocity, i);
    }
    if constexpr (E::reads.start) {
      for (int d = 0; d < D; ++d) site.start[d] = start_[d * slot.stride + i];
    }
    site.elapsed = stage.elapsed;
    site.frame = at(i).frame;
    site.table = arguments_.table;
    return site;
  }

  const KernelPair<Real>& kernels_;
  const LaneKernels& lanes_;
  PointKernel<Real> point_;
  Kernel<Real> heat_kernel_;
  EnergyKernel<Real> energy_;  ///< null: the force has none
  int rank_;
  SiteArguments<Real> arguments_;
  HeatArguments<Real> heat_;
  LaneForm heat_lanes_;
  AlignedVector<Real> start_;
  // These members are for parameters that differ between particles.
  Kernel<Real> varied_kernel_ = nullptr;
  std::vector<SiteParameters<E, Real, D>> each_;
  AlignedVector<Real> by_number_;  ///< [number * stride + particle]
};

/// The evaluator on one attached point: a body's centre of mass, or one particle of it. Kernels of
/// such points are made of evaluators that read where they start.
template <class E, class Real, int D>
class AttachedForce : public ForceOnSites<E, Real, D> {
  using Base = ForceOnSites<E, Real, D>;
  static_assert(E::reads.start && !E::reads.table);

 public:
  /// `particle` may be kCentreOfMass; `start` in the scene's coordinates, empty: the attached
  /// point.
  AttachedForce(const typename E::Description& description, const Binding<Real>& binding,
                const KernelTables& tables, int rank, std::ptrdiff_t particle = kCentreOfMass,
                const std::vector<double>& start = {})
      : Base(description, binding),
        kernels_(tables.on<Real>(binding.set).centre),
        lanes_(tables.on<Real>(binding.set).lanes),
        point_(tables.on<Real>(binding.set).point),
        rank_(rank) {
    const BoundBody<Real>& body = this->body_;
    arguments_.body = body.slot;
    arguments_.parameters = &this->with_frame_;
    weight_.assign(padded(body.slot.count), Real(0.0));
    arguments_.on_coordinates = body.slot.rigid && particle < 0;
    if (particle < 0) {
      for (std::size_t i = 0; i < weight_.size(); ++i) weight_[i] = body.slot.share[i];
      arguments_.last = weight_.size();
      arguments_.single = body.slot.count == 1;
    } else {
      const auto at = static_cast<std::size_t>(particle);
      weight_[at] = Real(1.0);
      arguments_.first = at / kGroup * kGroup;
      arguments_.last = arguments_.first + kGroup;
      arguments_.single = true;
      arguments_.particle = at;
    }
    arguments_.weight = weight_.data();
    for (const Real& weight : weight_) weight_in_double_.push_back(static_cast<double>(weight));
    const double* attached = particle < 0 ? body.start_centre.data() : body.start[particle].data();
    for (int d = 0; d < D; ++d) {
      arguments_.start[d] =
          Real(start.empty() ? attached[d] : relative_to(binding.origin, d, start[d]));
    }
  }

  std::vector<Pass<Real>> passes() override {
    PointForce<Real> point;
    if (D == 1 && this->body_.slot.count == 1) {
      point = {point_, &this->with_frame_, arguments_.start[0], arguments_.rate};
    }
    return {{kernels_.set[D - 1],
             kernels_.add[D - 1],
             &arguments_,
             {{this->body_.index, arguments_.on_coordinates}},
             rank_,
             lane_form(),
             point}};
  }

  void place_rates(std::ptrdiff_t first) override { arguments_.rate = first; }

  Real energy(const Stage<Real>& stage) const override {
    if constexpr (HasEnergy<E, D, Site>) return E::energy(this->parameters_, site(stage));
    return Real(0.0);
  }

  void hessian(const Stage<Real>& stage, HessianSink& sink) const override {
    if constexpr (HasEnergy<E, D, Site>) {
      for_curvature<E, Real, D>(this->parameters_, site(stage), [&](int a, int b, double value) {
        sink.centre(this->body_.index, weight_in_double_.data(), a, b, value);
      });
    }
  }

 private:
  LaneForm lane_form() const {
    LaneForm form;
    if constexpr (std::is_same_v<Real, double>) {
      form.kernel = lanes_.centre[D - 1];
      form.numbers = {numbers_in(this->with_frame_), arguments_.start, weight_};
      form.structure = structure_of(this->body_.slot, arguments_.rate);
      for (const std::size_t one : {arguments_.first, arguments_.last, arguments_.particle}) {
        form.structure.push_back(static_cast<std::int64_t>(one));
      }
      form.structure.push_back(arguments_.single ? 1 : 0);
      form.structure.push_back(arguments_.on_coordinates ? 1 : 0);
      form.follows_time = this->depends_on_time();
    }
    return form;
  }
  Site<Real, D> site(const Stage<Real>& stage) const {
    Site<Real, D> site{};
    const BodySlot<Real>& slot = this->body_.slot;
    for (int d = 0; d < D; ++d) {
      if (arguments_.on_coordinates) {
        site.position[d] = stage.position[slot.centre + d];
        continue;
      }
      InterleavedSum<Real> total;
      const Real* x = (slot.mapped ? stage.mapped_position : stage.position) + slot.offset;
      for (std::size_t i = 0; i < slot.count; ++i)
        total.add(i, weight_[i] * x[d * slot.stride + i]);
      site.position[d] = total.total();
    }
    for (int d = 0; d < D; ++d) site.start[d] = arguments_.start[d];
    site.elapsed = stage.elapsed;
    site.frame = this->with_frame_.frame;
    return site;
  }

 protected:
  CentreArguments<Real> arguments_;

 private:
  const KernelPair<Real>& kernels_;
  const LaneKernels& lanes_;
  PointKernel<Real> point_;
  int rank_;
  AlignedVector<Real> weight_;
  std::vector<double> weight_in_double_;
};

/// Calls `make` with the scene's dimension as a constant.
template <class Real, class Make>
std::unique_ptr<BoundForce<Real>> for_dimension(int dimension, Make&& make) {
  switch (dimension) {
    case 1:
      return make.template operator()<1>();
    case 2:
      return make.template operator()<2>();
    default:
      return make.template operator()<3>();
  }
}

template <class E, const KernelTables& tables, int rank, class Real>
std::unique_ptr<BoundForce<Real>> bind_on_particles(const typename E::Description& d,
                                                    const Binding<Real>& binding) {
  return for_dimension<Real>(binding.dimension, [&]<int D>() -> std::unique_ptr<BoundForce<Real>> {
    return std::make_unique<ParticleForce<E, Real, D>>(d, binding, tables, rank);
  });
}

/// The whole binding of a force on particles, in every number type.
template <class E, const KernelTables& tables, int rank = kRankCheap>
ForceFactories on_particles() {
  return {of_description<&bind_on_particles<E, tables, rank, double>>,
          of_description<&bind_on_particles<E, tables, rank, Quad>>};
}

/// The framework cannot infer that nonlinear friction dissipates: its evaluator declares
/// `static constexpr bool dissipative = true`.
template <class E>
constexpr bool declares_dissipation() {
  if constexpr (requires { E::dissipative; }) return E::dissipative;
  return false;
}

/// The traits that follow from what an evaluator of sites has and reads: an energy makes the force
/// conservative unless it reads velocities, a `friction` without energy dissipative, a `power` a
/// driver, a `period` periodic.
template <class E>
Traits traits_of_sites() {
  constexpr bool has_friction = requires(const typename E::template Parameters<double, 2>& p) {
    E::friction(p);
  };
  constexpr bool has_period = requires(const typename E::Description& d) { E::period(d, 0); };
  return {.conservative = HasEnergy<E, 2, Site> && !E::reads.velocity,
          .depends_on_velocity = E::reads.velocity,
          .depends_on_time = E::reads.time,
          .periodic = has_period,
          .dissipative = declares_dissipation<E>() || (has_friction && !HasEnergy<E, 2, Site>),
          .does_work = ForceOnSites<E, double, 2>::kDoesWork};
}

/// The record of a force on every particle of a body, but for its name, its texts and parameters.
template <class E, const KernelTables& tables, int rank = kRankCheap>
ForceRecord site_force() {
  static_assert(
      !E::reads.time && !ForceOnSites<E, double, 2>::kDoesWork,
      "a force that depends on time or drives binds a class with begin_step() and drive(),"
      " as forcefields/driving_spring.cpp does");
  ForceRecord record = record_of<typename E::Description>();
  record.element = Element::site;
  record.varies = true;
  record.traits = traits_of_sites<E>();
  if (record.traits.periodic) record.period = of_description<&period_along<E>>;
  record.bind = on_particles<E, tables, rank>();
  return record;
}

}  // namespace tomlin
