#include "integrators/modal_flow.hpp"

#include <algorithm>
#include <cmath>

#include "framework/core/numbers/math.hpp"
#include "framework/core/numbers/power_of_two.hpp"

namespace tomlin {
namespace {

/// Part of the forces on a body that the filter of kicks may lose: a result's error is about that.
constexpr double kLostForce = 0.01;
/// Rounding of forces between particles of a body, in units of its stiffest mode's at its size.
constexpr double kForceRounding = 1e-14;
/// Parts of the largest squared frequency: blocks below it are none.
constexpr double kNoSpring = 1e-9;

void sine_cosine(double angle, double& sine, double& cosine) {
  sincos_turns(angle / tau<double>(), sine, cosine);
}

/// (1 - exp(-x))/x.
double decayed(double x) {
  if (x < 0.35) {
    double sum = 1.0;
    for (int n = 16; n >= 2; --n) sum = fma(-x / n, sum, 1.0);
    return sum;
  }
  return (1.0 - exp(-x)) / x;
}

/// (x - 1 + exp(-x))/x^2, half of it at 0.
double delayed(double x) {
  if (x < 0.35) {
    double sum = 1.0;
    for (int n = 17; n >= 3; --n) sum = fma(-x / n, sum, 1.0);
    return 0.5 * sum;
  }
  return (1.0 - decayed(x)) / x;
}

/// The integral of (1 - exp(-y))^2 over y from 0 to x, over x^3.
double squared_rise(double x) {
  if (x < 0.5) {
    // The terms (-x)^n (2^(n+2) - 2)/(n + 3)!.
    double sum = 0.0;
    double power = 1.0 / 6.0;
    double two = 4.0;
    for (int n = 0; n < 20; ++n) {
      sum = fma(power, two - 2.0, sum);
      power *= -x / (n + 4);
      two *= 2.0;
    }
    return sum;
  }
  return (1.0 - 2.0 * decayed(x) + decayed(2.0 * x)) / (x * x);
}

/// Displacement from rest by a steady unit force, of a slow and little damped mode: the Taylor
/// series.
double pushed_a_little(double square, double rate, double h) {
  const double damped = rate * h;
  const double turned = square * h * h;
  double before = 0.0;
  double term = 0.5;
  double sum = term;
  for (int n = 1; n < 24; ++n) {
    const double next = -(damped * (n + 1) * term + turned * before) / ((n + 2.0) * (n + 1.0));
    before = term;
    term = next;
    sum += term;
  }
  return sum * h * h;
}

void divide_kick(ModeFlow& flow, double h) {
  const double first = flow.pushed;
  const double last = fma(flow.b, flow.b, -flow.d * flow.pushed);
  const double both = fma(flow.pushed, 1.0 - flow.d, flow.b * flow.b);
  const double whole = flow.filter * h;
  // After whole turns without friction both vanish, as the filter does.
  flow.first = both > 0.0 ? whole * (first / both) : 0.5 * whole;
  flow.last = both > 0.0 ? whole * (last / both) : 0.5 * whole;
}

}  // namespace

ModeFlow mode_flow(double square, double rate, double h) {
  ModeFlow flow;
  const double damped = rate * h;
  if (square == 0.0) {
    flow.b = h * decayed(damped);
    flow.d = exp(-damped);
    flow.pushed = h * h * delayed(damped);
    flow.travel = h * h * h * squared_rise(damped);
    divide_kick(flow, h);
    return flow;
  }
  const double half_rate = 0.5 * rate;
  const double bent = square - half_rate * half_rate;  // squared frequency of the damped motion
  double cosine = 0.0;                                 // times exp(-rate h/2), as the next
  double sine = 0.0;                                   // over the frequency
  const double z = bent * h * h;
  if (std::abs(z) < 1e-3) {
    const double decay = exp(-half_rate * h);
    const double rise = fma(-z / 6.0, fma(-z / 20.0, 1.0 - z / 42.0, 1.0), 1.0);
    cosine = decay * fma(-z / 2.0, fma(-z / 12.0, 1.0 - z / 30.0, 1.0), 1.0);
    sine = decay * h * rise;
    flow.filter = bent > 0.0 ? rise : 1.0;
  } else if (bent > 0.0) {
    const double frequency = sqrt(bent);
    const double decay = exp(-half_rate * h);
    sine_cosine(frequency * h, sine, cosine);
    flow.filter = sine / (frequency * h);
    cosine *= decay;
    sine *= decay / frequency;
    // 1 - a, in terms that do not cancel after whole turns either.
    double half_sine = 0.0;
    double half_cosine = 0.0;
    sine_cosine(0.5 * frequency * h, half_sine, half_cosine);
    const double back = 2.0 * decay * half_sine * half_sine - half_rate * sine;
    flow.pushed = fma(half_rate * h, decayed(half_rate * h), back) / square;
  } else {
    const double split = sqrt(-bent);
    const double slower = square / (half_rate + split);
    const double faster = half_rate + split;
    const double slow = exp(-slower * h);
    const double fast = exp(-faster * h);
    cosine = 0.5 * (slow + fast);
    sine = (slow - fast) / (2.0 * split);
    flow.pushed = h * (decayed(slower * h) - decayed(faster * h)) / (2.0 * split);
  }
  flow.a = fma(half_rate, sine, cosine);
  flow.b = sine;
  flow.c = -square * sine;
  flow.d = fma(-half_rate, sine, cosine);
  if (damped < 0.5 && square * h * h < 0.25) {
    flow.pushed = pushed_a_little(square, rate, h);
  } else if (std::abs(z) < 1e-3) {
    flow.pushed = (1.0 - flow.a) / square;
  }
  divide_kick(flow, h);
  return flow;
}

double mode_heat(const ModeFlow& flow, double square, double rate, double u, double p, double g) {
  if (rate == 0.0) return 0.0;
  if (square == 0.0) {
    // p' = g - rate p, term by term: without differences of large numbers at any rate.
    const double decayed = 0.5 * (1.0 + flow.d) * flow.b;  // of exp(-2 rate s)
    return rate * (p * p * decayed + p * g * flow.b * flow.b + g * g * flow.travel);
  }
  // Work of the force less what the mode has gained.
  const double moved = fma(flow.a - 1.0, u, fma(flow.b, p, flow.pushed * g));
  const double end = fma(flow.c, u, fma(flow.d, p, flow.b * g));
  const double kinetic = 0.5 * (end - p) * (end + p);
  const double stored = square * moved * fma(0.5, moved, u);
  return g * moved - kinetic - stored;
}

ModalBody::ModalBody(const ElasticBody& body)
    : body_(body), bonded_(!body.modes.empty()), n_(body.size()) {
  for (Vector* v :
       {&position_, &before_, &velocity_, &force_, &rotated_, &q_, &p_, &g_, &beyond_}) {
    v->assign(n_, 0.0);
  }
  if (!bonded_) return;
  forward_.resize(n_ * n_);
  back_.resize(n_ * n_);
  for (std::size_t j = 0; j < n_; ++j) {
    for (std::size_t k = 0; k < n_; ++k) {
      const double root = body_.root_mass[k % body_.count];
      forward_[k * n_ + j] = body_.modes[j * n_ + k] * root;
      back_[j * n_ + k] = body_.modes[j * n_ + k] / root;
    }
  }
  flows_.resize(n_);
  if (body_.axes == 2) list_springs();
}

void ModalBody::list_springs() {
  const std::size_t count = body_.count;
  double most = 0.0;
  double reach = 0.0;
  for (const double square : body_.squares) most = std::max(most, square);
  for (std::size_t k = 0; k < n_; ++k) {
    const double arm = body_.shape[k] * body_.root_mass[k % count];
    reach = fma(arm, arm, reach);
  }
  rounding_ = kForceRounding * most * sqrt(reach);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      Spring spring;
      spring.first = i;
      spring.second = j;
      double size = 0.0;
      for (std::size_t a = 0; a < 2; ++a) {
        for (int b = 0; b < 2; ++b) {
          double value = 0.0;
          for (std::size_t mode = 0; mode < n_; ++mode) {
            const double* q = body_.modes.data() + mode * n_;
            value = fma(q[a * count + i] * q[b * count + j], body_.squares[mode], value);
          }
          spring.block[2 * a + b] = -value * body_.root_mass[i] * body_.root_mass[j];
          size = std::max(size, std::abs(value));
        }
        spring.apart[a] = body_.shape[a * count + j] - body_.shape[a * count + i];
      }
      if (size <= kNoSpring * most) continue;
      const double* s = spring.apart;
      const double* k = spring.block;
      const double square = fma(s[0], s[0], s[1] * s[1]);
      spring.length = sqrt(square);
      if (square > 0.0) {
        spring.along =
            (s[0] * (k[0] * s[0] + k[1] * s[1]) + s[1] * (k[2] * s[0] + k[3] * s[1])) / square;
        // Under a force it resists being turned.
        spring.force = (k[0] + k[3] - spring.along) * spring.length;
      } else {
        spring.along = 0.5 * (k[0] + k[3]);
      }
      springs_.push_back(spring);
    }
  }
}

bool ModalBody::keeps_shape(double& other) {
  if (springs_.empty()) return true;
  const std::size_t count = body_.count;
  for (double& x : rotated_) x = 0.0;
  for (const Spring& spring : springs_) {
    const std::size_t i = spring.first;
    const std::size_t j = spring.second;
    const double s[2] = {position_[j] - position_[i], position_[count + j] - position_[count + i]};
    const double u[2] = {s[0] - spring.apart[0], s[1] - spring.apart[1]};
    const double length = sqrt(fma(s[0], s[0], s[1] * s[1]));
    const double pull =
        length > 0.0 ? fma(spring.along, length - spring.length, spring.force) / length : 0.0;
    const double before = spring.length > 0.0 ? spring.force / spring.length : 0.0;
    for (std::size_t a = 0; a < 2; ++a) {
      const double linear =
          before * spring.apart[a] + spring.block[2 * a] * u[0] + spring.block[2 * a + 1] * u[1];
      const double beyond = pull * s[a] - linear;
      rotated_[a * count + i] += beyond / body_.mass[i];
      rotated_[a * count + j] -= beyond / body_.mass[j];
    }
  }
  to_modes(rotated_, beyond_);
  double lost = 0.0;
  double bonds = 0.0;
  double rest = 0.0;
  for (std::size_t j = 0; j < n_; ++j) {
    const ModeFlow& flow = flows_[j];
    const double square = body_.squares[j];
    const double linear = square * (q_[j] - body_.equilibrium[j]);
    const double kept = square > 0.0 ? flow.first * flow.b / flow.pushed : 1.0;
    const double miss = (1.0 - kept) * beyond_[j];
    lost = fma(miss, miss, lost);
    bonds = fma(beyond_[j] - linear, beyond_[j] - linear, bonds);
    rest = fma(g_[j] - beyond_[j], g_[j] - beyond_[j], rest);
  }
  other = std::max(other, sqrt(rest));
  return sqrt(lost) <= kLostForce * std::max(other, sqrt(bonds)) + rounding_;
}

void ModalBody::prepare(double h) {
  if (h == known_h_) return;
  known_h_ = h;
  whole_ = mode_flow(0.0, body_.friction_rate, h);
  for (std::size_t j = 0; j < flows_.size(); ++j) {
    flows_[j] = mode_flow(body_.squares[j], body_.friction_rate, h);
  }
}

/// The centre of mass, and the rotation that brings the shape closest to the body.
void ModalBody::place_frame(const double* position) {
  for (int d = 0; d < body_.axes; ++d) {
    const double* x = position + body_.offset + d * body_.stride;
    double sum = 0.0;
    for (std::size_t i = 0; i < body_.count; ++i) sum += body_.mass[i] * x[i];
    centre_[d] = sum / body_.total_mass;
  }
  cosine_ = 1.0;
  sine_ = 0.0;
  if (!body_.turns) return;
  const double* x = position + body_.offset;
  const double* y = x + body_.stride;
  double along = 0.0;
  double across = 0.0;
  for (std::size_t i = 0; i < body_.count; ++i) {
    const double dx = body_.mass[i] * (x[i] - centre_[0]);
    const double dy = body_.mass[i] * (y[i] - centre_[1]);
    const double sx = body_.shape[i];
    const double sy = body_.shape[body_.count + i];
    along += sx * dx + sy * dy;
    across += sx * dy - sy * dx;
  }
  const double size = sqrt(along * along + across * across);
  if (!(size > 0.0)) return;
  cosine_ = along / size;
  sine_ = across / size;
}

void ModalBody::to_frame(const double* from, Vector& to) const {
  for (int d = 0; d < body_.axes; ++d) {
    const double* x = from + body_.offset + d * body_.stride;
    for (std::size_t i = 0; i < body_.count; ++i) to[d * body_.count + i] = x[i];
  }
  turn(to, -sine_, cosine_);
}

void ModalBody::turn(Vector& x, double sine, double cosine) const {
  if (!body_.turns) return;
  for (std::size_t i = 0; i < body_.count; ++i) {
    double& first = x[i];
    double& second = x[body_.count + i];
    const double old = first;
    first = cosine * old - sine * second;
    second = sine * old + cosine * second;
  }
}

// Sums over whole rows, which compilers take several terms of at a time, the bits being the same.

void ModalBody::to_modes(const Vector& x, Vector& q) const {
  for (double& value : q) value = 0.0;
  for (std::size_t k = 0; k < n_; ++k) {
    const double* row = forward_.data() + k * n_;
    for (std::size_t j = 0; j < n_; ++j) q[j] += row[j] * x[k];
  }
}

void ModalBody::from_modes(const Vector& q, Vector& x) const {
  for (double& value : x) value = 0.0;
  for (std::size_t j = 0; j < n_; ++j) {
    const double* row = back_.data() + j * n_;
    for (std::size_t k = 0; k < n_; ++k) x[k] += row[k] * q[j];
  }
}

/// velocity_ += length * (force + K u)/m, each mode's own length; q_ holds the displacements.
/// Returns the heat over the step.
double ModalBody::first_kick() {
  double heat = 0.0;
  if (!bonded_) {
    for (std::size_t k = 0; k < n_; ++k) {
      const double mass = body_.mass[k % body_.count];
      const double g = force_[k] / mass;
      heat += mass * mode_heat(whole_, 0.0, body_.friction_rate, 0.0, velocity_[k], g);
      velocity_[k] += whole_.first * g;
    }
    return heat;
  }
  find_kick();
  for (std::size_t j = 0; j < n_; ++j) {
    const double u = q_[j] - body_.equilibrium[j];
    heat += mode_heat(flows_[j], body_.squares[j], body_.friction_rate, u, p_[j], g_[j]);
    p_[j] += flows_[j].first * g_[j];
  }
  from_modes(p_, velocity_);
  // Modes are in such a unit of mass.
  return heat * power_of_two_above(body_.mass.front());
}

void ModalBody::last_kick() {
  if (!bonded_) {
    for (std::size_t k = 0; k < n_; ++k) {
      velocity_[k] += whole_.last * (force_[k] / body_.mass[k % body_.count]);
    }
    return;
  }
  find_kick();
  for (std::size_t j = 0; j < n_; ++j) p_[j] += flows_[j].last * g_[j];
  from_modes(p_, velocity_);
}

/// In normal coordinates, what the linear part leaves of all forces, and the velocities.
void ModalBody::find_kick() {
  for (std::size_t k = 0; k < n_; ++k) rotated_[k] = force_[k] / body_.mass[k % body_.count];
  to_modes(rotated_, g_);
  to_modes(velocity_, p_);
  for (std::size_t j = 0; j < n_; ++j) {
    g_[j] += body_.squares[j] * (q_[j] - body_.equilibrium[j]);
  }
}

/// Takes the motion as a whole out of velocity_.
void ModalBody::find_motion() {
  const std::size_t count = body_.count;
  for (int d = 0; d < body_.axes; ++d) {
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      sum += body_.mass[i] * velocity_[d * count + i];
    }
    speed_[d] = sum / body_.total_mass;
    for (std::size_t i = 0; i < count; ++i) velocity_[d * count + i] -= speed_[d];
  }
  spin_ = 0.0;
  if (!body_.turns) return;
  double momentum = 0.0;
  double inertia = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = position_[i];
    const double y = position_[count + i];
    const double m = body_.mass[i];
    momentum += m * (x * velocity_[count + i] - y * velocity_[i]);
    inertia += m * (x * x + y * y);
  }
  spin_ = inertia > 0.0 ? momentum / inertia : 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    velocity_[i] += spin_ * position_[count + i];
    velocity_[count + i] -= spin_ * position_[i];
  }
}

/// p_ += half * rate^2 r, filtered, r being position_.
void ModalBody::centrifugal_kick(double rate, double half) {
  if (rate == 0.0) return;
  to_modes(position_, g_);
  for (std::size_t j = 0; j < n_; ++j) {
    p_[j] += half * flows_[j].filter * rate * rate * g_[j];
  }
}

double ModalBody::enter(const double* position, const double* velocity, const double* force,
                        double h) {
  prepare(h);
  place_frame(position);
  for (int d = 0; d < body_.axes; ++d) {
    const double* x = position + body_.offset + d * body_.stride;
    for (std::size_t i = 0; i < body_.count; ++i) {
      position_[d * body_.count + i] = x[i] - centre_[d];
    }
  }
  turn(position_, -sine_, cosine_);
  to_frame(velocity, velocity_);
  to_frame(force, force_);
  if (bonded_) {
    for (std::size_t k = 0; k < n_; ++k) rotated_[k] = position_[k] - body_.shape[k];
    to_modes(rotated_, q_);
  }
  return first_kick();
}

void ModalBody::flow(double h, double* move, double* velocity) {
  const std::size_t count = body_.count;
  const auto put = [&](const Vector& from, double* to) {
    for (int d = 0; d < body_.axes; ++d) {
      double* x = to + body_.offset + d * body_.stride;
      for (std::size_t i = 0; i < count; ++i) x[i] = from[d * count + i];
    }
  };
  if (!bonded_) {
    for (std::size_t k = 0; k < n_; ++k) position_[k] = whole_.b * velocity_[k];
    for (std::size_t k = 0; k < n_; ++k) velocity_[k] *= whole_.d;
    put(position_, move);
    put(velocity_, velocity);
    return;
  }
  find_motion();
  before_ = position_;
  const double last_spin = spin_ * whole_.d;
  const double angle = spin_ * whole_.b;

  // Terms of rotation, at the step's mean rate: half of them, the exact flow, the other half.
  const double mean_spin = angle / h;
  double sine = 0.0;
  double cosine = 1.0;
  to_modes(velocity_, p_);
  centrifugal_kick(mean_spin, 0.5 * h);
  from_modes(p_, velocity_);
  sine_cosine(-mean_spin * h, sine, cosine);
  turn(velocity_, sine, cosine);
  to_modes(velocity_, p_);
  for (std::size_t j = 0; j < n_; ++j) {
    const ModeFlow& f = flows_[j];
    const double u = q_[j] - body_.equilibrium[j];
    const double p = p_[j];
    q_[j] = body_.equilibrium[j] + (f.a * u + f.b * p);
    p_[j] = f.c * u + f.d * p;
  }
  from_modes(q_, position_);
  for (std::size_t k = 0; k < n_; ++k) position_[k] += body_.shape[k];
  from_modes(p_, velocity_);
  sine_cosine(-mean_spin * h, sine, cosine);
  turn(velocity_, sine, cosine);
  to_modes(velocity_, p_);
  centrifugal_kick(mean_spin, 0.5 * h);
  from_modes(p_, velocity_);

  // Back: the frame has moved and turned.
  for (std::size_t i = 0; i < count && body_.turns; ++i) {
    velocity_[i] -= last_spin * position_[count + i];
    velocity_[count + i] += last_spin * position_[i];
  }
  sine_cosine(angle, sine, cosine);
  rotated_ = position_;
  turn(rotated_, sine, cosine);
  turn(velocity_, sine, cosine);
  for (int d = 0; d < body_.axes; ++d) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t k = d * count + i;
      rotated_[k] += whole_.b * speed_[d] - before_[k];
      velocity_[k] += whole_.d * speed_[d];
    }
  }
  turn(rotated_, sine_, cosine_);
  put(rotated_, move);
  // From here on the frame is the turned one; velocity_ stays in it for the last kick.
  rotated_ = velocity_;
  turn(rotated_, sine_, cosine_);
  put(rotated_, velocity);
  turn(velocity_, -sine, cosine);
  const double old = cosine_;
  cosine_ = cosine * old - sine * sine_;
  sine_ = sine * old + cosine * sine_;
}

void ModalBody::leave(const double* force, double* velocity) {
  to_frame(force, force_);
  last_kick();
  rotated_ = velocity_;
  turn(rotated_, sine_, cosine_);
  for (int d = 0; d < body_.axes; ++d) {
    double* v = velocity + body_.offset + d * body_.stride;
    for (std::size_t i = 0; i < body_.count; ++i) v[i] = rotated_[d * body_.count + i];
  }
}

bool ModalBody::is_stopped_within(double h) const { return body_.friction_rate * h >= 1.0; }

void ModalBody::interpolate(double theta, double h, const double* const start[2],
                            const double* const end[2], double* position, double* velocity) const {
  const double rate = body_.friction_rate;
  const double s = theta * h;
  const ModeFlow here = mode_flow(0.0, rate, s);
  const ModeFlow all = mode_flow(0.0, rate, h);
  // By a force that grows in proportion to time.
  const double by_rise = (0.5 * s * s - here.pushed) / rate;
  const double all_by_rise = (0.5 * h * h - all.pushed) / rate;
  const double scale = 1.0 / fma(all.pushed, all.pushed, -all.b * all_by_rise);
  for (int d = 0; d < body_.axes; ++d) {
    for (std::size_t i = 0; i < body_.count; ++i) {
      const std::size_t k = body_.offset + d * body_.stride + i;
      const double x = start[0][k];
      const double v = start[1][k];
      const double moved = (end[0][k] - x) - all.b * v;
      const double gained = end[1][k] - all.d * v;
      const double force = (moved * all.pushed - gained * all_by_rise) * scale;
      const double rise = (gained * all.pushed - moved * all.b) * scale;
      position[k] = x + (here.b * v + (here.pushed * force + by_rise * rise));
      velocity[k] = here.d * v + (here.b * force + here.pushed * rise);
    }
  }
}

}  // namespace tomlin
