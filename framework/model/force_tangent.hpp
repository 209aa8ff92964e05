#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/numbers/band_matrix.hpp"
#include "framework/core/numbers/bordered_factors.hpp"
#include "framework/core/records/bound_force.hpp"
#include "framework/core/system/aligned.hpp"
#include "framework/core/system/tangent.hpp"
#include "framework/model/assembly.hpp"
#include "framework/model/coupling.hpp"

namespace tomlin {

/// The tangent of a bound scene, from the element Hessians of its forces.
///
/// With P_i the derivative of particle i's position with respect to the coordinates q (for a rigid
/// body about its present arms), H the element Hessians, c friction coefficients, F_i the force on
/// particle i and phi the rotation of its body:
///   K = sum P^T H P  -  sum F_i . d2x_i/dphi2  -  (drag's change as arms turn),  G = sum c_i P_i^T
///   P_i
/// Kept as a band plus terms w d d^T, d spread over a body: forces on the centre of mass of free
/// particles (bordered_factors.hpp).
class ForceTangent final : public Tangent {
 public:
  /// Work of one factorisation, size * band^2 multiplications, that is still taken on: a full
  /// matrix of 600 coordinates.
  static constexpr std::size_t kMostWork = std::size_t{600} * 600 * 600;
  /// Matrices up to this size are kept full.
  static constexpr std::size_t kMostFullCoordinates = 32;

  explicit ForceTangent(Assembly<double>& assembly);

  const std::vector<std::size_t>& coordinates() const override { return coordinates_; }
  const std::vector<double>& masses() const override { return masses_; }
  std::string unknown() const override { return unknown_; }
  std::size_t columns() const override { return columns_; }
  void linearise(const double* position, const double* velocity, const double* integrals,
                 double elapsed, double* rates) override;
  using Tangent::linearise;
  void times_stiffness(const double* x, double* y) const override;
  void times_friction(const double* x, double* y) const override { friction_.times(x, y); }
  bool factor(double mass, double friction, double stiffness, const double* borders,
              std::size_t border_count, double border_weight) override;
  using Tangent::factor;
  void solve(double* x) const override { factors_.solve(x); }
  std::size_t negative() const override { return factors_.negative(); }
  double log_determinant() const override { return factors_.log_determinant(); }
  std::unique_ptr<ShiftedTangent> shifted() const override;

 private:
  class Shifted;
  class Sink;
  class Finder;

  /// How a position along an axis follows from the free coordinates: by one of them, or by a rigid
  /// body's centre and rotation.
  static constexpr std::ptrdiff_t kNone = -1;
  struct Part {
    std::ptrdiff_t coordinate = kNone;
    double factor = 0.0;
  };
  using Parts = std::array<Part, 2>;

  /// A particle or a rigid body: where its coordinates stand in the state (kNone: not free).
  struct Node {
    std::array<std::ptrdiff_t, 3> at = {kNone, kNone, kNone};
    std::array<double, 3> mass{};
  };

  std::string first_unknown() const;
  void assign_coordinates();
  Node node_of(const Assembly<double>::Body& body, std::size_t particle) const;
  bool find_elements(Finder& finder);
  void choose_matrix(const CouplingGraph& graph, std::size_t spread_terms);
  std::pair<std::size_t, std::size_t> range_of(std::size_t node) const;

  double arm(const BodySlot<double>& slot, std::size_t particle, int axis) const;
  Parts parts(std::size_t body, std::size_t particle, int axis) const;
  Parts rigid_parts(std::size_t body, int axis, double arm_x, double arm_y) const;
  static void add(BandMatrix& matrix, std::vector<double>& sizes, const Parts& one,
                  const Parts& other, double value);
  void add_mean(std::size_t body, const double* weight, int a, int b, double value);
  void add_term(RankOne term);
  void turn_forces(const Assembly<double>::Body& body, const double* velocity);
  double size_of(std::size_t i, double mass, double friction, double stiffness) const;

  Assembly<double>& assembly_;
  std::string unknown_;
  std::size_t columns_ = 0;
  std::vector<std::size_t> coordinates_;
  std::vector<double> masses_;
  std::vector<std::vector<std::size_t>> nodes_;      ///< of bodies: particles', or a rigid body's
  std::vector<std::array<std::ptrdiff_t, 3>> free_;  ///< of nodes: which free coordinate, or -1

  // At the state of the last linearise().
  const double* position_ = nullptr;
  BandMatrix stiffness_;
  BandMatrix friction_;
  /// Sums of the absolute contributions to each diagonal entry: rounding is that of these.
  std::vector<double> stiffness_sizes_;
  std::vector<double> friction_sizes_;
  std::vector<RankOne> terms_;
  std::vector<std::vector<double>> coefficients_;  ///< of friction, of bodies' particles
  AlignedVector<double> unused_rates_;

  // Results of the last factor().
  BandMatrix matrix_;
  std::vector<double> sizes_;
  BorderedFactors factors_;
};

}  // namespace tomlin
