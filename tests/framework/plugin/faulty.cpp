#include <stdexcept>

#include "framework/core/elements/element.hpp"
#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/registry.hpp"

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

#undef NDEBUG  // a failed assertion is one of the faults
#include <cassert>
#include <cfenv>
#include <csignal>
#include <cstdlib>
#include <string>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include <unistd.h>

#include "framework/core/elements/site_force.hpp"
#include "framework/plugin/plugin.hpp"

TOMLIN_DECLARE_KERNELS(Faulty)

namespace tomlin {
namespace {

std::string fault() {
  const char* wish = std::getenv("FAULT");
  return wish == nullptr ? "" : wish;
}

/// Changes the arithmetic as linking with -ffast-math does, or worse.
__attribute__((constructor)) void change_arithmetic() {
#if defined(__SSE2__)
  if (fault() == "flush") {
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _mm_setcsr(_mm_getcsr() | 0x40U);  // what is read, too
  }
#endif
  if (fault() == "round") std::fesetround(FE_UPWARD);
}

long calls_left() {
  const char* wish = std::getenv("FAULT_AFTER");
  return wish == nullptr ? -1 : std::atol(wish);
}

std::unique_ptr<BoundForce<double>> bind(const void* description, const Binding<double>& binding) {
  if (fault() == "throw_binding") throw std::runtime_error("not bound, as planned");
  if (fault() == "nothing_bound") return nullptr;
  const auto factories = on_particles<Faulty, kernels::Faulty, kRankCheap>();
  return factories.in_double(description, binding);
}

std::shared_ptr<void> make() {
  if (fault() == "throw_making") throw std::runtime_error("not made, as planned");
  if (fault() == "nothing_made") return nullptr;
  return std::make_shared<FaultyDescription>();
}

double period(const void*, int) {
  if (fault() == "throw_period") throw std::runtime_error("no period, as planned");
  return 0.0;
}

Traits traits(const void*) {
  if (fault() == "throw_traits") throw std::runtime_error("no traits, as planned");
  return {};
}

Element element(const void*) {
  if (fault() == "throw_element") throw std::runtime_error("no element, as planned");
  return Element::site;
}

std::vector<Complaint> complaints(const void*, const SceneOutline&) {
  if (fault() == "throw_looking") throw std::runtime_error("not looked at, as planned");
  return {};
}

ForceRecord faulty_record() {
  ForceRecord record;
  record.name = fault() == "taken_name" ? "harmonic_bonds" : "faulty";
  if (fault() == "odd_name") record.name = "a b\n";
  record.summary = "a spring to zero that may go wrong";
  if (fault() == "not_utf8") record.summary += " \xff";
  record.equation = "F = -strength x";
  record.source = fault() == "incomplete" ? "" : "a test";
  record.element = Element::site;
  record.make_description = &make;
  record.period = &period;
  record.traits_of = &traits;
  record.element_of = &element;
  record.parameters = {
      parameter("strength", &FaultyDescription::strength, dimension::stiffness, "how strong")};
  if (fault() == "two_keys") record.parameters.push_back(record.parameters.front());
  if (fault() == "type_as_key") record.parameters.front().key = "type";
  record.complaints = &complaints;
  record.bind = {&bind, on_particles<Faulty, kernels::Faulty, kRankCheap>().in_quadruple};
  record.example = "see the tests";
  return record;
}

/// Until there is no stack any more.
long overflow(long depth) {
  volatile char block[1 << 12];
  block[0] = static_cast<char>(depth);
  return depth > 0 ? overflow(depth + 1) + block[0] : 0;
}

}  // namespace

void count_down() {
  static long left = calls_left();
  if (left < 0) return;
  if (left-- > 0) return;
  left = 0;                                 // from now on always
  if (fault() == "throw_number") throw 42;  // NOLINT: what is no exception either
  if (fault() == "crash_later") std::raise(SIGSEGV);
  if (fault() == "abort_later") std::abort();
  if (fault() == "assert_later") assert(fault() == "sound");
  if (fault() == "overflow_later") left += overflow(1);
  if (fault() == "exit_later") std::exit(0);  // NOLINT: as planned
  if (fault() == "round_later") {
    std::fesetround(FE_UPWARD);
    return;
  }
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
