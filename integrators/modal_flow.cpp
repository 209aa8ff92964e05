#include "integrators/modal_flow.hpp"

#include <cmath>

#include "framework/core/math.hpp"

namespace tomlin {
namespace {

void sine_cosine(double angle, double& sine, double& cosine) {
  sincos_turns(angle / tau<double>(), sine, cosine);
}

/// sin(x)/x.
double sinc(double x) {
  if (std::abs(x) < 1e-2) {
    const double z = x * x;
    return fma(-z / 6.0, fma(-z / 20.0, 1.0 - z / 42.0, 1.0), 1.0);
  }
  double sine = 0.0;
  double cosine = 0.0;
  sine_cosine(x, sine, cosine);
  return sine / x;
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

}  // namespace

ModeFlow mode_flow(double square, double rate, double h) {
  ModeFlow flow;
  if (square == 0.0) {
    flow.b = h * decayed(rate * h);
    flow.d = exp(-rate * h);
    return flow;
  }
  const double half_rate = 0.5 * rate;
  const double bent = square - half_rate * half_rate;  // squared frequency of the damped motion
  double cosine = 0.0;                                 // times exp(-rate h/2), as the next
  double sine = 0.0;                                   // over the frequency
  const double z = bent * h * h;
  if (std::abs(z) < 1e-3) {
    const double decay = exp(-half_rate * h);
    cosine = decay * fma(-z / 2.0, fma(-z / 12.0, 1.0 - z / 30.0, 1.0), 1.0);
    sine = decay * h * fma(-z / 6.0, fma(-z / 20.0, 1.0 - z / 42.0, 1.0), 1.0);
  } else if (bent > 0.0) {
    const double frequency = sqrt(bent);
    const double decay = exp(-half_rate * h);
    sine_cosine(frequency * h, sine, cosine);
    cosine *= decay;
    sine *= decay / frequency;
  } else {
    const double split = sqrt(-bent);
    const double slow = exp(-square / (half_rate + split) * h);
    const double fast = exp(-(half_rate + split) * h);
    cosine = 0.5 * (slow + fast);
    sine = (slow - fast) / (2.0 * split);
  }
  flow.a = fma(half_rate, sine, cosine);
  flow.b = sine;
  flow.c = -square * sine;
  flow.d = fma(-half_rate, sine, cosine);
  flow.filter = sinc(sqrt(square) * h);
  return flow;
}

ModalBody::ModalBody(const ElasticBody& body)
    : body_(body), bonded_(!body.modes.empty()), n_(body.size()) {
  for (Vector* v : {&place_, &before_, &velocity_, &force_, &rotated_, &q_, &p_, &g_}) {
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

/// velocity_ += half * (force + K u)/m, filtered; q_ holds the displacements.
void ModalBody::kick(const Vector& force, double half) {
  if (!bonded_) {
    for (std::size_t k = 0; k < n_; ++k) {
      velocity_[k] += half * (force[k] / body_.mass[k % body_.count]);
    }
    return;
  }
  for (std::size_t k = 0; k < n_; ++k) rotated_[k] = force[k] / body_.mass[k % body_.count];
  to_modes(rotated_, g_);
  to_modes(velocity_, p_);
  for (std::size_t j = 0; j < n_; ++j) {
    const double left = body_.squares[j] * (q_[j] - body_.equilibrium[j]) + g_[j];
    p_[j] += half * flows_[j].filter * left;
  }
  from_modes(p_, velocity_);
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
    const double x = place_[i];
    const double y = place_[count + i];
    const double m = body_.mass[i];
    momentum += m * (x * velocity_[count + i] - y * velocity_[i]);
    inertia += m * (x * x + y * y);
  }
  spin_ = inertia > 0.0 ? momentum / inertia : 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    velocity_[i] += spin_ * place_[count + i];
    velocity_[count + i] -= spin_ * place_[i];
  }
}

/// p_ += half * rate^2 r, filtered, r being place_.
void ModalBody::centrifugal_kick(double rate, double half) {
  if (rate == 0.0) return;
  to_modes(place_, g_);
  for (std::size_t j = 0; j < n_; ++j) {
    p_[j] += half * flows_[j].filter * rate * rate * g_[j];
  }
}

void ModalBody::enter(const double* position, const double* velocity, const double* force,
                      double h) {
  prepare(h);
  place_frame(position);
  for (int d = 0; d < body_.axes; ++d) {
    const double* x = position + body_.offset + d * body_.stride;
    for (std::size_t i = 0; i < body_.count; ++i) {
      place_[d * body_.count + i] = x[i] - centre_[d];
    }
  }
  turn(place_, -sine_, cosine_);
  to_frame(velocity, velocity_);
  to_frame(force, force_);
  if (bonded_) {
    for (std::size_t k = 0; k < n_; ++k) rotated_[k] = place_[k] - body_.shape[k];
    to_modes(rotated_, q_);
  }
  kick(force_, 0.5 * h);
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
    for (std::size_t k = 0; k < n_; ++k) place_[k] = whole_.b * velocity_[k];
    for (std::size_t k = 0; k < n_; ++k) velocity_[k] *= whole_.d;
    put(place_, move);
    put(velocity_, velocity);
    return;
  }
  find_motion();
  before_ = place_;
  const double last_spin = spin_ * whole_.d;
  const double angle = spin_ * whole_.b;

  // What turning adds: half of it, the exact flow, the other half.
  double sine = 0.0;
  double cosine = 1.0;
  to_modes(velocity_, p_);
  centrifugal_kick(spin_, 0.5 * h);
  from_modes(p_, velocity_);
  sine_cosine(-spin_ * h, sine, cosine);
  turn(velocity_, sine, cosine);
  to_modes(velocity_, p_);
  for (std::size_t j = 0; j < n_; ++j) {
    const ModeFlow& f = flows_[j];
    const double u = q_[j] - body_.equilibrium[j];
    const double p = p_[j];
    q_[j] = body_.equilibrium[j] + (f.a * u + f.b * p);
    p_[j] = f.c * u + f.d * p;
  }
  from_modes(q_, place_);
  for (std::size_t k = 0; k < n_; ++k) place_[k] += body_.shape[k];
  from_modes(p_, velocity_);
  sine_cosine(-last_spin * h, sine, cosine);
  turn(velocity_, sine, cosine);
  to_modes(velocity_, p_);
  centrifugal_kick(last_spin, 0.5 * h);
  from_modes(p_, velocity_);

  // Back: the frame has moved and turned.
  for (std::size_t i = 0; i < count && body_.turns; ++i) {
    velocity_[i] -= last_spin * place_[count + i];
    velocity_[count + i] += last_spin * place_[i];
  }
  sine_cosine(angle, sine, cosine);
  rotated_ = place_;
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

void ModalBody::leave(const double* force, double h, double* velocity) {
  to_frame(force, force_);
  kick(force_, 0.5 * h);
  rotated_ = velocity_;
  turn(rotated_, sine_, cosine_);
  for (int d = 0; d < body_.axes; ++d) {
    double* v = velocity + body_.offset + d * body_.stride;
    for (std::size_t i = 0; i < body_.count; ++i) v[i] = rotated_[d * body_.count + i];
  }
}

}  // namespace tomlin
