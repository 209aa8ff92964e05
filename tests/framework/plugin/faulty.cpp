#include <stdexcept>

#include "framework/core/bound_force.hpp"
#include "framework/core/element.hpp"
#include "framework/core/registry.hpp"

// A force whose library goes wrong in the way that the environment variable FAULT says. All in one
// file: the kernels are made from it as well.
namespace tomlin {

/// Throws once it has been called as often as FAULT_AFTER says.
void count_down();

struct FaultyDescription {
  double strength = 0.0;
};

inline namespace TOMLIN_TARGET {

struct Faulty {
  using Description = FaultyDescription;
  static constexpr Reads reads{};

  template <class T, int D>
  struct Parameters {
    T strength;
  };

  template <class T, int D>
  static Parameters<T, D> parameters(const Description& d) {
    return {T(d.strength)};
  }

  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    count_down();
    return -p.strength * site.position;
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin

#ifndef TOMLIN_KERNELS_ONLY

#include <csignal>
#include <cstdlib>
#include <string>

#include <unistd.h>

#include "framework/core/site_force.hpp"
#include "framework/plugin/plugin.hpp"

TOMLIN_DECLARE_KERNELS(Faulty)

namespace tomlin {
namespace {

std::string fault() {
  const char* wish = std::getenv("FAULT");
  return wish == nullptr ? "" : wish;
}

long calls_left() {
  const char* wish = std::getenv("FAULT_AFTER");
  return wish == nullptr ? -1 : std::atol(wish);
}

std::unique_ptr<BoundForce<double>> bind(const void* description, const Binding<double>& binding) {
  if (fault() == "throw_binding") throw std::runtime_error("not bound, as planned");
  const auto factories = on_particles<Faulty, kernels::Faulty, kRankCheap>();
  return factories.in_double(description, binding);
}

std::vector<Complaint> complaints(const void*, const SceneOutline&) {
  if (fault() == "throw_looking") throw std::runtime_error("not looked at, as planned");
  return {};
}

ForceRecord faulty_record() {
  ForceRecord record;
  record.name = fault() == "taken_name" ? "harmonic_bonds" : "faulty";
  record.summary = "a spring to zero that may go wrong";
  record.equation = "F = -strength x";
  record.source = fault() == "incomplete" ? "" : "a test";
  record.element = Element::site;
  record.make_description = &make_description<FaultyDescription>;
  record.parameters = {
      parameter("strength", &FaultyDescription::strength, dimension::stiffness, "how strong")};
  record.complaints = &complaints;
  record.bind = {&bind, on_particles<Faulty, kernels::Faulty, kRankCheap>().in_float};
  record.example = "see the tests";
  return record;
}

}  // namespace

void count_down() {
  static long left = calls_left();
  if (left < 0) return;
  if (left-- > 0) return;
  left = 0;                                 // from now on always
  if (fault() == "throw_number") throw 42;  // NOLINT: what is no exception either
  throw std::runtime_error("no force, as planned");
}

}  // namespace tomlin

TOMLIN_PLUGIN(registry) {
  const std::string fault = tomlin::fault();
  if (fault == "throw_registering") throw std::runtime_error("not today");
  if (fault == "throw_int") throw 42;  // NOLINT
  if (fault == "crash") std::raise(SIGSEGV);
  if (fault == "abort") std::abort();
  if (fault == "hang") {
    while (true) ::pause();
  }
  if (fault == "exit") std::exit(7);
  if (fault == "nothing") return;
  registry.add(tomlin::faulty_record());
  if (fault == "twice") registry.add(tomlin::faulty_record());
}

#endif
