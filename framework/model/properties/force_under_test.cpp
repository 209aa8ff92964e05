#include "framework/model/properties/force_under_test.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "framework/core/numbers/constants.hpp"

namespace tomlin {

std::string PropertyPoint::text() const {
  std::string where = body.empty() ? "all coordinates together" : body;
  if (particle >= 0) where += fmt::format(", particle {}", particle);
  if (!coordinate.empty()) where += ", " + coordinate;
  if (!position.empty()) {
    where += " at (";
    for (std::size_t d = 0; d < position.size(); ++d) {
      where += fmt::format("{}{:.10g}", d == 0 ? "" : ", ", position[d]);
    }
    where += ")";
  }
  return fmt::format("{}, {}, time {:.6g}: {:.17g} where {:.17g} is expected", where, state, time,
                     found, expected);
}

}  // namespace tomlin

namespace tomlin::properties {
namespace {

/// Displacements, in parts of the shortest length: springs stay far from turning over.
constexpr double kDisplacement = 0.1;
/// Displacements of extreme states in the same parts: far away, high above, almost touching.
constexpr double kFar[] = {1e3, 1e6};
constexpr double kHigh[] = {3.0, 10.0, 30.0};
constexpr double kTouching[] = {1e-3, 1e-6};
/// Change of the rates of own variables, in parts of the largest, by which they are others; and the
/// shortest part of a unit of time.
constexpr double kRateChange = 2.0;
constexpr double kShortestTime = 0x1p-60;
/// Pairs and particles beyond which few states are looked at, and none in quadruple precision,
/// where it would take minutes.
constexpr double kManyTerms = 2e3;
constexpr double kMostTermsInQuadruple = 2e5;

std::uint64_t pairs_of(const Scene& scene, const SceneForce& force) {
  SceneOutline outline;
  outline.dimension = scene.dimension;
  for (const std::size_t b : force.bodies) {
    const SceneBody& body = scene.bodies[b];
    const auto geometry = body.record->build(body.description.get(), scene.dimension);
    outline.bodies.push_back({body.name, static_cast<std::int64_t>(geometry.relative.size()), true,
                              neighbour_list(*body.record, body.description, {})});
  }
  return force.record->pairs(force.description.get(), outline);
}

/// Bits, but for the sign of a zero and NaN.
bool is_same(double found, double expected) {
  return found == expected || (std::isnan(found) && std::isnan(expected));
}

}  // namespace

std::vector<InstructionSet> supported_sets() {
  std::vector<InstructionSet> sets;
  for (const InstructionSet set :
       {InstructionSet::baseline, InstructionSet::avx2, InstructionSet::avx512}) {
    if (is_supported(set)) sets.push_back(set);
  }
  return sets;
}

const char* name_of(StateKind kind) {
  static constexpr const char* kNames[] = {"at the start", "near the start", "far away",
                                           "high above", "almost touching"};
  return kNames[static_cast<int>(kind)];
}

ForceUnderTest::ForceUnderTest(const Scene& scene, std::size_t force, double length,
                               const PropertyOptions& options)
    : alone_(scene, force), length_(length), options_(options) {
  if (!worthwhile()) return;
  size_ = static_cast<double>(count() + pairs_of(scene, scene.forces[force]));
  latest_ = latest_time();
  list_hidden();
  if (!hidden_.empty()) {
    by_terms_ = std::make_unique<ForceTwin<double>>(alone_.model().plan());
    passes_ = by_terms_->force().bound->passes();
  }
  make_states();
}

void ForceUnderTest::list_hidden() {
  const SystemView<double>& view = alone_.model().system().view;
  for (const std::size_t b : alone_.force().bodies) {
    const Model::Body& body = alone_.model().bodies()[b];
    const BodySlot<double>& slot = body.bound.slot;
    for (std::size_t d = 0; d < static_cast<std::size_t>(alone_.model().dimension()); ++d) {
      const bool centre_held = slot.rigid && view.inverse_mass[slot.centre + d] == 0.0;
      if (centre_held) hidden_.push_back({b, false, {slot.centre + d}});
      Hidden hidden{b, slot.mapped, {}};
      for (std::size_t i = 0; i < slot.count; ++i) {
        const std::size_t at = slot.offset + d * slot.stride + i;
        if (!slot.mapped && view.inverse_mass[at] > 0.0) continue;
        hidden.at.push_back(at);
        if (slot.rigid && !centre_held) continue;  // its centre is a variable
        hidden_reach_ = std::max(hidden_reach_, std::abs(body.bound.start[i][d]));
      }
      if (!hidden.at.empty()) hidden_.push_back(std::move(hidden));
    }
  }
}

/// Drivers are looked at while they are about a length away from their start.
double ForceUnderTest::latest_time() {
  double latest = alone_.model().scene().run.duration;
  if (const Drive* drive = force().driving->drive()) {
    for (const double velocity : drive->velocity) {
      if (velocity != 0.0) latest = std::min(latest, length_ / std::abs(velocity));
    }
  }
  return latest;
}

bool ForceUnderTest::on_prescribed() const {
  const auto& bodies = alone_.force().bodies;
  return std::any_of(bodies.begin(), bodies.end(),
                     [&](std::size_t b) { return alone_.model().bodies()[b].prescribed(); });
}

// ---- states

void ForceUnderTest::make_states() {
  Random random(options_.seed);
  alone_.restart();
  start_.kind = StateKind::start;
  for (const Variable& variable : alone_.variables()) {
    start_.x.push_back(alone_.position(variable));
    start_.v.push_back(alone_.velocity(variable));
  }
  start_.own.assign(alone_.own(), alone_.own() + alone_.own_count());
  for (int k = 0; k < options_.displaced_states; ++k) near_.push_back(displaced(1.0, random));
  near_.push_back(start_);

  const int axes = alone_.model().dimension();
  const auto shift = [&](State& state, int axis, double by) {
    for (std::size_t i = 0; i < count(); ++i) {
      if (variable(i).axis == axis) state.x[i] += by;
    }
  };
  for (const double far : kFar) {
    State together = displaced(1.0, random);
    together.kind = StateKind::far;
    for (int axis = 0; axis < axes; ++axis) {
      const double way = random.symmetric();
      shift(together, axis, length_ * (way < 0.0 ? -far : far) * (1.0 + 0.5 * way));
    }
    extreme_.push_back(std::move(together));
    State apart = displaced(1.0, random);
    apart.kind = StateKind::far;
    for (std::size_t i = 0; i < count(); ++i) {
      if (variable(i).axis >= 0) apart.x[i] += far * length_ * random.symmetric();
    }
    extreme_.push_back(std::move(apart));
  }
  for (const double height : kHigh) {
    if (axes < 2) break;
    State high = displaced(1.0, random);
    high.kind = StateKind::high;
    shift(high, 1, height * length_);
    extreme_.push_back(std::move(high));
  }
  for (const double distance : kTouching) {
    if (auto state = touching(distance, random)) extreme_.push_back(std::move(*state));
  }
  // Own variables near what they come to within a unit of time, or until their rates are others.
  for (auto* states : {&near_, &extreme_}) {
    for (State& state : *states) {
      if (state.own.empty() || state.kind == StateKind::start) continue;
      put(state);
      alone_.forces(state.time);
      const std::vector<double> rates(alone_.rates(), alone_.rates() + state.own.size());
      const std::vector<double> start = state.own;
      std::vector<double> parts;
      for (std::size_t k = 0; k < start.size(); ++k) {
        parts.push_back(0.5 * (1.0 + random.symmetric()) * rates[k]);
      }
      for (double time = 1.0; time > kShortestTime; time *= 0.5) {
        for (std::size_t k = 0; k < start.size(); ++k) state.own[k] = start[k] + time * parts[k];
        put(state);
        alone_.forces(state.time);
        double size = 0.0;
        double change = 0.0;
        for (std::size_t k = 0; k < start.size(); ++k) {
          size = std::max(size, std::abs(rates[k]));
          change = std::max(change, std::abs(alone_.rates()[k] - rates[k]));
        }
        if (change <= kRateChange * size) break;
      }
    }
  }
  alone_.restart();
}

State ForceUnderTest::displaced(double size, Random& random) const {
  State state = start_;
  state.kind = StateKind::near;
  for (std::size_t i = 0; i < count(); ++i) {
    const double unit = variable(i).unit * length_;
    state.x[i] += size * kDisplacement * unit * random.symmetric();
    state.v[i] = unit * random.symmetric();
  }
  state.time = 0.5 * (1.0 + random.symmetric()) * latest_;
  return state;
}

/// Two free particles that the force acts on, one brought close to the other; nothing where there
/// are not two.
std::optional<State> ForceUnderTest::touching(double distance, Random& random) const {
  const Model& model = alone_.model();
  struct Particle {
    std::size_t body, index;
  };
  std::vector<Particle> particles;
  for (const std::size_t b : alone_.force().bodies) {
    const auto& slot = model.bodies()[b].bound.slot;
    for (std::size_t i = 0; !slot.mapped && i < slot.count; ++i) particles.push_back({b, i});
  }
  if (particles.size() < 2) return std::nullopt;
  const std::size_t one = random.below(particles.size() - 1);
  State state = displaced(1.0, random);
  state.kind = StateKind::contact;
  double way[3] = {};
  double norm = 0.0;
  for (int d = 0; d < model.dimension(); ++d) {
    way[d] = random.symmetric();
    norm += way[d] * way[d];
  }
  for (int d = 0; d < model.dimension(); ++d) {
    const auto at = [&](const Particle& particle) {
      const auto& slot = model.bodies()[particle.body].bound.slot;
      return slot.offset + d * slot.stride + particle.index;
    };
    const auto find = [&](std::size_t coordinate) {
      std::size_t i = 0;
      while (i < count() && variable(i).at != coordinate) ++i;
      return i;
    };
    const std::size_t from = find(at(particles[one]));
    const std::size_t to = find(at(particles[one + 1]));
    if (from == count() || to == count()) return std::nullopt;  // held
    state.x[to] = state.x[from] + distance * length_ * way[d] / std::sqrt(norm);
  }
  return state;
}

bool ForceUnderTest::takes_long() const { return size_ > kManyTerms; }

std::vector<const State*> ForceUnderTest::everywhere() const {
  std::vector<const State*> states;
  const bool few = takes_long();
  for (std::size_t k = few && near_.size() > 1 ? near_.size() - 2 : 0; k < near_.size(); ++k) {
    states.push_back(&near_[k]);
  }
  for (const State& state : extreme_) {
    const auto known = [&](const State* other) { return other->kind == state.kind; };
    if (few && std::any_of(states.begin(), states.end(), known)) continue;
    states.push_back(&state);
  }
  return states;
}

void ForceUnderTest::put(const State& state) {
  for (std::size_t i = 0; i < count(); ++i) {
    alone_.position(variable(i)) = state.x[i];
    alone_.velocity(variable(i)) = state.v[i];
  }
  std::copy(state.own.begin(), state.own.end(), alone_.own());
}

void ForceUnderTest::put_moved(const State& state, const Direction& direction, double h) {
  for (std::size_t i = 0; i < count(); ++i) {
    alone_.position(variable(i)) = state.x[i] + h * direction[i];
  }
}

std::vector<double> ForceUnderTest::forces(const State& state) {
  put(state);
  const double* all = alone_.forces(state.time);
  std::vector<double> forces(count());
  for (std::size_t i = 0; i < count(); ++i) forces[i] = all[variable(i).at];
  return forces;
}

double ForceUnderTest::largest(const std::vector<double>& forces) const {
  double most = 0.0;
  for (std::size_t i = 0; i < count(); ++i) {
    const double size = std::abs(at_edge(i, forces[i]));
    if (!(size <= most)) most = size;  // also for NaN
    if (std::isnan(most)) return most;
  }
  return most;
}

Direction ForceUnderTest::random_direction(Random& random) const {
  Direction direction(count());
  for (std::size_t i = 0; i < count(); ++i) direction[i] = variable(i).unit * random.symmetric();
  return direction;
}

Direction ForceUnderTest::along(std::size_t i) const {
  Direction direction(count(), 0.0);
  direction[i] = variable(i).unit;
  return direction;
}

double ForceUnderTest::reach(const State& state) const {
  double reach = std::max(length_, hidden_reach_);
  for (std::size_t i = 0; i < count(); ++i) {
    if (variable(i).axis >= 0) {
      reach = std::max(reach, std::abs(state.x[i]));
    } else {
      reach = std::max(reach, 1.0 / (kTau * variable(i).unit));
    }
  }
  return reach;
}

// ---- the same force otherwise

ForceTwin<double>& ForceUnderTest::twin(const AssemblyPlan& plan) {
  auto& twin = memory_.twins[plan.set];
  if (twin == nullptr) twin = std::make_unique<ForceTwin<double>>(plan);
  return *twin;
}

ForceTwin<double>& ForceUnderTest::twin(InstructionSet set) {
  AssemblyPlan plan = alone_.model().plan();
  plan.set = set;
  return twin(plan);
}

ForceTwin<Quad>* ForceUnderTest::exact() {
  if (!sought_exact_ && record().bind.in_quadruple != nullptr && size_ <= kMostTermsInQuadruple) {
    exact_ = std::make_unique<ForceTwin<Quad>>(alone_.model().plan());
  }
  sought_exact_ = true;
  return exact_.get();
}

// ---- the answer

std::vector<const State*> ForceUnderTest::states_of(Property::States which) const {
  if (which == Property::States::everywhere) return everywhere();
  std::vector<const State*> states;
  for (const State& state : near_) states.push_back(&state);
  if (which == Property::States::backwards) std::reverse(states.begin(), states.end());
  if (which == Property::States::three) {
    states = {&near_[0], &near_[1 % near_.size()], &near_[2 % near_.size()]};
  }
  return states;
}

std::optional<PropertyResult> ForceUnderTest::check(const Property& property) {
  const Model::Force& force = alone_.force();
  now_ = {force.name, force.record->name, property.name, property.meaning, true, 0.0, 0.0, 0, {}};
  strain_ = -1.0;
  memory_ = {Random(options_.seed), 0.0, false, {}, {}};
  withdrawn_ = false;
  if (!property.applies(*this)) return std::nullopt;
  if (property.prepare == nullptr || property.prepare(*this)) {
    for (const State* state : states_of(property.states)) {
      if (property.compare(*this, *state)) ++now_.states;
      if (withdrawn_) return std::nullopt;
    }
  }
  alone_.restart();
  return now_;
}

bool ForceUnderTest::withdraw() {
  withdrawn_ = true;
  return false;
}

bool ForceUnderTest::note_shown(bool shown, const State& state) {
  if (shown) note(0.0, 0.0, 0.0, 0.0, state);
  return shown;
}

void ForceUnderTest::contradict(double found, double expected) {
  ++now_.states;
  note(found, expected, 1.0, -1.0, start_);
}

void ForceUnderTest::note(double found, double expected, double size, double allowed,
                          const State& state, std::size_t variable) {
  const double difference = found == expected ? 0.0 : std::abs(found - expected);
  const bool holds = difference <= allowed;  // false for NaN
  const double strain = difference == 0.0 ? 0.0
                        : holds || (difference > allowed && allowed > 0.0)
                            ? difference / allowed
                            : std::numeric_limits<double>::infinity();
  now_.holds = now_.holds && holds;
  if (strain < strain_ || (strain == strain_ && strain_ > 0.0)) return;
  strain_ = strain;
  now_.error = size > 0.0 ? difference / size : difference;
  now_.allowed = size > 0.0 ? std::max(allowed, 0.0) / size : 0.0;
  now_.worst = point(state, variable);
  now_.worst.found = found;
  now_.worst.expected = expected;
}

void ForceUnderTest::note(const std::vector<double>& found, const std::vector<double>& expected,
                          double size, double allowed, const State& state) {
  std::size_t worst = 0;
  double most = -1.0;
  for (std::size_t i = 0; i < count(); ++i) {
    const double difference = std::abs(at_edge(i, found[i]) - at_edge(i, expected[i]));
    if (difference <= most) continue;
    worst = i;
    most = difference;
    if (std::isnan(most)) break;
  }
  note(at_edge(worst, found[worst]), at_edge(worst, expected[worst]), size, allowed, state, worst);
}

void ForceUnderTest::note_same(double found, double expected, const State& state) {
  if (is_same(found, expected)) return note(0.0, 0.0, 0.0, 0.0, state);
  note(found, expected, std::abs(expected), -1.0, state);
}

void ForceUnderTest::note_same_numbers(const std::vector<double>& found,
                                       const std::vector<double>& expected, const State& state) {
  std::size_t k = 0;
  while (k < expected.size() && is_same(found[k], expected[k])) ++k;
  if (k < expected.size()) return note_same(found[k], expected[k], state);
  note(0.0, 0.0, 0.0, 0.0, state);
}

void ForceUnderTest::note_same(const std::vector<double>& found,
                               const std::vector<double>& expected, const State& state) {
  for (std::size_t i = 0; i < count(); ++i) {
    const bool both_none = std::isnan(found[i]) && std::isnan(expected[i]);
    const bool same =
        std::bit_cast<std::uint64_t>(found[i]) == std::bit_cast<std::uint64_t>(expected[i]);
    if (same || both_none) continue;
    return note(found[i], expected[i], std::abs(expected[i]), -1.0, state, i);
  }
  note(0.0, 0.0, 0.0, 0.0, state);
}

PropertyPoint ForceUnderTest::point(const State& state, std::size_t chosen) const {
  PropertyPoint point;
  point.state = name_of(state.kind);
  point.time = state.time;
  if (chosen == kNone) return point;
  const Model& model = alone_.model();
  const auto name = model.name_of(variable(chosen).at);
  point.body = name.body;
  point.particle = name.particle;
  point.coordinate = name.axis;
  for (std::size_t i = 0; i < count(); ++i) {
    if (variable(i).body != variable(chosen).body || variable(i).axis < 0) continue;
    if (model.name_of(variable(i).at).particle == name.particle)
      point.position.push_back(state.x[i]);
  }
  return point;
}

}  // namespace tomlin::properties
