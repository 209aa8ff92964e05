#include "framework/model/elastic_bodies.hpp"

#include <algorithm>
#include <cmath>

#include "framework/core/numbers/math.hpp"
#include "framework/core/numbers/power_of_two.hpp"

namespace tomlin {
namespace {

/// Modes are a full matrix, and finding them takes the cube of this.
constexpr std::size_t kMostCoordinates = 256;
/// Parts of the largest squared frequency that are rounding.
constexpr double kLeastSquareRatio = 1e-12;
/// Modes below this part of the largest squared frequency do not hold the shape.
constexpr double kLeastHoldingRatio = 1e-9;
/// Parts by which friction rates of one body may differ.
constexpr double kRateTolerance = 1e-12;

/// A symmetric matrix, diagonalised by Jacobi's rotations: plain loops, the same bits everywhere.
class Jacobi {
 public:
  /// Leaves eigenvectors in the rows of `vectors`.
  Jacobi(std::vector<double>& matrix, std::vector<double>& vectors, std::size_t n)
      : a_(matrix), v_(vectors), n_(n) {
    v_.assign(n * n, 0.0);
    for (std::size_t i = 0; i < n; ++i) v_[i * n + i] = 1.0;
    constexpr int kMostSweeps = 60;
    for (int sweep = 0; sweep < kMostSweeps && !diagonal(); ++sweep) {
      for (std::size_t p = 0; p + 1 < n; ++p) {
        for (std::size_t q = p + 1; q < n; ++q) rotate(p, q);
      }
    }
  }

 private:
  bool diagonal() const {
    double most = 0.0;
    double off = 0.0;
    for (std::size_t i = 0; i < n_; ++i) {
      for (std::size_t j = 0; j < n_; ++j) {
        double& largest = i == j ? most : off;
        largest = std::max(largest, std::abs(a_[i * n_ + j]));
      }
    }
    return off <= 1e-17 * most;
  }

  void rotate(std::size_t p, std::size_t q) {
    const double apq = a_[p * n_ + q];
    if (apq == 0.0) return;
    const double theta = (a_[q * n_ + q] - a_[p * n_ + p]) / (2.0 * apq);
    const double t = (theta >= 0.0 ? 1.0 : -1.0) / (std::abs(theta) + sqrt(fma(theta, theta, 1.0)));
    const double c = 1.0 / sqrt(fma(t, t, 1.0));
    const double s = t * c;
    for (std::size_t k = 0; k < n_; ++k) turn(a_[k * n_ + p], a_[k * n_ + q], c, s);
    for (std::size_t k = 0; k < n_; ++k) turn(a_[p * n_ + k], a_[q * n_ + k], c, s);
    for (std::size_t k = 0; k < n_; ++k) turn(v_[p * n_ + k], v_[q * n_ + k], c, s);
    a_[p * n_ + q] = a_[q * n_ + p] = 0.0;
  }

  static void turn(double& x, double& y, double c, double s) {
    const double old = x;
    x = c * old - s * y;
    y = s * old + c * y;
  }

  std::vector<double>& a_;
  std::vector<double>& v_;
  std::size_t n_;
};

/// Bonds of one body, as a matrix over its coordinates.
class BondMatrix : public HessianSink {
 public:
  BondMatrix(std::size_t body, std::size_t count, int axes)
      : body_(body), count_(count), n_(count * static_cast<std::size_t>(axes)) {
    values.assign(n_ * n_, 0.0);
  }
  // A body's own sites: what is left of forces among three particles or more.
  void site(std::size_t body, std::size_t i, int a, int b, double value) override {
    if (body == body_) values[(a * count_ + i) * n_ + b * count_ + i] += value;
  }
  void block(std::size_t body1, std::size_t i, int a, std::size_t body2, std::size_t j, int b,
             double value) override {
    if (body1 != body_ || body2 != body_) return;
    values[(a * count_ + i) * n_ + b * count_ + j] += value;
  }
  void centre(std::size_t, const double*, int, int, double) override {}
  void pair(std::size_t body1, std::size_t i, std::size_t body2, std::size_t j, int a, int b,
            double value) override {
    if (body1 != body_ || body2 != body_) return;
    const std::size_t ia = a * count_ + i, ib = b * count_ + i;
    const std::size_t ja = a * count_ + j, jb = b * count_ + j;
    values[ia * n_ + ib] += value;
    values[ja * n_ + jb] += value;
    values[ia * n_ + jb] -= value;
    values[ja * n_ + ib] -= value;
  }

  std::vector<double> values;

 private:
  std::size_t body_;
  std::size_t count_;
  std::size_t n_;
};

class Coefficients : public FrictionSink {
 public:
  Coefficients(std::size_t body, std::size_t count) : body_(body), values(count, 0.0) {}
  void site(std::size_t body, std::size_t particle, double coefficient) override {
    if (body == body_) values[particle] += coefficient;
  }

 private:
  std::size_t body_;

 public:
  std::vector<double> values;
};

/// The start of a scene, and the force of some forces alone there.
class Start {
 public:
  explicit Start(Assembly<double>& assembly) : view_(assembly.system().view) {
    position_.assign(view_.dofs + 2 * kGroup, 0.0);
    velocity_ = position_;
    force_ = position_;
    integrals_.assign(view_.rates + 2 * kGroup, 0.0);
    rates_ = integrals_;
    assembly.start(position_.data(), velocity_.data(), integrals_.data(), nullptr);
  }

  Stage<double> stage() {
    Stage<double> here =
        stage_of(view_, static_cast<const double*>(position_.data()),
                 static_cast<const double*>(velocity_.data()),
                 static_cast<const double*>(integrals_.data()), rates_.data(), 0.0);
    here.force = force_.data();
    return here;
  }
  void add(const Assembly<double>::Force& force) {
    for (const Pass<double>& pass : force.own_passes()) {
      if (pass.add != nullptr) pass.add(pass.arguments, stage());
    }
  }
  const double* force() const { return force_.data(); }

 private:
  const SystemView<double>& view_;
  AlignedVector<double> position_, velocity_, force_, integrals_, rates_;
};

using Body = Assembly<double>::Body;

/// Why a body cannot be taken; empty when it can.
std::string refusal_of(const Body& body, bool bonded) {
  const std::string name = "the body \"" + body.bound.name + "\" ";
  if (body.bound.slot.rigid) return name + "is rigid: it has no bonds to split off";
  if (std::any_of(body.held.begin(), body.held.end(), [](bool held) { return held; })) {
    return name + "is held along an axis";
  }
  if (!bonded) return "";
  const auto axes = static_cast<std::size_t>(body.dimension);
  if (axes > 2) return name + "turns in space, which its modes do not follow";
  if (axes * body.bound.slot.count > kMostCoordinates) {
    return name + "has more than " + std::to_string(kMostCoordinates) + " coordinates with bonds";
  }
  return "";
}

/// Motions of a body in the plane as a whole, in mass-weighted coordinates, of unit length each.
std::vector<std::vector<double>> rigid_motions(const ElasticBody& elastic) {
  const std::size_t n = elastic.size();
  const std::size_t count = elastic.count;
  std::vector<std::vector<double>> motions;
  for (int d = 0; d < elastic.axes; ++d) {
    motions.emplace_back(n, 0.0);
    for (std::size_t i = 0; i < count; ++i) motions.back()[d * count + i] = elastic.root_mass[i];
  }
  if (elastic.turns) {
    motions.emplace_back(n, 0.0);
    for (std::size_t i = 0; i < count; ++i) {
      motions.back()[i] = -elastic.root_mass[i] * elastic.shape[count + i];
      motions.back()[count + i] = elastic.root_mass[i] * elastic.shape[i];
    }
  }
  for (std::vector<double>& motion : motions) {
    double squares = 0.0;
    for (const double x : motion) squares = fma(x, x, squares);
    if (squares == 0.0) continue;
    for (double& x : motion) x /= sqrt(squares);
  }
  return motions;
}

/// matrix <- (1 - t t^T) matrix (1 - t t^T).
void project_out(const std::vector<double>& t, std::vector<double>& matrix) {
  const std::size_t n = t.size();
  std::vector<double> along(n, 0.0);
  double both = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) along[i] = fma(matrix[i * n + j], t[j], along[i]);
    both = fma(t[i], along[i], both);
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      matrix[i * n + j] += t[i] * t[j] * both - t[i] * along[j] - along[i] * t[j];
    }
  }
}

/// In the plane the modes are those of a shape, which bonds have to hold: the frame follows the
/// motion as a whole and no other. Returns why they do not, if so.
std::string find_modes(const Body& body, std::vector<double> matrix, const double* force,
                       ElasticBody& elastic) {
  const std::size_t n = elastic.size();
  const double unit = power_of_two_above(elastic.mass.front());
  const auto root = [&](std::size_t k) { return elastic.root_mass[k % elastic.count]; };
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      matrix[i * n + j] = matrix[i * n + j] / unit / (root(i) * root(j));
    }
  }
  const auto whole = rigid_motions(elastic);
  if (elastic.axes > 1) {
    for (const std::vector<double>& motion : whole) project_out(motion, matrix);
  }
  Jacobi(matrix, elastic.modes, n);
  double most = 0.0;
  for (std::size_t j = 0; j < n; ++j) most = std::max(most, matrix[j * n + j]);
  std::size_t loose = 0;
  std::size_t pushed = 0;
  for (std::size_t j = 0; j < n; ++j) {
    // On a line bonds under pressure may push; that is left to the kicks.
    const double square = matrix[j * n + j] > kLeastSquareRatio * most ? matrix[j * n + j] : 0.0;
    if (matrix[j * n + j] <= kLeastHoldingRatio * most) ++loose;
    if (matrix[j * n + j] < -kLeastHoldingRatio * most) ++pushed;
    double pull = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t at =
          body.bound.slot.offset + k / elastic.count * body.bound.slot.stride + k % elastic.count;
      pull = fma(elastic.modes[j * n + k], force[at] / unit / root(k), pull);
    }
    elastic.squares.push_back(square);
    elastic.equilibrium.push_back(square > 0.0 ? pull / square : 0.0);
  }
  if (elastic.axes == 1 || loose <= whole.size()) return "";
  const std::string name = "the bonds of the body \"" + body.bound.name + "\" do not ";
  if (pushed > 0) {
    return name + "keep its shape: it buckles under them";
  }
  return name + "determine its shape: it bends freely in " + std::to_string(loose - whole.size()) +
         " directions, which its modes do not describe";
}

}  // namespace

bool is_bonds(const Assembly<double>& assembly, const Assembly<double>::Force& force) {
  const Traits& traits = force.traits;
  if (!traits.internal || !traits.conservative || traits.depends_on_time) return false;
  if (force.bodies.size() != 1) return false;
  const BodySlot<double>& slot = assembly.bodies()[force.bodies.front()].bound.slot;
  return !slot.rigid && !slot.mapped;
}

std::vector<ElasticBody> elastic_bodies(Assembly<double>& assembly, std::string& fault) {
  std::vector<ElasticBody> all;
  Start start(assembly);
  for (const auto& force : assembly.forces()) {
    if (is_bonds(assembly, force)) start.add(force);
  }
  for (const Body& body : assembly.bodies()) {
    const BodySlot<double>& slot = body.bound.slot;
    if (slot.mapped && !slot.rigid) continue;
    const auto bonds_it = [&](const auto& force) {
      return is_bonds(assembly, force) && force.bodies.front() == body.bound.index;
    };
    const bool bonded = std::any_of(assembly.forces().begin(), assembly.forces().end(), bonds_it);
    fault = refusal_of(body, bonded);
    if (!fault.empty()) return {};

    ElasticBody elastic;
    elastic.offset = slot.offset;
    elastic.stride = slot.stride;
    elastic.count = slot.count;
    elastic.axes = body.dimension;
    elastic.turns = bonded && body.rotates() && !body.turns_in_space;
    elastic.mass = body.bound.mass;
    for (const double mass : elastic.mass) {
      elastic.total_mass += mass;
      elastic.root_mass.push_back(sqrt(mass / power_of_two_above(elastic.mass.front())));
    }
    for (int d = 0; d < elastic.axes; ++d) {
      for (std::size_t i = 0; i < slot.count; ++i) elastic.shape.push_back(body.arms[i][d]);
    }
    Coefficients coefficients(body.bound.index, slot.count);
    for (const auto& force : assembly.forces()) force.friction->friction(coefficients);
    elastic.friction_rate = coefficients.values.front() / elastic.mass.front();
    for (std::size_t i = 0; i < slot.count; ++i) {
      const double rate = coefficients.values[i] / elastic.mass[i];
      if (std::abs(rate - elastic.friction_rate) > kRateTolerance * elastic.friction_rate) {
        fault = "friction of the body \"" + body.bound.name +
                "\" is not in proportion to its particles' masses";
        return {};
      }
    }
    if (bonded) {
      BondMatrix matrix(body.bound.index, slot.count, elastic.axes);
      for (const auto& force : assembly.forces()) {
        if (bonds_it(force)) force.curvature->hessian(start.stage(), matrix);
      }
      fault = find_modes(body, std::move(matrix.values), start.force(), elastic);
      if (!fault.empty()) return {};
    }
    all.push_back(std::move(elastic));
  }
  return all;
}

}  // namespace tomlin
