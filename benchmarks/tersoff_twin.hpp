#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "framework/core/elements/bond_order_kernels.hpp"
#include "framework/core/numbers/math.hpp"
#include "framework/core/system/aligned.hpp"

/// Tersoff's potential as one would write it by hand for one case in vectors: a single species
/// without lambda3, three neighbours for ever, eight atoms at a time. Of the engine it has the
/// vectors, exponential and logarithm; the numbers are those of Lindsay and Broido for carbon.
namespace tomlin::plain {

/// L. Lindsay and D. A. Broido, Phys. Rev. B 81, 205441 (2010), Table I; eV, 1/Angstrom.
namespace carbon {
inline constexpr double kA = 1393.6;
inline constexpr double kB = 430.0;
inline constexpr double kLambda1 = 3.4879;
inline constexpr double kLambda2 = 2.2119;
inline constexpr double kBeta = 1.5724e-7;
inline constexpr double kN = 0.72751;
inline constexpr double kC2 = 38049.0 * 38049.0;
inline constexpr double kD2 = 4.3484 * 4.3484;
inline constexpr double kH = -0.930;
}  // namespace carbon

struct TersoffTwin {
  std::size_t count = 0;                ///< a multiple of eight
  AlignedVector<double> x[3];           ///< [atom]
  AlignedVector<double> force[3];       ///< [atom]
  AlignedVector<std::int64_t> near[3];  ///< [atom], of each of three neighbours
  AlignedVector<std::int64_t> back[3];  ///< [atom], where the gradient of that neighbour's is
  AlignedVector<double> shift[3];       ///< [atom], of its image along x
  AlignedVector<double> gradient[3];    ///< [neighbour * count + atom], by axis
};

using TersoffTwinKernel = void (*)(TersoffTwin& tube);

// One is compiled for each instruction set of the build.
void tersoff_twin_baseline(TersoffTwin& tube);
void tersoff_twin_avx2(TersoffTwin& tube);
void tersoff_twin_avx512(TersoffTwin& tube);

inline namespace TOMLIN_TARGET {

struct TwinBond {
  Pack e[3];
  Pack distance;
  Pack inverse;
  Pack cutoff;
  Pack cutoff_slope;
  Pack gradient[3];
};

TOMLIN_FLATTEN inline void twin_gradients(TersoffTwin& tube) {
  using namespace carbon;
  constexpr double kInner = 1.8;
  constexpr double kOuter = 2.1;
  const std::size_t n = tube.count;
  const double* x[3];
  double* gradient[3];
  for (int d = 0; d < 3; ++d) {
    x[d] = tube.x[d].data();
    gradient[d] = tube.gradient[d].data();
  }
  const Pack one(1.0);
  const Pack half(0.5);
  for (std::size_t i = 0; i < n; i += kGroup) {
    TwinBond bond[3];
    Pack longest(0.0);
    for (int j = 0; j < 3; ++j) {
      TwinBond& b = bond[j];
      const std::int64_t* const near = tube.near[j].data() + i;
      for (int d = 0; d < 3; ++d) b.e[d] = gathered(x[d], near) - Pack::load(x[d] + i);
      b.e[0] = b.e[0] + Pack::load(tube.shift[j].data() + i);
      b.distance = sqrt(fma(b.e[2], b.e[2], fma(b.e[1], b.e[1], b.e[0] * b.e[0])));
      b.inverse = one / b.distance;
      for (int d = 0; d < 3; ++d) b.e[d] = b.e[d] * b.inverse;
      longest = max(longest, b.distance);
      b.cutoff = one;
      b.cutoff_slope = Pack(0.0);
      for (int d = 0; d < 3; ++d) b.gradient[d] = Pack(0.0);
    }
    if (any(longest > Pack(kInner))) {
      for (TwinBond& b : bond) {
        Pack sine;
        Pack cosine;
        const Pack turns(0.5 / (kOuter - kInner));
        sincos_turns((b.distance - Pack(0.5 * (kInner + kOuter))) * turns, sine, cosine);
        const auto within = b.distance <= Pack(kInner);
        const auto beyond = b.distance >= Pack(kOuter);
        b.cutoff = select(within, one, select(beyond, Pack(0.0), half - half * sine));
        b.cutoff_slope =
            select(within | beyond, Pack(0.0), cosine * turns * Pack(-3.14159265358979));
      }
    }
    // Pairs of neighbours are in the order 0 and 1, 0 and 2, 1 and 2.
    Pack cosine[3];
    Pack angle[3];
    Pack angle_slope[3];
    const auto pair_of = [](int j, int k) { return j + k - 1; };
    for (int j = 0; j < 3; ++j) {
      for (int k = j + 1; k < 3; ++k) {
        const int m = pair_of(j, k);
        cosine[m] = fma(bond[j].e[2], bond[k].e[2],
                        fma(bond[j].e[1], bond[k].e[1], bond[j].e[0] * bond[k].e[0]));
        const Pack apart = Pack(kH) - cosine[m];
        const Pack squared = apart * apart;
        const Pack part = Pack(kC2) / (squared + Pack(kD2));
        angle[m] = fma(squared * part, Pack(1.0 / kD2), one);
        angle_slope[m] = Pack(-2.0) * apart * part * part * Pack(1.0 / kC2);
      }
    }
    for (int j = 0; j < 3; ++j) {
      TwinBond& b = bond[j];
      Pack zeta(0.0);
      for (int k = 0; k < 3; ++k) {
        if (k != j) zeta = fma(bond[k].cutoff, angle[pair_of(j, k)], zeta);
      }
      const Pack power = exp(log(zeta * Pack(kBeta)) * Pack(kN));
      const Pack order = exp(log(power + one) * Pack(-0.5 / kN));
      const Pack repulsion = exp(b.distance * Pack(-kLambda1)) * Pack(kA);
      const Pack attraction = exp(b.distance * Pack(-kLambda2)) * Pack(-kB);
      const Pack potential = fma(order, attraction, repulsion);
      const Pack slope = fma(order * attraction, Pack(-kLambda2), repulsion * Pack(-kLambda1));
      const Pack radial = half * fma(b.cutoff_slope, potential, b.cutoff * slope);
      const Pack by_zeta =
          Pack(-0.25) * b.cutoff * attraction * order * power / ((power + one) * zeta);
      for (int d = 0; d < 3; ++d) b.gradient[d] = fma(radial, b.e[d], b.gradient[d]);
      for (int k = 0; k < 3; ++k) {
        if (k == j) continue;
        const int m = pair_of(j, k);
        TwinBond& other = bond[k];
        const Pack by_cosine = by_zeta * other.cutoff * angle_slope[m];
        const Pack by_distance = by_zeta * other.cutoff_slope * angle[m];
        const Pack across_j = by_cosine * b.inverse;
        const Pack across_k = by_cosine * other.inverse;
        for (int d = 0; d < 3; ++d) {
          b.gradient[d] = fma(across_j, fnma(cosine[m], b.e[d], other.e[d]), b.gradient[d]);
          other.gradient[d] = fma(across_k, fnma(cosine[m], other.e[d], b.e[d]),
                                  fma(by_distance, other.e[d], other.gradient[d]));
        }
      }
    }
    for (std::size_t j = 0; j < 3; ++j) {
      for (int d = 0; d < 3; ++d) bond[j].gradient[d].store(gradient[d] + j * n + i);
    }
  }
}

TOMLIN_FLATTEN inline void twin_forces(TersoffTwin& tube) {
  const std::size_t n = tube.count;
  for (int d = 0; d < 3; ++d) {
    const double* gradient = tube.gradient[d].data();
    double* force = tube.force[d].data();
    for (std::size_t i = 0; i < n; i += kGroup) {
      Pack total(0.0);
      for (std::size_t j = 0; j < 3; ++j) {
        total = total +
                (Pack::load(gradient + j * n + i) - gathered(gradient, tube.back[j].data() + i));
      }
      total.store(force + i);
    }
  }
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin::plain
