#pragma once

#include <memory>
#include <vector>

#include "forcefields/harmonic_bonds.hpp"
#include "framework/core/elements/element.hpp"
#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/force.hpp"
#include "tests/forcefields/planted.hpp"

/// Bonds between neighbours in a plain loop, by a law that may be wrong:
///   Law::force(stiffness, rest, separation, force on the first, force on the second)
///   Law::energy(stiffness, rest, distance)
namespace tomlin::test {

template <class Law, class Real>
class PlainBonds : public BoundForce<Real>, public Diagnosis<Real> {
 public:
  PlainBonds(const HarmonicBondsDescription& d, const Binding<Real>& binding)
      : body_(*binding.bodies.front()) {
    arguments_.body = body_.slot;
    arguments_.axes = binding.dimension;
    arguments_.stiffness = Real(d.stiffness);
    arguments_.rest = Real(d.rest_lengths.numbers.empty() ? 1.0 : d.rest_lengths.numbers[0]);
  }
  std::vector<Pass<Real>> passes() override {
    return {{nullptr, &add, &arguments_, {{body_.index, false}}, kRankPairs}};
  }
  Real energy(const Stage<Real>& stage) const override {
    Real total(0.0);
    for (std::size_t i = 0; i + 1 < body_.slot.count; ++i) {
      total += Law::energy(arguments_.stiffness, arguments_.rest,
                           distance(separation(arguments_, stage, i)));
    }
    return total;
  }
  double shortest_bond() const override { return static_cast<double>(arguments_.rest); }

 private:
  struct Arguments {
    BodySlot<Real> body;
    int axes = 0;
    Real stiffness{};
    Real rest{};
  };

  static Vec<Real, 3> separation(const Arguments& a, const Stage<Real>& stage, std::size_t i) {
    const Real* x = (a.body.mapped ? stage.mapped_position : stage.position) + a.body.offset;
    Vec<Real, 3> apart;
    for (int d = 0; d < 3; ++d) {
      apart[d] = d < a.axes ? x[d * a.body.stride + i + 1] - x[d * a.body.stride + i] : Real(0.0);
    }
    return apart;
  }

  static void add(const void* arguments, const Stage<Real>& stage) {
    const auto& a = *static_cast<const Arguments*>(arguments);
    Real* f = (a.body.mapped ? stage.mapped_force : stage.force) + a.body.offset;
    for (std::size_t i = 0; i + 1 < a.body.count; ++i) {
      Vec<Real, 3> one, other;
      Law::force(a.stiffness, a.rest, separation(a, stage, i), one, other);
      for (int d = 0; d < a.axes; ++d) {
        f[d * a.body.stride + i] += one[d];
        f[d * a.body.stride + i + 1] += other[d];
      }
    }
  }

  BoundBody<Real> body_;
  Arguments arguments_;
};

template <class Law, class Real>
std::unique_ptr<BoundForce<Real>> plain_bonds(const void* description,
                                              const Binding<Real>& binding) {
  return std::make_unique<PlainBonds<Law, Real>>(
      *static_cast<const HarmonicBondsDescription*>(description), binding);
}

/// In double and quadruple precision, wrong in both.
template <class Law>
ForceFactories bonds_by() {
  return {&plain_bonds<Law, double>, &plain_bonds<Law, Quad>};
}

/// The right one.
struct HookesLaw {
  template <class Real>
  static Real energy(const Real& k, const Real& rest, const Real& r) {
    return Real(0.5) * k * (r - rest) * (r - rest);
  }
  template <class Real>
  static void force(const Real& k, const Real& rest, const Vec<Real, 3>& apart, Vec<Real, 3>& one,
                    Vec<Real, 3>& other) {
    const Real r = distance(apart);
    one = (k * (r - rest) / r) * apart;
    other = -one;
  }
};

/// Right, with a kink in the force where bonds begin to push.
struct OnlyPushes : HookesLaw {
  template <class Real>
  static Real energy(const Real& k, const Real& rest, const Real& r) {
    return r < rest ? HookesLaw::energy(k, rest, r) : Real(0.0);
  }
  template <class Real>
  static void force(const Real& k, const Real& rest, const Vec<Real, 3>& apart, Vec<Real, 3>& one,
                    Vec<Real, 3>& other) {
    HookesLaw::force(k, rest, apart, one, other);
    if (distance(apart) < rest) return;
    one = Real(0.0) * one;
    other = Real(0.0) * other;
  }
};

/// Right, with a kink in the energy: a force that jumps at the rest length.
struct Absolute {
  template <class Real>
  static Real energy(const Real& k, const Real& rest, const Real& r) {
    return r < rest ? k * (rest - r) : k * (r - rest);
  }
  template <class Real>
  static void force(const Real& k, const Real& rest, const Vec<Real, 3>& apart, Vec<Real, 3>& one,
                    Vec<Real, 3>& other) {
    const Real r = distance(apart);
    one = ((r < rest ? -k : k) / r) * apart;
    other = -one;
  }
};

/// Only the first of two feels the other.
struct Unrequited : HookesLaw {
  template <class Real>
  static void force(const Real& k, const Real& rest, const Vec<Real, 3>& apart, Vec<Real, 3>& one,
                    Vec<Real, 3>& other) {
    HookesLaw::force(k, rest, apart, one, other);
    other = Real(0.0) * other;
  }
};

/// Reciprocal, but across the line between the two: the torque is missing.
struct AcrossTheLine : HookesLaw {
  template <class Real>
  static void force(const Real& k, const Real& rest, const Vec<Real, 3>& apart, Vec<Real, 3>& one,
                    Vec<Real, 3>& other) {
    HookesLaw::force(k, rest, apart, one, other);
    one[0] += Real(1e-3) * k * apart[1];
    one[1] = one[1] - Real(1e-3) * k * apart[0];
    other = -one;
  }
};

/// Pulls where it should push, closer than a hundredth of the rest length.
struct WrongAtContact : HookesLaw {
  template <class Real>
  static void force(const Real& k, const Real& rest, const Vec<Real, 3>& apart, Vec<Real, 3>& one,
                    Vec<Real, 3>& other) {
    HookesLaw::force(k, rest, apart, one, other);
    if (!(distance(apart) < Real(0.01) * rest)) return;
    one = -one;
    other = -other;
  }
};

/// Twice as strong, closer than a twentieth of the rest length.
struct TwiceAtContact : HookesLaw {
  template <class Real>
  static void force(const Real& k, const Real& rest, const Vec<Real, 3>& apart, Vec<Real, 3>& one,
                    Vec<Real, 3>& other) {
    HookesLaw::force(k, rest, apart, one, other);
    if (!(distance(apart) < Real(0.05) * rest)) return;
    one = Real(2.0) * one;
    other = Real(2.0) * other;
  }
};

/// Softens by a thousandth beyond a hundred rest lengths; the energy does not.
struct WrongFarAway : HookesLaw {
  template <class Real>
  static void force(const Real& k, const Real& rest, const Vec<Real, 3>& apart, Vec<Real, 3>& one,
                    Vec<Real, 3>& other) {
    HookesLaw::force(k, rest, apart, one, other);
    if (distance(apart) < Real(100.0) * rest) return;
    one = Real(0.999) * one;
    other = Real(0.999) * other;
  }
};

/// Cut off at one and a half rest lengths, without shifting the energy.
struct CutOff : HookesLaw {
  template <class Real>
  static Real energy(const Real& k, const Real& rest, const Real& r) {
    return r < Real(1.5) * rest ? HookesLaw::energy(k, rest, r) : Real(0.0);
  }
  template <class Real>
  static void force(const Real& k, const Real& rest, const Vec<Real, 3>& apart, Vec<Real, 3>& one,
                    Vec<Real, 3>& other) {
    HookesLaw::force(k, rest, apart, one, other);
    if (distance(apart) < Real(1.5) * rest) return;
    one = Real(0.0) * one;
    other = Real(0.0) * other;
  }
};

/// Hooke's law, cut off with the energy shifted, which is right.
struct CutOffAndShifted : CutOff {
  template <class Real>
  static Real energy(const Real& k, const Real& rest, const Real& r) {
    const Real edge = Real(1.5) * rest;
    return HookesLaw::energy(k, rest, r < edge ? r : edge);
  }
};

}  // namespace tomlin::test
