#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/elements/kernels.hpp"
#include "framework/core/elements/site_force.hpp"
#include "tests/support/conformance.hpp"
#include "tests/support/scenes.hpp"

/// Forces that are wrong on purpose, bound in place of a valid one.
namespace tomlin::test {

inline constexpr std::uint64_t kSeeds[] = {20240611, 7, 424242};

/// The kernels that a force on particles takes from a table. No others are made: compiling them
/// for every wrong evaluator would take minutes.
template <class E, class Real>
constexpr ElementTable<Real> particle_table() {
  ElementTable<Real> table;
  const auto fill = [&]<int D>() {
    table.site.set[D - 1] = &site_kernel<E, Real, D, true>;
    table.site.add[D - 1] = &site_kernel<E, Real, D, false>;
    if constexpr (E::reads.velocity) table.heat[D - 1] = &heat_kernel<E, Real, D>;
    if constexpr (HasEnergy<E, D, Site>) table.site_energy[D - 1] = &site_energy<E, Real, D>;
  };
  fill.template operator()<1>();
  fill.template operator()<2>();
  fill.template operator()<3>();
  return table;
}

/// Tables of one number type.
template <class Real>
constexpr KernelTables tables_of(const TablesBySet<ElementTable<Real>>& sets) {
  KernelTables tables;
  if constexpr (std::is_same_v<Real, double>) {
    tables.in_double = sets;
  } else {
    tables.in_quadruple = sets;
  }
  return tables;
}

template <class E, class Real>
inline constexpr ElementTable<Real> kTableOf = particle_table<E, Real>();
template <class E, class Real>
inline constexpr KernelTables kTablesOf = tables_of<Real>({&kTableOf<E, Real>, nullptr, nullptr});
/// E on the plain instruction set, and what differs on the wider ones.
template <class E, class OnWider, class Real>
inline constexpr KernelTables kTablesBySet =
    tables_of<Real>({&kTableOf<E, Real>, &kTableOf<OnWider, Real>, &kTableOf<OnWider, Real>});

/// Bind evaluator E, or a class made around it, on every particle.
template <template <class, class, int> class Wrapper, class E, class Real = double>
std::unique_ptr<BoundForce<Real>> wrapped(const void* description, const Binding<Real>& binding) {
  const auto& d = *static_cast<const typename E::Description*>(description);
  return for_dimension<Real>(binding.dimension, [&]<int D>() -> std::unique_ptr<BoundForce<Real>> {
    return std::make_unique<Wrapper<E, Real, D>>(d, binding, kTablesOf<E, Real>, kRankCheap);
  });
}

template <class E, class Real = double>
std::unique_ptr<BoundForce<Real>> planted(const void* description, const Binding<Real>& binding) {
  return wrapped<ParticleForce, E, Real>(description, binding);
}

template <class E, class OnWider, class Real>
std::unique_ptr<BoundForce<Real>> planted_by_set(const void* description,
                                                 const Binding<Real>& binding) {
  const auto& d = *static_cast<const typename E::Description*>(description);
  return for_dimension<Real>(binding.dimension, [&]<int D>() -> std::unique_ptr<BoundForce<Real>> {
    return std::make_unique<ParticleForce<E, Real, D>>(d, binding, kTablesBySet<E, OnWider, Real>,
                                                       kRankCheap);
  });
}

/// Returns the properties that break if the force of this name is bound in another way. Number
/// types that are not given are not checked. `until` ends the check once that property breaks.
inline std::vector<std::string> broken_properties(const std::string& name,
                                                  const ForceFactories& bind,
                                                  void (*spoil)(ForceRecord&) = nullptr,
                                                  const std::string& until = {}) {
  ForceRecord record = *standard().force(name);
  record.bind = bind.in_double ? bind : ForceFactories(record.bind.in_double);
  // Forces in its place have no noise.
  if (name == "memory_damping") record.traits_of = nullptr;
  if (spoil) spoil(record);
  Conformance check(record);
  check.examine_everywhere(kSeeds[0], {1, 2, 4}, nullptr, until);
  std::vector<std::string> broken;
  for (const auto& [property, where] : check.broken()) broken.push_back(property);
  return broken;
}

inline bool among(const std::vector<std::string>& broken, const std::string& property) {
  return std::find(broken.begin(), broken.end(), property) != broken.end();
}

inline bool is_caught(const std::string& property, const std::string& name,
                      const ForceFactories& bind, void (*spoil)(ForceRecord&) = nullptr) {
  return among(broken_properties(name, bind, spoil, property), property);
}

#define EXPECT_CAUGHT(property, ...) \
  EXPECT_TRUE(is_caught(property, __VA_ARGS__)) << "not caught: " << (property)

}  // namespace tomlin::test
