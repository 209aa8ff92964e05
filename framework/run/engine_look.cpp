#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/run/bond_watch.hpp"
#include "framework/run/engine.hpp"
#include "framework/run/engine_parts.hpp"
#include "framework/run/prescribed_inertia.hpp"

/// What a run looks at along the way: signals that extremes are taken of, samples, the edges of the
/// window, rotations.
namespace tomlin {

using namespace engine_parts;  // NOLINT: its own parts

namespace {

/// A flexible body that would turn more than this between looks is looked at after every step.
constexpr double kMuchTurning = 0.05;
/// An extreme of a cubic is looked at on the dense output where it comes as near to the largest so
/// far, in parts of what the signal changes by in the step: the cubic may be off by that.
constexpr double kNear = 0.1;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Of one very long step, before a signal is heard.
constexpr std::uint64_t kSamplesBetweenLooks = 100'000;

/// "position 8, clock 2, ...": numbers mean something only where the same fields are kept.
std::string fields_of(const StateLayout& layout) {
  std::string fields;
  for (const auto* group : {&layout.reals(), &layout.integers(), &layout.raw()}) {
    for (const StateLayout::Field& field : *group) {
      fields += fmt::format("{}{} {}", fields.empty() ? "" : ", ", field.name, field.count);
    }
  }
  return fields;
}

/// The value of a function of [0, 1] at its extreme near theta: the vertex of the parabola through
/// three points, and of one through three nearer ones.
template <class Function>
double extreme_near(double theta, Function function) {
  constexpr double kFirst = 1.0 / 12.0;
  constexpr double kNearer = 0.25;
  constexpr int kPasses = 2;
  double reach = kFirst;
  for (int pass = 0; pass < kPasses; ++pass, reach *= kNearer) {
    const double middle = std::clamp(theta, reach, 1.0 - reach);
    const double before = function(middle - reach);
    const double here = function(middle);
    const double after = function(middle + reach);
    const double bend = after - 2.0 * here + before;
    if (bend == 0.0) break;
    theta = middle - std::clamp(0.5 * (after - before) / bend, -1.0, 1.0) * reach;
  }
  return function(theta);
}

}  // namespace

void Engine::list_signals() {
  for (const Model::Driver& driver : model_.drivers()) {
    drivers_.push_back(driver);
    const Drive* drive = driver.drive;
    direction_.insert(direction_.end(), drive->velocity.begin(), drive->velocity.end());
    speed_.push_back(norm(drive->velocity));
    along_.push_back(1.0 / speed_.back());
  }
  signal_count_ = drivers_.size() * model_.dimension() + model_.bodies().size();
  signals_.assign(signal_count_, 0.0);
  for (std::vector<double>& signals : between_) signals.assign(signal_count_, 0.0);
  pulls_.assign(drivers_.size(), 0.0);
  before_slip_ = std::make_unique<bool[]>(drivers_.size());
}

/// Columns of the table, and whose positions come with them.
RunLayout Engine::layout() const {
  RunLayout layout;
  layout.dimension = model_.dimension();
  layout.box = scene_->box.lengths;
  layout.periodic = scene_->box.periodic;
  layout.events =
      path_ != nullptr || !driver_watches_.empty() || !body_watches_.empty() || !triggers_.empty();
  layout.state = fields_of(state_.layout());
  layout.state_bytes = state_.to_bytes().size();
  if (scene_->output.every) {
    // The last may miss the end of the run by rounding, and comes nevertheless.
    constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();
    const double intervals = plan_.duration / *scene_->output.every;
    layout.most_samples = std::floor(intervals * (1.0 + kRounding) + kNoStep) + 1.0;
    static const char* const axes[] = {"x", "y", "z"};
    std::vector<SampleColumn>& columns = layout.columns;
    const auto per_axis = [&](const std::string& name, const char* unit) {
      for (int d = 0; d < model_.dimension(); ++d) columns.push_back({name + "." + axes[d], unit});
    };
    columns.push_back({"time", "time"});
    for (const auto& driver : drivers_) per_axis(driver.name + ".force", "force");
    for (const auto& driver : drivers_) {
      if (driver.drive->steady) per_axis(driver.name + ".position", "length");
    }
    for (const Model::Body& body : model_.bodies()) {
      per_axis(body.bound.name + ".centre_of_mass", "length");
      per_axis(body.bound.name + ".velocity", "length/time");
      if (body.rotates()) columns.push_back({body.bound.name + ".rotation", "rad"});
    }
    list_observed(columns);
    if (scene_->output.trajectory) {
      for (const Model::Body& body : model_.bodies()) {
        layout.bodies.push_back({body.bound.name, body.bound.mass});
      }
    }
  }
  return layout;
}

void Engine::begin_sink() {
  sink_has_begun_ = true;
  if (options_.sink == nullptr && !sampling_) return;
  RunLayout given = layout();
  if (!sampling_) {
    given.columns.clear();
    given.bodies.clear();
    given.most_samples = 0.0;
  }
  sample_values_.assign(given.row(), 0.0);
  if (options_.sink != nullptr) options_.sink->begin(given);
}

void Engine::observe_start() {
  const SystemView<double>& view = model_.system().view;
  if (sampling_) {
    sample(0.0, view.position, view.velocity, view.integrals);
    counts_[kNextSample] = 1;
  }
  if (from_.time == 0.0) {
    keep_moment(from_, 0.0, view.position, view.velocity, view.integrals);
  }
}

double Engine::next_dense() const {
  double next = std::numeric_limits<double>::infinity();
  if (sampling_) {
    const double at = static_cast<double>(counts_[kNextSample]) * *scene_->output.every;
    // The last sample may miss the end of the run by rounding.
    next = std::abs(at - plan_.duration) <= kNoStep * *scene_->output.every ? plan_.duration : at;
  }
  if (*from_.reached == 0) return std::min(next, from_.time);
  return *to_.reached != 0 ? next : std::min(next, to_.time);
}

/// Long steps hide extremes: those of the cubic through the dense output at thirds of the step are
/// as good as the dense output. signals_ holds the values at its start. False: no dense rates.
bool Engine::look_between(double from, double to) {
  between_[0] = signals_;
  for (int k = 1; k <= 3; ++k) {
    if (!integrator_->between(k / 3.0, dense_velocity_.data(), dense_rates_.data())) return false;
    signals_from_rates(dense_rates_.data());
    signals_from_velocity(dense_velocity_.data(), from + (to - from) * k / 3.0);
    between_[k] = signals_;
  }
  if (!body_watches_.empty()) {
    read_bodies(model_.system().view.position, model_.system().view.velocity, end_readings_);
  }
  note_slipping();
  for (int k = 0; k < 3; ++k) {
    interpolate_readings(k / 3.0, to - from);
    watch(from + (to - from) * k / 3.0, between_[k].data(), between_readings_);
  }
  between_from_ = from;
  between_length_ = to - from;
  include_cubics(from, to);
  return true;
}

/// All signals at a part of the last step, on its dense output.
void Engine::signals_within(double theta) {
  integrator_->between(theta, dense_velocity_.data(), dense_rates_.data());
  signals_from_rates(dense_rates_.data());
  signals_from_velocity(dense_velocity_.data(), between_from_ + between_length_ * theta);
}

/// The cubic says where an extreme is, the dense output how large: the cubic is coarser than it
/// where steps are long. As the cubic has it, where there is no dense output, and nothing that
/// would be larger than the largest so far.
double Engine::refined(std::size_t signal, double theta, double value, bool maximum) {
  if (between_length_ == 0.0) return value;
  const auto [low, high] = std::minmax(
      {between_[0][signal], between_[1][signal], between_[2][signal], between_[3][signal]});
  const double near = kNear * (high - low);
  if (extremes_.any(signal)) {
    if (maximum && value + near < extremes_.high(signal)) return value;
    if (!maximum && value - near > extremes_.low(signal)) return value;
  }
  return extreme_near(theta, [&](double part) {
    signals_within(part);
    return signals_[signal];
  });
}

/// What a driver holds while what it pulls slips is no static force; of a step in which a slip
/// begins the maximum before it counts.
void Engine::note_slipping() {
  std::fill_n(before_slip_.get(), drivers_.size(), true);
  for (const DriverWatch& watch : driver_watches_) {
    before_slip_[watch.driver()] = !watch.slipping();
  }
}

/// A maximum of the pull that a cubic has, for the static force; refined as extremes are.
void Engine::include_pull(std::size_t driver, double theta, double value) {
  if (!static_forces_.open(driver) || !before_slip_[driver]) return;
  double low = kInfinity;
  double high = -kInfinity;
  for (const std::vector<double>& signals : between_) {
    const double pull = pull_of(driver, signals.data());
    low = std::min(low, pull);
    high = std::max(high, pull);
  }
  if (between_length_ > 0.0 && value + kNear * (high - low) >= static_forces_.value(driver)) {
    value = extreme_near(theta, [&](double part) {
      signals_within(part);
      return pull_of(driver, signals_.data());
    });
  }
  static_forces_.include(driver, value);
}

/// Extremes of the cubics through the signals at the ends and at thirds of [from, to].
void Engine::include_cubics(double from, double to) {
  // Of a step across an edge of the window only what lies within counts.
  const auto inside = [&](double theta) {
    const double at = from + (to - from) * theta;
    return at >= from_.time && at <= to_.time;
  };
  if (to > from_.time && from < to_.time) {
    for (const int k : {0, 3}) {
      if (inside(k / 3.0)) extremes_.include(between_[k].data());
    }
    for (std::size_t s = 0; s < signal_count_; ++s) {
      const CubicExtremes found =
          cubic_extremes(between_[0][s], between_[1][s], between_[2][s], between_[3][s]);
      for (int e = 0; e < found.count; ++e) {
        if (!inside(found.place[e])) continue;
        extremes_.include(s, refined(s, found.place[e], found.value[e], found.is_maximum[e]));
      }
    }
  }
  if (!static_forces_.any_open() && path_ == nullptr) return;
  for (std::size_t k = 0; k < drivers_.size(); ++k) {
    if (before_slip_[k]) {
      for (const int end : {0, 3}) static_forces_.include(k, pull_of(k, between_[end].data()));
    }
    const CubicExtremes found =
        cubic_extremes(pull_of(k, between_[0].data()), pull_of(k, between_[1].data()),
                       pull_of(k, between_[2].data()), pull_of(k, between_[3].data()));
    for (int e = 0; e < found.count; ++e) {
      if (found.is_maximum[e]) include_pull(k, found.place[e], found.value[e]);
      if (path_ != nullptr) see_pull(k, found.value[e]);
    }
  }
}

/// Extremes see the values at the start of a step.
void Engine::look(double at) {
  if (static_forces_.any_open()) note_slipping();
  watch(at, signals_.data(), readings_);
  extremes_.add(at, signals_.data(), at >= from_.time && at <= to_.time);
  if (!static_forces_.any_open()) return;
  for (std::size_t k = 0; k < drivers_.size(); ++k) pulls_[k] = pull_of(k, signals_.data());
  static_forces_.add(at, pulls_.data(), before_slip_.get());
}

/// Driver forces.
void Engine::signals_from_rates(const double* rates) {
  const int axes = model_.dimension();
  for (std::size_t k = 0; k < drivers_.size(); ++k) {
    const double* force = rates + drivers_[k].first_rate;
    for (int d = 0; d < axes; ++d) signals_[k * axes + d] = force[d];
  }
}

/// Speeds of centres.
void Engine::signals_from_velocity(const double* velocity, double at) {
  const int axes = model_.dimension();
  double* speed = signals_.data() + drivers_.size() * axes;
  for (const Model::Body& body : model_.bodies()) {
    const BodySlot<double>& slot = body.bound.slot;
    double v[3] = {0.0, 0.0, 0.0};
    if (slot.rigid) {
      for (int d = 0; d < axes; ++d) v[d] = velocity[slot.centre + d];
    } else if (body.prescribed()) {
      for (int d = 0; d < axes; ++d) v[d] = body.motion->velocity[d](at);
    } else if (slot.count == 1 && !slot.mapped) {
      for (int d = 0; d < axes; ++d) v[d] = velocity[slot.offset + d * slot.stride];
    } else if (!slot.mapped) {
      observe_.mean(slot, velocity, axes, v);
    }
    double square = 0.0;
    for (int d = 0; d < axes; ++d) square += v[d] * v[d];
    *speed++ = std::sqrt(square);
  }
}

void Engine::serve_dense(double due, const DoubleDouble& from, const DoubleDouble& to,
                         double next_since) {
  // The end of the step itself needs no interpolation, and so no evaluation.
  if (due < static_cast<double>(to)) integrator_->finish_dense_from(next_since);
  const double length = static_cast<double>(to - from);
  std::uint64_t served = 0;
  for (double at = due; at <= static_cast<double>(to); at = next_dense()) {
    // A signal gets through between samples of a very long step, which is then left unfinished.
    if (++served % kSamplesBetweenLooks == 0 && stopped()) {
      within_step_ = true;
      return;
    }
    if (plan_.dt > 0.0 && at == static_cast<double>(to)) {
      const SystemView<double>& view = model_.system().view;
      serve_point(at, view.position, view.velocity, view.integrals);
      continue;
    }
    const double theta =
        std::clamp(static_cast<double>(DoubleDouble(at) - from) / length, 0.0, 1.0);
    integrator_->interpolate(theta, dense_position_.data(), dense_velocity_.data(),
                             dense_integrals_.data());
    serve_point(at, dense_position_.data(), dense_velocity_.data(), dense_integrals_.data());
  }
}

void Engine::serve_point(double at, const double* x, const double* v, const double* z) {
  if (*from_.reached == 0 && at >= from_.time) keep_moment(from_, at, x, v, z);
  if (*from_.reached != 0 && *to_.reached == 0 && at >= to_.time) {
    keep_moment(to_, at, x, v, z);
    period_over_ = plan_.period > 0.0;
  }
  if (sampling_ &&
      static_cast<double>(counts_[kNextSample]) * *scene_->output.every <= at * (1.0 + kNoStep)) {
    sample(at, x, v, z);
    ++counts_[kNextSample];
  }
}

void Engine::sample(double at, const double* position, const double* velocity,
                    const double* integrals) {
  model_.evaluate_at(DoubleDouble(at), position, velocity, integrals, dense_rates_.data());
  std::size_t column = 0;
  const int axes = model_.dimension();
  sample_values_[column++] = at;
  for (const auto& driver : drivers_) {
    for (int d = 0; d < axes; ++d) sample_values_[column++] = dense_rates_[driver.first_rate + d];
  }
  for (std::size_t k = 0; k < drivers_.size(); ++k) {
    if (!drivers_[k].drive->steady) continue;
    for (int d = 0; d < axes; ++d) {
      sample_values_[column++] = static_cast<double>(model_.pulled_end(k, DoubleDouble(at), d));
    }
  }
  for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
    double numbers[3];
    model_.centre(b, position, numbers);
    for (int d = 0; d < axes; ++d) {
      sample_values_[column++] = static_cast<double>(model_.placed(d, numbers[d]));
    }
    model_.centre_velocity(b, velocity, numbers);
    for (int d = 0; d < axes; ++d) sample_values_[column++] = numbers[d];
    if (model_.bodies()[b].rotates()) sample_values_[column++] = kTau * turns_of(b, position);
  }
  if (!watchers_.empty()) {
    double* numbers = sample_values_.data() + column;
    column += observe(at, position, velocity, numbers);
    if (!are_finite(numbers)) return;
    keep_means(at, numbers);
  }
  if (scene_->output.trajectory) {
    for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
      column = model_.place_particles(b, position, sample_values_.data() + column) -
               sample_values_.data();
    }
  }
  if (options_.sink != nullptr) options_.sink->sample(sample_values_);
}

void Engine::keep_moment(Moment& moment, double at, const double* position, const double* velocity,
                         const double* integrals) {
  *moment.reached = 1;
  model_.evaluate_at(DoubleDouble(at), position, velocity, integrals, dense_rates_.data());
  if (long_bonds_ != nullptr) {
    note_long_bonds(
        model_,
        stage_of(model_.system().view, position, velocity, integrals, dense_rates_.data(), 0.0),
        long_bonds_);
  }
  std::copy(integrals, integrals + model_.system().view.rates, moment.integrals);
  const int axes = model_.dimension();
  for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
    double centre[3];
    model_.centre(b, position, centre);
    for (int d = 0; d < axes; ++d) {
      const DoubleDouble place = model_.placed(d, centre[d]);
      moment.centre[2 * (b * axes + d)] = place.hi;
      moment.centre[2 * (b * axes + d) + 1] = place.lo;
    }
    moment.turns[b] = turns_of(b, position);
  }
  if (ledger_) {
    *moment.stored = model_.kinetic_energy(velocity) + prescribed_kinetic_energy(model_, at) +
                     model_.potential_energy(DoubleDouble(at), position, velocity, integrals);
  }
  // The signals of the step's start have been used; this is scratch until the next.
  signals_from_rates(dense_rates_.data());
  signals_from_velocity(velocity, at);
  extremes_.include(signals_.data());
}

double Engine::turns_of(std::size_t b, const double* position) const {
  const double turns = model_.rotation(b, position);
  const Model::Body& body = model_.bodies()[b];
  if (body.bound.slot.mapped || !body.rotates()) return turns;
  const double unwrapped = turns + static_cast<double>(turn_wraps_[b]);
  return unwrapped - std::nearbyint(unwrapped - last_turns_[b]);
}

/// Flexible bodies have no rotation coordinate: whole turns are counted by looking often enough.
void Engine::track_rotation() {
  const std::int64_t looked = counts_[kRotationEvery];
  counts_[kRotationEvery] = kHousekeepingEvery;
  for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
    const Model::Body& body = model_.bodies()[b];
    if (body.bound.slot.mapped || !body.rotates()) continue;
    const double turns = model_.rotation(b, model_.system().view.position);
    const double change = turns + static_cast<double>(turn_wraps_[b]) - last_turns_[b];
    const double wraps = std::nearbyint(change);
    turn_wraps_[b] -= static_cast<std::int64_t>(wraps);
    last_turns_[b] = turns + static_cast<double>(turn_wraps_[b]);
    for (BodyWatch& watch : body_watches_) {
      if (watch.body() != b) continue;
      event_name_ = body.bound.name;
      watch.add_turns(time(), last_turns_[b], emit_);
    }
    const double a_step = std::abs(change - wraps) / static_cast<double>(looked);
    if (a_step * kHousekeepingEvery > kMuchTurning) counts_[kRotationEvery] = 1;
  }
}

}  // namespace tomlin
