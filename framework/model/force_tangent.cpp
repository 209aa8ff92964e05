#include "framework/model/force_tangent.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "framework/core/numbers/math.hpp"
#include "framework/core/records/force.hpp"
#include "framework/model/coupling.hpp"

namespace tomlin {
namespace {

constexpr std::size_t kNoNode = static_cast<std::size_t>(-1);

bool turns(const Assembly<double>::Body& body) {
  return body.bound.slot.rigid && body.rotates() && body.response_of_rotation > 0.0;
}

double dot(const std::vector<double>& a, const double* b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// The only particle with weight, or `count` when there are several.
std::size_t single_particle(const double* weight, std::size_t count) {
  std::size_t found = count;
  for (std::size_t i = 0; i < count; ++i) {
    if (weight[i] == 0.0) continue;
    if (found != count) return count;
    found = i;
  }
  return found;
}

}  // namespace

/// Puts elements into the matrices.
class ForceTangent::Sink : public HessianSink, public FrictionSink {
 public:
  explicit Sink(ForceTangent& tangent) : to_(tangent) {}

  void site(std::size_t body, std::size_t particle, int a, int b, double value) override {
    stiffness(to_.parts(body, particle, a), to_.parts(body, particle, b), value);
  }
  void pair(std::size_t body1, std::size_t i, std::size_t body2, std::size_t j, int a, int b,
            double value) override {
    const Parts one_a = to_.parts(body1, i, a);
    const Parts one_b = to_.parts(body1, i, b);
    const Parts other_a = to_.parts(body2, j, a);
    const Parts other_b = to_.parts(body2, j, b);
    stiffness(one_a, one_b, value);
    stiffness(other_a, other_b, value);
    stiffness(one_a, other_b, -value);
    stiffness(other_a, one_b, -value);
  }
  void block(std::size_t body1, std::size_t i, int a, std::size_t body2, std::size_t j, int b,
             double value) override {
    stiffness(to_.parts(body1, i, a), to_.parts(body2, j, b), value);
  }
  void centre(std::size_t body, const double* weight, int a, int b, double value) override {
    to_.add_mean(body, weight, a, b, value);
  }
  void site(std::size_t body, std::size_t particle, double coefficient) override {
    to_.coefficients_[body][particle] += coefficient;
    for (int d = 0; d < to_.assembly_.dimension(); ++d) {
      const Parts parts = to_.parts(body, particle, d);
      add(to_.friction_, to_.friction_sizes_, parts, parts, coefficient);
    }
  }

 private:
  void stiffness(const Parts& one, const Parts& other, double value) {
    add(to_.stiffness_, to_.stiffness_sizes_, one, other, value);
  }

  ForceTangent& to_;
};

/// Sees which particles meet in elements.
class ForceTangent::Finder : public HessianSink {
 public:
  Finder(const ForceTangent& tangent, std::size_t nodes) : graph(nodes), of_(tangent) {}

  void site(std::size_t, std::size_t, int, int, double) override { ++elements; }
  void pair(std::size_t body1, std::size_t i, std::size_t body2, std::size_t j, int, int,
            double) override {
    join(body1, i, body2, j);
  }
  void block(std::size_t body1, std::size_t i, int, std::size_t body2, std::size_t j, int,
             double) override {
    join(body1, i, body2, j);
  }
  void centre(std::size_t body, const double* weight, int a, int b, double) override {
    ++elements;
    const BodySlot<double>& slot = of_.assembly_.bodies()[body].bound.slot;
    if (slot.mapped || single_particle(weight, slot.count) != slot.count) return;
    if (a == b) ++spread_terms;
  }

  CouplingGraph graph;
  std::size_t elements = 0;
  std::size_t spread_terms = 0;

 private:
  void join(std::size_t body1, std::size_t i, std::size_t body2, std::size_t j) {
    ++elements;
    const std::size_t one = node(body1, i);
    const std::size_t other = node(body2, j);
    if (one != kNoNode && other != kNoNode) graph.join(one, other);
  }
  std::size_t node(std::size_t body, std::size_t particle) const {
    const std::vector<std::size_t>& nodes = of_.nodes_[body];
    if (nodes.empty()) return kNoNode;
    return of_.assembly_.bodies()[body].bound.slot.rigid ? nodes.front() : nodes[particle];
  }

  const ForceTangent& of_;
};

ForceTangent::ForceTangent(Assembly<double>& assembly) : assembly_(assembly) {
  unused_rates_.assign(assembly.system().view.rates + 2 * kGroup, 0.0);
  for (const auto& body : assembly.bodies()) {
    coefficients_.emplace_back(body.bound.slot.count, 0.0);
  }
  unknown_ = first_unknown();
  if (unknown_.empty()) assign_coordinates();
}

std::string ForceTangent::first_unknown() const {
  for (const auto& force : assembly_.forces()) {
    const Traits& traits = force.traits;
    const auto because = [&](const char* why) {
      return fmt::format("the force \"{}\" {}", force.name, why);
    };
    if (force.variables->own_count() > 0) return because("has internal variables");
    if (traits.stochastic) return because("is stochastic");
    if (force.friction->is_friction()) continue;
    if (traits.depends_on_velocity)
      return because("depends on velocity and is not linear friction");
    if (!traits.conservative) return because("is not the gradient of an energy");
  }
  return {};
}

/// Bodies' free coordinates in an order in which those that meet in a force are near each other.
void ForceTangent::assign_coordinates() {
  std::vector<Node> found;
  for (const auto& body : assembly_.bodies()) {
    const BodySlot<double>& slot = body.bound.slot;
    nodes_.emplace_back();
    if (slot.mapped && !slot.rigid) continue;
    for (std::size_t i = 0; i < (slot.rigid ? 1 : slot.count); ++i) {
      nodes_.back().push_back(found.size());
      found.push_back(node_of(body, i));
    }
  }
  Finder finder(*this, found.size());
  if (!find_elements(finder)) return;
  finder.graph.settle();

  free_.assign(found.size(), {kNone, kNone, kNone});
  for (const std::size_t node : finder.graph.narrow_order()) {
    for (std::size_t d = 0; d < 3; ++d) {
      if (found[node].at[d] == kNone) continue;
      free_[node][d] = static_cast<std::ptrdiff_t>(coordinates_.size());
      coordinates_.push_back(static_cast<std::size_t>(found[node].at[d]));
      masses_.push_back(found[node].mass[d]);
    }
  }
  choose_matrix(finder.graph, finder.spread_terms);
}

ForceTangent::Node ForceTangent::node_of(const Assembly<double>::Body& body, std::size_t i) const {
  const BodySlot<double>& slot = body.bound.slot;
  Node node;
  for (std::size_t d = 0; d < static_cast<std::size_t>(assembly_.dimension()); ++d) {
    if (body.held[d]) continue;
    node.at[d] = static_cast<std::ptrdiff_t>(slot.rigid ? slot.centre + d
                                                        : slot.offset + d * slot.stride + i);
    node.mass[d] = slot.rigid ? body.total_mass : body.bound.mass[i];
  }
  if (turns(body)) {
    node.at[kRotation] = static_cast<std::ptrdiff_t>(slot.centre + kRotation);
    node.mass[kRotation] = tau<double>() * tau<double>() * body.inertia;
  }
  return node;
}

/// Forces name the same elements wherever things are, and those with a cutoff name all where all
/// particles coincide: this asks them at no position at all, in arrays of its own.
bool ForceTangent::find_elements(Finder& finder) {
  const SystemView<double>& view = assembly_.system().view;
  const AlignedVector<double> nowhere(view.dofs + view.own + 2 * kGroup, 0.0);
  AlignedVector<double> mapped(assembly_.mapped_size() + 2 * kGroup, 0.0);
  Stage<double> stage =
      stage_of(view, nowhere.data(), nowhere.data(), nowhere.data(), unused_rates_.data(), 0.0);
  stage.mapped_position = stage.mapped_velocity = stage.mapped_force = mapped.data();
  for (const auto& force : assembly_.forces()) {
    const std::size_t before = finder.elements;
    force.curvature->hessian(stage, finder);
    const bool acts = !force.friction->is_friction() && !force.bound->passes().empty();
    if (acts && finder.elements == before) {
      unknown_ = fmt::format("the force \"{}\" gives no second derivatives", force.name);
      return false;
    }
  }
  return true;
}

void ForceTangent::choose_matrix(const CouplingGraph& graph, std::size_t spread_terms) {
  const std::size_t n = coordinates_.size();
  std::size_t band = 0;
  std::vector<std::size_t> widest_of_group;
  const std::vector<std::size_t> group = graph.groups();
  for (std::size_t node = 0; node < graph.size(); ++node) {
    const auto [least, count] = range_of(node);
    widest_of_group.resize(std::max(widest_of_group.size(), group[node] + 1), 0);
    widest_of_group[group[node]] = std::max(widest_of_group[group[node]], count);
    if (count == 0) continue;
    band = std::max(band, count - 1);
    for (const std::size_t other : graph.neighbours(node)) {
      const auto [from, further] = range_of(other);
      if (further > 0 && from >= least) band = std::max(band, from + further - 1 - least);
    }
  }
  columns_ = spread_terms;
  for (const std::size_t widest : widest_of_group) columns_ += widest;
  columns_ = std::min(columns_, n);
  if (n <= kMostFullCoordinates || 2 * band + 1 >= n) band = n == 0 ? 0 : n - 1;
  if (n * band * band > kMostWork) {
    unknown_ = fmt::format(
        "forces couple {} coordinates, each with up to {} others: to solve for them would take "
        "more than {:.1e} multiplications each time",
        n, band, static_cast<double>(kMostWork));
    return;
  }
  stiffness_ = friction_ = matrix_ = BandMatrix(n, band);
  sizes_.assign(n, 0.0);
  stiffness_sizes_.assign(n, 0.0);
  friction_sizes_.assign(n, 0.0);
}

/// The first free coordinate of a node, and how many it has.
std::pair<std::size_t, std::size_t> ForceTangent::range_of(std::size_t node) const {
  std::size_t first = 0;
  std::size_t count = 0;
  for (const std::ptrdiff_t coordinate : free_[node]) {
    if (coordinate == kNone) continue;
    if (count++ == 0) first = static_cast<std::size_t>(coordinate);
  }
  return {first, count};
}

// ---- K and G

/// From the centre to a particle of a rigid body, as it is turned now.
double ForceTangent::arm(const BodySlot<double>& slot, std::size_t particle, int axis) const {
  return assembly_.system().view.mapped_position[slot.offset + axis * slot.stride + particle] -
         position_[slot.centre + axis];
}

ForceTangent::Parts ForceTangent::parts(std::size_t b, std::size_t particle, int axis) const {
  if (nodes_[b].empty()) return {};
  const BodySlot<double>& slot = assembly_.bodies()[b].bound.slot;
  if (!slot.rigid) return {Part{free_[nodes_[b][particle]][axis], 1.0}, Part{}};
  if (!turns(assembly_.bodies()[b])) return {Part{free_[nodes_[b].front()][axis], 1.0}, Part{}};
  return rigid_parts(b, axis, arm(slot, particle, 0), arm(slot, particle, 1));
}

ForceTangent::Parts ForceTangent::rigid_parts(std::size_t b, int axis, double arm_x,
                                              double arm_y) const {
  const std::array<std::ptrdiff_t, 3>& free = free_[nodes_[b].front()];
  return {Part{free[axis], 1.0},
          Part{free[kRotation], tau<double>() * (axis == 0 ? -arm_y : arm_x)}};
}

void ForceTangent::add(BandMatrix& matrix, std::vector<double>& sizes, const Parts& one,
                       const Parts& other, double value) {
  for (const Part& i : one) {
    if (i.coordinate == kNone) continue;
    const auto row = static_cast<std::size_t>(i.coordinate);
    for (const Part& j : other) {
      if (j.coordinate == kNone) continue;
      const auto column = static_cast<std::size_t>(j.coordinate);
      if (!matrix.holds(row, column)) throw std::logic_error("a force has a new element");
      const double entry = value * i.factor * j.factor;
      matrix.at(row, column) += entry;
      if (row == column) sizes[row] += std::abs(entry);
    }
  }
}

/// A force on the weighted mean of a body's particles: an element of its own where that follows
/// from few coordinates, else a term beside the band.
void ForceTangent::add_mean(std::size_t b, const double* weight, int a, int c, double value) {
  if (nodes_[b].empty() || value == 0.0) return;
  const auto& body = assembly_.bodies()[b];
  const BodySlot<double>& slot = body.bound.slot;
  if (slot.rigid) {
    const auto mean = [&](int axis) {
      if (!turns(body)) return parts(b, 0, axis);
      double x = 0.0;
      double y = 0.0;
      for (std::size_t i = 0; i < slot.count; ++i) {
        x += weight[i] * arm(slot, i, 0);
        y += weight[i] * arm(slot, i, 1);
      }
      return rigid_parts(b, axis, x, y);
    };
    add(stiffness_, stiffness_sizes_, mean(a), mean(c), value);
    return;
  }
  const std::size_t only = single_particle(weight, slot.count);
  if (only != slot.count) {
    add(stiffness_, stiffness_sizes_, parts(b, only, a), parts(b, only, c), value);
    return;
  }
  // x y^T + y x^T = ((x + y) (x + y)^T - (x - y) (x - y)^T) / 2; each of the two comes by once.
  const auto spread = [&](double sign, double share) {
    RankOne term{std::vector<double>(coordinates_.size(), 0.0), share};
    for (std::size_t i = 0; i < slot.count; ++i) {
      const std::array<std::ptrdiff_t, 3>& free = free_[nodes_[b][i]];
      if (free[a] != kNone) term.direction[free[a]] = weight[i];
      if (a != c && free[c] != kNone) term.direction[free[c]] = sign * weight[i];
    }
    add_term(std::move(term));
  };
  if (a == c) {
    spread(1.0, value);
  } else {
    spread(1.0, 0.25 * value);
    spread(-1.0, -0.25 * value);
  }
}

void ForceTangent::add_term(RankOne term) {
  if (!stiffness_.full()) {
    terms_.push_back(std::move(term));
    return;
  }
  const std::vector<double>& d = term.direction;
  for (std::size_t i = 0; i < d.size(); ++i) {
    stiffness_sizes_[i] += std::abs(term.weight) * d[i] * d[i];
    for (std::size_t j = 0; j < d.size(); ++j) stiffness_.at(i, j) += term.weight * d[i] * d[j];
  }
}

void ForceTangent::linearise(const double* position, const double* velocity,
                             const double* integrals, double elapsed, double* rates) {
  const SystemView<double>& view = assembly_.system().view;
  const Stage<double> here = stage_of(view, position, velocity, integrals,
                                      rates == nullptr ? unused_rates_.data() : rates, elapsed);
  for (std::size_t k = 0; k < view.operation_count; ++k) {
    view.operations[k].run(view.operations[k].arguments, here);
  }
  position_ = position;
  stiffness_.clear();
  friction_.clear();
  std::fill(stiffness_sizes_.begin(), stiffness_sizes_.end(), 0.0);
  std::fill(friction_sizes_.begin(), friction_sizes_.end(), 0.0);
  terms_.clear();
  for (auto& coefficients : coefficients_) {
    std::fill(coefficients.begin(), coefficients.end(), 0.0);
  }
  Sink sink(*this);
  for (const auto& force : assembly_.forces()) {
    force.curvature->hessian(here, sink);
    force.friction->friction(sink);
  }
  for (const auto& body : assembly_.bodies()) {
    if (turns(body)) turn_forces(body, velocity);
  }
}

/// A rigid body's rotation turns the arms of the forces on its particles, and what friction makes
/// of their velocities.
void ForceTangent::turn_forces(const Assembly<double>::Body& body, const double* velocity) {
  const SystemView<double>& view = assembly_.system().view;
  const BodySlot<double>& slot = body.bound.slot;
  const std::vector<double>& coefficient = coefficients_[body.bound.index];
  // Without inertia velocities are the drift, which an evaluation leaves in place of the force, and
  // friction is not among the forces.
  const double* u = (view.inertial ? velocity : view.force) + slot.centre;
  const double omega = tau<double>() * u[kRotation];
  double along_arms = 0.0;
  double along_arms_size = 0.0;
  double moment[2] = {0.0, 0.0};
  for (std::size_t i = 0; i < slot.count; ++i) {
    const double x[2] = {arm(slot, i, 0), arm(slot, i, 1)};
    const double drift[2] = {u[0] - omega * x[1], u[1] + omega * x[0]};
    for (int d = 0; d < 2; ++d) {
      double force = view.mapped_force[slot.offset + d * slot.stride + i];
      if (!view.inertial) force -= coefficient[i] * drift[d];
      along_arms += force * x[d];
      along_arms_size += std::abs(force * x[d]);
      moment[d] += coefficient[i] * x[d];
    }
  }
  const std::array<std::ptrdiff_t, 3>& free = free_[nodes_[body.bound.index].front()];
  const std::ptrdiff_t rotation = free[kRotation];
  constexpr double kTurn = tau<double>();
  stiffness_.at(rotation, rotation) += kTurn * kTurn * along_arms;
  stiffness_sizes_[rotation] += kTurn * kTurn * along_arms_size;
  for (int d = 0; d < 2; ++d) {
    if (free[d] != kNone) stiffness_.at(free[d], rotation) -= kTurn * omega * moment[d];
  }
}

void ForceTangent::times_stiffness(const double* x, double* y) const {
  stiffness_.times(x, y);
  for (const RankOne& term : terms_) {
    const double along = term.weight * dot(term.direction, x);
    for (std::size_t i = 0; i < term.direction.size(); ++i) y[i] += along * term.direction[i];
  }
}

// ---- solving

/// Size of the terms of which the diagonal entries of a combination are sums.
double ForceTangent::size_of(std::size_t i, double mass, double friction, double stiffness) const {
  return mass * masses_[i] + friction * friction_sizes_[i] + stiffness * stiffness_sizes_[i];
}

bool ForceTangent::factor(double mass, double friction, double stiffness, const double* borders,
                          std::size_t border_count, double border_weight) {
  const std::size_t n = coordinates_.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = matrix_.first_of(i); j < matrix_.end_of(i); ++j) {
      matrix_.at(i, j) = friction * friction_.at(i, j) + stiffness * stiffness_.at(i, j);
    }
    matrix_.at(i, i) += mass * masses_[i];
    sizes_[i] = size_of(i, std::abs(mass), std::abs(friction), std::abs(stiffness));
  }
  std::vector<RankOne> terms = terms_;
  for (RankOne& term : terms) term.weight *= stiffness;
  for (std::size_t k = 0; k < border_count; ++k) {
    terms.push_back({std::vector<double>(borders + k * n, borders + (k + 1) * n), border_weight});
  }
  return factors_.factor(matrix_, terms, sizes_);
}

/// Real and imaginary parts side by side: (a + ib)(x + iy) as a real matrix of twice the size.
class ForceTangent::Shifted final : public ShiftedTangent {
 public:
  explicit Shifted(const ForceTangent& tangent)
      : of_(tangent),
        matrix_(2 * tangent.coordinates_.size(), 2 * tangent.stiffness_.band() + 1),
        sizes_(matrix_.size(), 0.0),
        both_(matrix_.size(), 0.0) {}

  bool factor(std::complex<double> mass, std::complex<double> friction, double stiffness) override {
    const std::size_t n = of_.coordinates_.size();
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = of_.stiffness_.first_of(i); j < of_.stiffness_.end_of(i); ++j) {
        const double g = of_.friction_.at(i, j);
        const double m = i == j ? of_.masses_[i] : 0.0;
        const double real =
            mass.real() * m + friction.real() * g + stiffness * of_.stiffness_.at(i, j);
        const double imaginary = mass.imag() * m + friction.imag() * g;
        matrix_.at(2 * i, 2 * j) = matrix_.at(2 * i + 1, 2 * j + 1) = real;
        matrix_.at(2 * i, 2 * j + 1) = -imaginary;
        matrix_.at(2 * i + 1, 2 * j) = imaginary;
      }
    }
    for (std::size_t i = 0; i < 2 * n; ++i) {
      sizes_[i] = of_.size_of(i / 2, size(mass), size(friction), std::abs(stiffness));
    }
    std::vector<RankOne> terms;
    for (const RankOne& term : of_.terms_) {
      for (std::size_t part = 0; part < 2; ++part) {
        RankOne doubled{std::vector<double>(2 * n, 0.0), stiffness * term.weight};
        for (std::size_t i = 0; i < n; ++i) doubled.direction[2 * i + part] = term.direction[i];
        terms.push_back(std::move(doubled));
      }
    }
    return factors_.factor(matrix_, terms, sizes_);
  }

  void solve(double* real, double* imaginary) const override {
    const std::size_t n = both_.size() / 2;
    for (std::size_t i = 0; i < n; ++i) {
      both_[2 * i] = real[i];
      both_[2 * i + 1] = imaginary[i];
    }
    factors_.solve(both_.data());
    for (std::size_t i = 0; i < n; ++i) {
      real[i] = both_[2 * i];
      imaginary[i] = both_[2 * i + 1];
    }
  }

 private:
  static double size(std::complex<double> x) { return std::abs(x.real()) + std::abs(x.imag()); }

  const ForceTangent& of_;
  BandMatrix matrix_;
  std::vector<double> sizes_;
  BorderedFactors factors_;
  mutable std::vector<double> both_;
};

std::unique_ptr<ShiftedTangent> ForceTangent::shifted() const {
  return std::make_unique<Shifted>(*this);
}

}  // namespace tomlin
