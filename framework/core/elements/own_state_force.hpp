#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "framework/core/elements/kernel_tables.hpp"
#include "framework/core/elements/own_state.hpp"
#include "framework/core/elements/site_force.hpp"

/// Bound forces with a vector of their own for each particle, made from an evaluator.
namespace tomlin {

template <class E, class Real, int D>
class OwnStateForce : public BoundForce<Real>, public InternalVariables<Real> {
 public:
  OwnStateForce(const typename E::Description& description, const Binding<Real>& binding,
                const KernelTables& tables, int rank)
      : parameters_(E::template parameters<Real, D>(description)),
        table_(tables.on<Real>(binding.set)),
        body_(*binding.bodies.front()),
        rank_(rank) {
    arguments_.body = body_.slot;
    arguments_.parameters = &parameters_;
  }

  std::vector<Pass<Real>> passes() override {
    return {{table_.site.set[D - 1],
             table_.site.add[D - 1],
             &arguments_,
             {{body_.index, false}},
             rank_}};
  }

  std::size_t own_count() const override { return D * body_.slot.count; }
  void place_own(std::size_t first) override { arguments_.own = first; }
  /// At rest, with nothing behind it.
  void start_own(Real* own) const override {
    std::fill_n(own + arguments_.own, own_count(), Real(0.0));
  }

  Real energy(const Stage<Real>& stage) const override {
    return table_.site_energy[D - 1](&arguments_, stage);
  }

  bool heat(std::ptrdiff_t rate, Operation<Real>& operation) override {
    heat_ = arguments_;
    heat_.heat_rate = rate;
    operation = {table_.heat[D - 1], &heat_};
    return true;
  }

 private:
  typename E::template Parameters<Real, D> parameters_;
  const ElementTable<Real>& table_;
  BoundBody<Real> body_;
  int rank_;
  OwnStateArguments<Real> arguments_;
  OwnStateArguments<Real> heat_;
};

template <class E, const KernelTables& tables, int rank, class Real>
std::unique_ptr<BoundForce<Real>> bind_with_state(const typename E::Description& d,
                                                  const Binding<Real>& binding) {
  return for_dimension<Real>(binding.dimension, [&]<int D>() -> std::unique_ptr<BoundForce<Real>> {
    return std::make_unique<OwnStateForce<E, Real, D>>(d, binding, tables, rank);
  });
}

/// The whole binding, in every number type.
template <class E, const KernelTables& tables, int rank = kRankCheap>
ForceFactories on_particles_with_state() {
  return {of_description<&bind_with_state<E, tables, rank, double>>,
          of_description<&bind_with_state<E, tables, rank, Quad>>};
}

/// The record of such a force, but for its name, its texts and parameters. What its variables store
/// they may give back, so that it is neither conservative nor dissipative at every moment.
template <class E, const KernelTables& tables, int rank = kRankCheap>
ForceRecord own_state_force() {
  ForceRecord record = record_of<typename E::Description>();
  record.element = Element::site;
  record.traits = {.depends_on_velocity = true};
  record.bind = on_particles_with_state<E, tables, rank>();
  return record;
}

}  // namespace tomlin
