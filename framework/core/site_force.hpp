#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "framework/core/bound_force.hpp"
#include "framework/core/element.hpp"
#include "framework/core/kernel_tables.hpp"
#include "framework/core/sum.hpp"

/// Bound forces on sites, made from an evaluator: on every particle of a body, or on one attached
/// point of it. The hot loops come from the kernel tables; what runs rarely is written here.
namespace tomlin {

/// In place of a particle's index.
inline constexpr std::ptrdiff_t kCentreOfMass = -1;

/// Numbers of one particle of a body.
template <int D>
Vec<double, D> vector_at(const BodySlot<double>& slot, const double* plain, const double* mapped,
                         std::size_t particle) {
  const double* from = (slot.mapped ? mapped : plain) + slot.offset + particle;
  Vec<double, D> x;
  for (int d = 0; d < D; ++d) x[d] = from[d * slot.stride];
  return x;
}

/// d2V/dx_a dx_b of a site, from the derivative of the force.
template <class E, int D, class Use>
void for_curvature(const typename E::template Parameters<double, D>& p, const Site<double, D>& site,
                   Use&& use) {
  const auto force = force_on<E, Dual<double, D>, D>(in_type<E, Dual<double, D>, double, D>(p),
                                                     differentiable(site));
  for (int a = 0; a < D; ++a) {
    for (int b = 0; b < D; ++b) use(a, b, -force[a].derivative[b]);
  }
}

/// What sites of either kind share: parameters, rates, bounds.
template <class E, int D>
class ForceOnSites : public BoundForce<double> {
 public:
  using Parameters = typename E::template Parameters<double, D>;

  ForceOnSites(const typename E::Description& description, const Binding<double>& binding)
      : description_(description),
        parameters_(E::template parameters<double, D>(description)),
        body_(*binding.bodies.front()) {
    rebase(binding.origin);
  }

  std::size_t rate_count() const override { return kDoesWork ? D + 1 : 0; }

  void rebase(const Origin& origin) override {
    if constexpr (requires { E::template rebase<double, D>(parameters_, description_, origin); }) {
      E::template rebase<double, D>(parameters_, description_, origin);
    }
  }

  double curvature_bound() const override {
    if constexpr (requires { E::template curvature_bound<D>(description_); }) {
      return E::template curvature_bound<D>(description_);
    }
    return -1.0;
  }

  double curvature_bound_along(int axis) const override {
    if constexpr (requires { E::template curvature_bound_along<D>(description_, axis); }) {
      return E::template curvature_bound_along<D>(description_, axis);
    }
    return curvature_bound();
  }

  /// Of free particles: a rigid body's velocities are not its particles'.
  bool has_flow() const override { return kHasFlow && !body_.slot.mapped; }

 protected:
  static constexpr bool kDoesWork =
      requires(const Parameters& p, const Site<double, D>& site, const Vec<double, D>& force) {
    E::power(p, site, force);
  };
  static constexpr bool kHasFlow = requires(const Parameters& p) { E::decay_factor(p, 1.0); };
  static constexpr bool kHasFriction = requires(const Parameters& p) { E::friction(p); };

  typename E::Description description_;
  Parameters parameters_;
  BoundBody<double> body_;
};

/// The evaluator on every particle of a body. `start`, in the scene's coordinates, is where
/// drivers' ends are at time 0; empty: each at its own particle.
template <class E, int D>
class ParticleForce : public ForceOnSites<E, D> {
  using Base = ForceOnSites<E, D>;

 public:
  ParticleForce(const typename E::Description& description, const Binding<double>& binding,
                const KernelTables& tables, int rank, const std::vector<double>& start = {})
      : Base(description, binding),
        kernels_(tables.on(binding.set).site),
        point_(tables.on(binding.set).point),
        rank_(rank) {
    arguments_.body = this->body_.slot;
    arguments_.parameters = &this->parameters_;
    if constexpr (E::reads.start) {
      start_.assign(D * this->body_.slot.stride, 0.0);
      for (std::size_t i = 0; i < this->body_.slot.count; ++i) {
        for (int d = 0; d < D; ++d)
          start_[d * this->body_.slot.stride + i] =
              start.empty() ? this->body_.start[i][d] : relative_to(binding.origin, d, start[d]);
      }
      arguments_.start = start_.data();
    }
  }

  std::vector<Pass<double>> passes() override {
    return {{kernels_.set[D - 1],
             kernels_.add[D - 1],
             &arguments_,
             {{this->body_.index, false}},
             rank_}};
  }

  void place_rates(std::ptrdiff_t first) override { arguments_.rate = first; }

  bool point(PointForce<double>& force) const override {
    if (D != 1 || this->body_.slot.count != 1 || !point_) return false;
    force = {point_, &this->parameters_, start_.empty() ? 0.0 : start_[0], arguments_.rate};
    return true;
  }

  double energy(const Stage<double>& stage) const override {
    InterleavedSum<double> total;
    if constexpr (HasEnergy<E, D, Site>) {
      for (std::size_t i = 0; i < this->body_.slot.count; ++i) {
        total.add(i, E::energy(this->parameters_, site(stage, i)));
      }
    }
    return total.total();
  }

  void hessian(const Stage<double>& stage, HessianSink& sink) const override {
    if constexpr (HasEnergy<E, D, Site>) {
      for (std::size_t i = 0; i < this->body_.slot.count; ++i) {
        for_curvature<E, D>(this->parameters_, site(stage, i), [&](int a, int b, double value) {
          sink.site(this->body_.index, i, a, b, value);
        });
      }
    }
  }

  void friction(FrictionSink& sink) const override {
    if constexpr (Base::kHasFriction) {
      for (std::size_t i = 0; i < this->body_.slot.count; ++i) {
        sink.site(this->body_.index, i, E::friction(this->parameters_));
      }
    }
  }

  void flow(const Stage<double>&, const double* inverse_mass, double* velocity,
            double h) const override {
    if constexpr (Base::kHasFlow) {
      for (std::size_t i = 0; i < this->body_.slot.count; ++i) {
        for (int d = 0; d < D; ++d) {
          const std::size_t at = this->body_.slot.offset + d * this->body_.slot.stride + i;
          velocity[at] *= E::decay_factor(this->parameters_, h * inverse_mass[at]);
        }
      }
    }
  }

 private:
  Site<double, D> site(const Stage<double>& stage, std::size_t i) const {
    const BodySlot<double>& slot = this->body_.slot;
    Site<double, D> site{};
    site.position = vector_at<D>(slot, stage.position, stage.mapped_position, i);
    if constexpr (E::reads.velocity) {
      site.velocity = vector_at<D>(slot, stage.velocity, stage.mapped_velocity, i);
    }
    if constexpr (E::reads.start) {
      for (int d = 0; d < D; ++d) site.start[d] = start_[d * slot.stride + i];
    }
    site.elapsed = stage.elapsed;
    return site;
  }

  const KernelPair<double>& kernels_;
  PointKernel<double> point_;
  int rank_;
  SiteArguments<double> arguments_;
  AlignedVector<double> start_;
};

/// The evaluator on one attached point: a body's centre of mass, or one particle of it.
template <class E, int D>
class AttachedForce : public ForceOnSites<E, D> {
  using Base = ForceOnSites<E, D>;

 public:
  /// `particle` may be kCentreOfMass; `start` in the scene's coordinates, empty: the attached
  /// point.
  AttachedForce(const typename E::Description& description, const Binding<double>& binding,
                const KernelTables& tables, int rank, std::ptrdiff_t particle = kCentreOfMass,
                const std::vector<double>& start = {})
      : Base(description, binding),
        kernels_(tables.on(binding.set).centre),
        point_(tables.on(binding.set).point),
        rank_(rank) {
    const BoundBody<double>& body = this->body_;
    arguments_.body = body.slot;
    arguments_.parameters = &this->parameters_;
    weight_.assign(padded(body.slot.count), 0.0);
    arguments_.on_coordinates = body.slot.rigid && particle < 0;
    if (particle < 0) {
      for (std::size_t i = 0; i < weight_.size(); ++i) weight_[i] = body.slot.share[i];
      arguments_.last = weight_.size();
      arguments_.single = body.slot.count == 1;
    } else {
      const auto at = static_cast<std::size_t>(particle);
      weight_[at] = 1.0;
      arguments_.first = at / kGroup * kGroup;
      arguments_.last = arguments_.first + kGroup;
      arguments_.single = true;
      arguments_.particle = at;
    }
    arguments_.weight = weight_.data();
    const auto& attached = particle < 0 ? body.start_centre : body.start[particle];
    for (int d = 0; d < D; ++d) {
      arguments_.start[d] = start.empty() ? attached[d] : relative_to(binding.origin, d, start[d]);
    }
  }

  std::vector<Pass<double>> passes() override {
    return {{kernels_.set[D - 1],
             kernels_.add[D - 1],
             &arguments_,
             {{this->body_.index, arguments_.on_coordinates}},
             rank_}};
  }

  void place_rates(std::ptrdiff_t first) override { arguments_.rate = first; }

  bool point(PointForce<double>& force) const override {
    if (D != 1 || this->body_.slot.count != 1 || !point_) return false;
    force = {point_, &this->parameters_, arguments_.start[0], arguments_.rate};
    return true;
  }

  double energy(const Stage<double>& stage) const override {
    if constexpr (HasEnergy<E, D, Site>) return E::energy(this->parameters_, site(stage));
    return 0.0;
  }

  void hessian(const Stage<double>& stage, HessianSink& sink) const override {
    if constexpr (HasEnergy<E, D, Site>) {
      for_curvature<E, D>(this->parameters_, site(stage), [&](int a, int b, double value) {
        sink.centre(this->body_.index, weight_.data(), a, b, value);
      });
    }
  }

 private:
  Site<double, D> site(const Stage<double>& stage) const {
    Site<double, D> site{};
    const BodySlot<double>& slot = this->body_.slot;
    for (int d = 0; d < D; ++d) {
      if (arguments_.on_coordinates) {
        site.position[d] = stage.position[slot.centre + d];
        continue;
      }
      InterleavedSum<double> total;
      const double* x = (slot.mapped ? stage.mapped_position : stage.position) + slot.offset;
      for (std::size_t i = 0; i < slot.count; ++i)
        total.add(i, weight_[i] * x[d * slot.stride + i]);
      site.position[d] = total.total();
    }
    for (int d = 0; d < D; ++d) site.start[d] = arguments_.start[d];
    site.elapsed = stage.elapsed;
    return site;
  }

 protected:
  CentreArguments<double> arguments_;

 private:
  const KernelPair<double>& kernels_;
  PointKernel<double> point_;
  int rank_;
  AlignedVector<double> weight_;
};

/// Calls `make` with the scene's dimension as a constant.
template <class Make>
std::unique_ptr<BoundForce<double>> for_dimension(int dimension, Make&& make) {
  switch (dimension) {
    case 1:
      return make.template operator()<1>();
    case 2:
      return make.template operator()<2>();
    default:
      return make.template operator()<3>();
  }
}

/// The whole binding of a force on particles: `record.bind = &bind_on_particles<Evaluator, ...>`.
template <class E, const KernelTables& tables, int rank>
std::unique_ptr<BoundForce<double>> bind_on_particles(const void* description,
                                                      const Binding<double>& binding) {
  const auto& d = *static_cast<const typename E::Description*>(description);
  return for_dimension(binding.dimension, [&]<int D>() -> std::unique_ptr<BoundForce<double>> {
    return std::make_unique<ParticleForce<E, D>>(d, binding, tables, rank);
  });
}

}  // namespace tomlin
