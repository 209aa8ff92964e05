#include "benchmarks/plain_loops.hpp"

#include <type_traits>

namespace tomlin::plain {

// ---- Prandtl-Tomlinson --------------------------------------------------------------------------

template <class Math, bool remembers>
[[gnu::noinline]] void DraggedTip<Math, remembers>::advance(std::int64_t steps, double h) {
  const Math math(period);
  const double k = stiffness;
  const double xi = damping;
  const double rate = 1.0 / memory_time;
  const double memory = damping * rate;
  const double site = 2.0 * std::numbers::pi * amplitude / period;
  const double inverse_mass = 1.0 / mass;
  const double half = 0.5 * h;
  const double sixth = h / 6.0;
  const auto acceleration = [=](double at, double moving, double stretched, double spring) {
    if constexpr (remembers) {
      return (spring - memory * stretched + site * math.sine(at)) * inverse_mass;
    } else {
      return (spring - xi * moving + site * math.sine(at)) * inverse_mass;
    }
  };
  double position = x;
  double velocity = v;
  double stretch = q;
  double integral = force_integral;

  for (std::int64_t n = done; n < done + steps; ++n) {
    const double t = static_cast<double>(n) * h;
    const double driver1 = speed * t;
    const double driver2 = speed * (t + half);
    const double driver4 = speed * (t + h);

    const double f1 = k * (driver1 - position);
    const double a1 = acceleration(position, velocity, stretch, f1);
    const double q1 = velocity - rate * stretch;

    const double x2 = position + half * velocity;
    const double v2 = velocity + half * a1;
    const double s2 = stretch + half * q1;
    const double f2 = k * (driver2 - x2);
    const double a2 = acceleration(x2, v2, s2, f2);
    const double q2 = v2 - rate * s2;

    const double x3 = position + half * v2;
    const double v3 = velocity + half * a2;
    const double s3 = stretch + half * q2;
    const double f3 = k * (driver2 - x3);
    const double a3 = acceleration(x3, v3, s3, f3);
    const double q3 = v3 - rate * s3;

    const double x4 = position + h * v3;
    const double v4 = velocity + h * a3;
    const double s4 = stretch + h * q3;
    const double f4 = k * (driver4 - x4);
    const double a4 = acceleration(x4, v4, s4, f4);
    const double q4 = v4 - rate * s4;

    position += sixth * (velocity + 2.0 * (v2 + v3) + v4);
    velocity += sixth * (a1 + 2.0 * (a2 + a3) + a4);
    // Without memory the compiler drops all that leads here.
    if constexpr (remembers) stretch += sixth * (q1 + 2.0 * (q2 + q3) + q4);
    integral += sixth * (f1 + 2.0 * (f2 + f3) + f4);
  }
  x = position;
  v = velocity;
  q = stretch;
  force_integral = integral;
  done += steps;
}

TipReplicas::TipReplicas(std::size_t count)
    : stiffness(count, 2.0),
      damping(count, 2.0 * std::numbers::sqrt2),
      speed(count, 1e-3),
      inverse_period(count, 1.0),
      site(count, 2.0 * std::numbers::pi * 0.1),
      inverse_mass(count, 1.0),
      x(count, 0.0),
      v(count, 0.0),
      force_integral(count, 0.0) {
  for (std::size_t i = 0; i < count; ++i) speed[i] *= 1.0 + 0.01 * static_cast<double>(i);
}

[[gnu::noinline]] void TipReplicas::advance(std::int64_t steps, double h) {
  const Pack half(0.5 * h);
  const Pack whole(h);
  const Pack sixth(h / 6.0);
  const Pack two(2.0);
  for (std::int64_t n = done; n < done + steps; ++n) {
    const double t = static_cast<double>(n) * h;
    const Pack t1(t);
    const Pack t2(t + 0.5 * h);
    const Pack t4(t + h);
    for (std::size_t i = 0; i < x.size(); i += 8) {
      const auto of = [i](const std::vector<double>& all) { return Pack::load_unaligned(&all[i]); };
      const Pack k = of(stiffness);
      const Pack xi = of(damping);
      const Pack moves = of(speed);
      const Pack wave = of(inverse_period);
      const Pack force = of(site);
      const Pack per_mass = of(inverse_mass);
      const Pack position = of(x);
      const Pack velocity = of(v);
      const auto acceleration = [&](const Pack& at, const Pack& moving, const Pack& spring) {
        return fma(force, sin_turns(wave * at), spring - xi * moving) * per_mass;
      };
      const Pack f1 = k * (moves * t1 - position);
      const Pack a1 = acceleration(position, velocity, f1);
      const Pack x2 = fma(half, velocity, position);
      const Pack v2 = fma(half, a1, velocity);
      const Pack f2 = k * (moves * t2 - x2);
      const Pack a2 = acceleration(x2, v2, f2);
      const Pack x3 = fma(half, v2, position);
      const Pack v3 = fma(half, a2, velocity);
      const Pack f3 = k * (moves * t2 - x3);
      const Pack a3 = acceleration(x3, v3, f3);
      const Pack x4 = fma(whole, v3, position);
      const Pack v4 = fma(whole, a3, velocity);
      const Pack f4 = k * (moves * t4 - x4);
      const Pack a4 = acceleration(x4, v4, f4);
      fma(sixth, velocity + two * (v2 + v3) + v4, position).store_unaligned(&x[i]);
      fma(sixth, a1 + two * (a2 + a3) + a4, velocity).store_unaligned(&v[i]);
      fma(sixth, f1 + two * (f2 + f3) + f4, of(force_integral)).store_unaligned(&force_integral[i]);
    }
  }
  done += steps;
}

namespace {

constexpr int kRing = RingReplicas::kParticles;
constexpr double kRingRadius = 1.0;

struct RingState {
  Pack x[kRing], y[kRing], vx[kRing], vy[kRing];
};

struct RingAcceleration {
  Pack x[kRing], y[kRing];
  Pack driver_x, driver_y;
};

double rest_length_of(int i, int j) {
  return 2.0 * kRingRadius * std::sin(std::numbers::pi * (j - i) / kRing);
}

[[gnu::always_inline]] inline void accelerate(const RingState& s, const Pack& stiffness,
                                              const double (&rest)[kRing][kRing], double t,
                                              RingAcceleration& a) {
  constexpr double kShare = 1.0 / kRing;
  const Pack share(kShare);
  const Pack drag(2.0 * std::numbers::sqrt2 * kShare);
  const Pack corrugation(0.1 * kShare);
  const Pack wave_number(2.0 * std::numbers::pi);
  const Pack bond(1e6);
  const Pack per_mass(static_cast<double>(kRing));
  Pack centre_x(0.0);
  Pack centre_y(0.0);
  for (int i = 0; i < kRing; ++i) {
    centre_x = fma(share, s.x[i], centre_x);
    centre_y = fma(share, s.y[i], centre_y);
  }
  a.driver_x = stiffness * (Pack(1e-3 * t) - centre_x);
  a.driver_y = stiffness * (Pack(kRingRadius) - centre_y);
  for (int i = 0; i < kRing; ++i) {
    Pack sine;
    Pack cosine;
    sincos_turns(s.x[i], sine, cosine);
    const Pack energy = corrugation * exp(-(s.y[i] * s.y[i]));
    a.x[i] = fma(energy * wave_number, sine, fma(share, a.driver_x, -(drag * s.vx[i])));
    a.y[i] = fma(Pack(2.0) * s.y[i] * energy, cosine, fma(share, a.driver_y, -(drag * s.vy[i])));
  }
  for (int i = 0; i < kRing; ++i) {
    for (int j = i + 1; j < kRing; ++j) {
      const Pack dx = s.x[j] - s.x[i];
      const Pack dy = s.y[j] - s.y[i];
      const Pack r = sqrt(fma(dy, dy, dx * dx));
      const Pack pull = bond * (r - Pack(rest[i][j])) / r;
      a.x[i] = fma(pull, dx, a.x[i]);
      a.y[i] = fma(pull, dy, a.y[i]);
      a.x[j] = fnma(pull, dx, a.x[j]);
      a.y[j] = fnma(pull, dy, a.y[j]);
    }
  }
  for (int i = 0; i < kRing; ++i) {
    a.x[i] = a.x[i] * per_mass;
    a.y[i] = a.y[i] * per_mass;
  }
}

}  // namespace

RingReplicas::RingReplicas(std::size_t count)
    : stiffness(count, 2.0), force_integral_x(count, 0.0), force_integral_y(count, 0.0) {
  for (std::size_t k = 0; k < count; ++k) stiffness[k] += 0.01 * static_cast<double>(k);
  for (std::vector<double>* all : {&x, &y, &vx, &vy}) all->assign(kParticles * count, 0.0);
  for (std::size_t i = 0; i < kParticles; ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / kRing;
    for (std::size_t k = 0; k < count; ++k) {
      x[i * count + k] = kRingRadius * std::cos(angle);
      y[i * count + k] = kRingRadius + kRingRadius * std::sin(angle);
    }
  }
}

[[gnu::noinline]] void RingReplicas::advance(std::int64_t steps, double h) {
  const std::size_t count = stiffness.size();
  double rest[kRing][kRing] = {};
  for (int i = 0; i < kRing; ++i) {
    for (int j = i + 1; j < kRing; ++j) rest[i][j] = rest_length_of(i, j);
  }
  const double until[4] = {0.0, 0.5 * h, 0.5 * h, h};  // when each stage is evaluated
  const double weight[4] = {h / 6.0, h / 3.0, h / 3.0, h / 6.0};
  for (std::size_t k = 0; k < count; k += 8) {
    const Pack spring = Pack::load_unaligned(&stiffness[k]);
    const auto at = [&](const std::vector<double>& all, int i) {
      return Pack::load_unaligned(&all[static_cast<std::size_t>(i) * count + k]);
    };
    RingState now;
    for (int i = 0; i < kRing; ++i) {
      now.x[i] = at(x, i);
      now.y[i] = at(y, i);
      now.vx[i] = at(vx, i);
      now.vy[i] = at(vy, i);
    }
    Pack integral_x = Pack::load_unaligned(&force_integral_x[k]);
    Pack integral_y = Pack::load_unaligned(&force_integral_y[k]);
    for (std::int64_t n = done; n < done + steps; ++n) {
      RingState stage = now;
      RingState next = now;
      RingAcceleration a;
      for (int part = 0; part < 4; ++part) {
        accelerate(stage, spring, rest, static_cast<double>(n) * h + until[part], a);
        const Pack share(weight[part]);
        integral_x = fma(share, a.driver_x, integral_x);
        integral_y = fma(share, a.driver_y, integral_y);
        const Pack ahead(part < 3 ? until[part + 1] : 0.0);
        for (int i = 0; i < kRing; ++i) {
          next.x[i] = fma(share, stage.vx[i], next.x[i]);
          next.y[i] = fma(share, stage.vy[i], next.y[i]);
          next.vx[i] = fma(share, a.x[i], next.vx[i]);
          next.vy[i] = fma(share, a.y[i], next.vy[i]);
          stage.x[i] = fma(ahead, stage.vx[i], now.x[i]);
          stage.y[i] = fma(ahead, stage.vy[i], now.y[i]);
          stage.vx[i] = fma(ahead, a.x[i], now.vx[i]);
          stage.vy[i] = fma(ahead, a.y[i], now.vy[i]);
        }
      }
      now = next;
    }
    for (int i = 0; i < kRing; ++i) {
      const std::size_t to = static_cast<std::size_t>(i) * count + k;
      now.x[i].store_unaligned(&x[to]);
      now.y[i].store_unaligned(&y[to]);
      now.vx[i].store_unaligned(&vx[to]);
      now.vy[i].store_unaligned(&vy[to]);
    }
    integral_x.store_unaligned(&force_integral_x[k]);
    integral_y.store_unaligned(&force_integral_y[k]);
  }
  done += steps;
}

[[gnu::noinline]] void NormalReplicas::draw(std::uint64_t four) {
  __extension__ using Product = unsigned __int128;
  for (std::size_t first = 0; first < replicas; first += 8) {
    double uniform[4][8];
    for (std::size_t k = 0; k < 8; ++k) {
      std::uint64_t word[4] = {four, 0, 0, 0};
      std::uint64_t key[2] = {17, first + k};
      for (int round = 0; round < 10; ++round) {
        const Product a = static_cast<Product>(0xD2E7470EE14C6C93) * word[0];
        const Product b = static_cast<Product>(0xCA5A826395121157) * word[2];
        word[0] = static_cast<std::uint64_t>(b >> 64) ^ word[1] ^ key[0];
        word[1] = static_cast<std::uint64_t>(b);
        word[2] = static_cast<std::uint64_t>(a >> 64) ^ word[3] ^ key[1];
        word[3] = static_cast<std::uint64_t>(a);
        key[0] += 0x9E3779B97F4A7C15;
        key[1] += 0xBB67AE8584CAA73B;
      }
      for (int j = 0; j < 4; ++j) {
        uniform[j][k] = static_cast<double>(word[j] >> 12) * 0x1p-52 + 0x1p-53;
      }
    }
    for (std::size_t pair = 0; pair < 2; ++pair) {
      const Pack radius = Pack::load_unaligned(uniform[2 * pair]);
      const Pack size = sqrt(Pack(-2.0) * log(radius));
      Pack sine(0.0);
      Pack cosine(0.0);
      sincos_turns(Pack::load_unaligned(uniform[2 * pair + 1]), sine, cosine);
      (size * cosine).store_unaligned(&numbers[2 * pair * replicas + first]);
      (size * sine).store_unaligned(&numbers[(2 * pair + 1) * replicas + first]);
    }
  }
}

// ---- particles in the plane ---------------------------------------------------------------------

PlaneParticles::PlaneParticles(int particles) : count(particles) {
  for (std::vector<double>* a :
       {&x, &y, &vx, &vy, &xs, &ys, &vxs, &vys, &ax, &ay, &sum_vx, &sum_vy, &sum_ax, &sum_ay}) {
    a->assign(count, 0.0);
  }
}

// Steps of RK4, the forces of a model being its accelerations().
template <class Model>
[[gnu::always_inline]] inline void advance_in_plane(Model& m, std::int64_t steps, double h) {
  const int n = m.count;
  const double half = 0.5 * h;
  const double sixth = h / 6.0;
  double driver_x[4];
  double driver_y[4];
  for (std::int64_t k = 0; k < steps; ++k) {
    const double t = static_cast<double>(m.done) * h;

    m.accelerations(m.x.data(), m.y.data(), m.vx.data(), m.vy.data(), t, driver_x[0], driver_y[0]);
    for (int i = 0; i < n; ++i) {
      m.sum_vx[i] = m.vx[i];
      m.sum_vy[i] = m.vy[i];
      m.sum_ax[i] = m.ax[i];
      m.sum_ay[i] = m.ay[i];
      m.xs[i] = m.x[i] + half * m.vx[i];
      m.ys[i] = m.y[i] + half * m.vy[i];
      m.vxs[i] = m.vx[i] + half * m.ax[i];
      m.vys[i] = m.vy[i] + half * m.ay[i];
    }
    for (int stage = 1; stage < 3; ++stage) {
      const double ahead = stage == 1 ? half : h;
      m.accelerations(m.xs.data(), m.ys.data(), m.vxs.data(), m.vys.data(), t + half,
                      driver_x[stage], driver_y[stage]);
      for (int i = 0; i < n; ++i) {
        m.sum_vx[i] += 2.0 * m.vxs[i];
        m.sum_vy[i] += 2.0 * m.vys[i];
        m.sum_ax[i] += 2.0 * m.ax[i];
        m.sum_ay[i] += 2.0 * m.ay[i];
        m.xs[i] = m.x[i] + ahead * m.vxs[i];
        m.ys[i] = m.y[i] + ahead * m.vys[i];
        m.vxs[i] = m.vx[i] + ahead * m.ax[i];
        m.vys[i] = m.vy[i] + ahead * m.ay[i];
      }
    }
    m.accelerations(m.xs.data(), m.ys.data(), m.vxs.data(), m.vys.data(), t + h, driver_x[3],
                    driver_y[3]);
    for (int i = 0; i < n; ++i) {
      m.x[i] += sixth * (m.sum_vx[i] + m.vxs[i]);
      m.y[i] += sixth * (m.sum_vy[i] + m.vys[i]);
      m.vx[i] += sixth * (m.sum_ax[i] + m.ax[i]);
      m.vy[i] += sixth * (m.sum_ay[i] + m.ay[i]);
    }
    m.force_integral_x += sixth * (driver_x[0] + 2.0 * (driver_x[1] + driver_x[2]) + driver_x[3]);
    m.force_integral_y += sixth * (driver_y[0] + 2.0 * (driver_y[1] + driver_y[2]) + driver_y[3]);
    ++m.done;
  }
}

// ---- flexible ring ------------------------------------------------------------------------------

template <class Math>
FlexibleRing<Math>::FlexibleRing(int particles, double ring_radius)
    : PlaneParticles(particles), radius(ring_radius) {
  for (int i = 0; i < count; ++i) {
    const double theta = 2.0 * std::numbers::pi * i / count;
    x[i] = radius * std::cos(theta);
    y[i] = radius + radius * std::sin(theta);
  }
  rest_length.assign(count * count, 0.0);
  for (int i = 0; i < count; ++i) {
    for (int j = i + 1; j < count; ++j) {
      const double dx = x[j] - x[i];
      const double dy = y[j] - y[i];
      rest_length[i * count + j] = std::sqrt(dx * dx + dy * dy);
    }
  }
}

// Every force of the model in one function.
template <class Math>
void FlexibleRing<Math>::accelerations(const double* px, const double* py, const double* ux,
                                       const double* uy, double t, double& driver_x,
                                       double& driver_y) {
  const Math math(period);
  const int n = count;
  const double share = 1.0 / n;
  const double xi = damping * share;
  const double v0 = amplitude * share;
  const double kx = 2.0 * std::numbers::pi / period;
  const double b = lambda / radius;
  const double inverse_mass = n / mass;
  const double k_bond = bond_stiffness;
  double* fx = ax.data();
  double* fy = ay.data();

  double centre_x = 0.0;
  double centre_y = 0.0;
  for (int i = 0; i < n; ++i) {
    centre_x += px[i];
    centre_y += py[i];
  }
  driver_x = stiffness * (speed * t - centre_x * share);
  driver_y = stiffness * (radius - centre_y * share);
  const double spring_x = driver_x * share;
  const double spring_y = driver_y * share;

  for (int i = 0; i < n; ++i) {
    double s, c;
    math.sine_cosine(px[i], s, c);
    const double v = v0 * Math::exponential(-b * py[i] * py[i]);
    fx[i] = spring_x - xi * ux[i] + v * kx * s;
    fy[i] = spring_y - xi * uy[i] + 2.0 * b * py[i] * v * c;
  }

  for (int i = 0; i < n; ++i) {
    const double xpos = px[i];
    const double ypos = py[i];
    const double* r0 = rest_length.data() + i * n;
    double fxi = fx[i];
    double fyi = fy[i];
    for (int j = i + 1; j < n; ++j) {
      const double dx = px[j] - xpos;
      const double dy = py[j] - ypos;
      const double r = std::sqrt(dx * dx + dy * dy);
      const double f = k_bond * (r - r0[j]) / r;
      fxi += f * dx;
      fyi += f * dy;
      fx[j] -= f * dx;
      fy[j] -= f * dy;
    }
    fx[i] = fxi * inverse_mass;
    fy[i] = fyi * inverse_mass;
  }
}

template <class Math>
[[gnu::noinline]] void FlexibleRing<Math>::advance(std::int64_t steps, double h) {
  advance_in_plane(*this, steps, h);
}

// ---- rigid ring ---------------------------------------------------------------------------------

template <class Math>
RigidRing<Math>::RigidRing(int particles, double ring_radius)
    : count(particles), radius(ring_radius), y(ring_radius) {
  for (int i = 0; i < count; ++i) {
    const double theta = 2.0 * std::numbers::pi * i / count;
    reference_x.push_back(radius * std::cos(theta));
    reference_y.push_back(radius * std::sin(theta));
  }
}

template <class Math>
auto RigidRing<Math>::acceleration(double px, double py, double angle, double ux, double uy,
                                   double spin, double t) const -> Acceleration {
  const Math math(period);
  const double v0 = amplitude / count;
  const double kx = 2.0 * std::numbers::pi / period;
  const double b = lambda / radius;
  const double inertia = mass * radius * radius;
  double sin_phi, cos_phi;
  Math::rotation(angle, sin_phi, cos_phi);

  double sum_x = 0.0;
  double sum_y = 0.0;
  double torque = 0.0;
  for (int i = 0; i < count; ++i) {
    const double rx = cos_phi * reference_x[i] - sin_phi * reference_y[i];
    const double ry = sin_phi * reference_x[i] + cos_phi * reference_y[i];
    const double site_y = py + ry;
    double s, c;
    math.sine_cosine(px + rx, s, c);
    const double v = v0 * Math::exponential(-b * site_y * site_y);
    const double fx = v * kx * s;
    const double fy = 2.0 * b * site_y * v * c;
    sum_x += fx;
    sum_y += fy;
    torque += rx * fy - ry * fx;
  }

  const double driver_x = stiffness * (speed * t - px);
  const double driver_y = stiffness * (radius - py);
  return {(driver_x - damping * ux + sum_x) / mass, (driver_y - damping * uy + sum_y) / mass,
          (torque - damping * radius * radius * spin) / inertia, driver_x, driver_y};
}

template <class Math>
[[gnu::noinline]] void RigidRing<Math>::advance(std::int64_t steps, double h) {
  const double half = 0.5 * h;
  const double sixth = h / 6.0;

  for (std::int64_t m = 0; m < steps; ++m) {
    const double t = static_cast<double>(done) * h;
    const Acceleration a1 = acceleration(x, y, phi, vx, vy, omega, t);

    const double vx2 = vx + half * a1.x;
    const double vy2 = vy + half * a1.y;
    const double om2 = omega + half * a1.phi;
    const Acceleration a2 =
        acceleration(x + half * vx, y + half * vy, phi + half * omega, vx2, vy2, om2, t + half);

    const double vx3 = vx + half * a2.x;
    const double vy3 = vy + half * a2.y;
    const double om3 = omega + half * a2.phi;
    const Acceleration a3 =
        acceleration(x + half * vx2, y + half * vy2, phi + half * om2, vx3, vy3, om3, t + half);

    const double vx4 = vx + h * a3.x;
    const double vy4 = vy + h * a3.y;
    const double om4 = omega + h * a3.phi;
    const Acceleration a4 =
        acceleration(x + h * vx3, y + h * vy3, phi + h * om3, vx4, vy4, om4, t + h);

    x += sixth * (vx + 2.0 * (vx2 + vx3) + vx4);
    y += sixth * (vy + 2.0 * (vy2 + vy3) + vy4);
    phi += sixth * (omega + 2.0 * (om2 + om3) + om4);
    vx += sixth * (a1.x + 2.0 * (a2.x + a3.x) + a4.x);
    vy += sixth * (a1.y + 2.0 * (a2.y + a3.y) + a4.y);
    omega += sixth * (a1.phi + 2.0 * (a2.phi + a3.phi) + a4.phi);
    force_integral_x += sixth * (a1.driver_x + 2.0 * (a2.driver_x + a3.driver_x) + a4.driver_x);
    force_integral_y += sixth * (a1.driver_y + 2.0 * (a2.driver_y + a3.driver_y) + a4.driver_y);
    ++done;
  }
}

// ---- rigid box in space -------------------------------------------------------------------------

template <class Math>
std::vector<std::array<double, 3>> RigidBox<Math>::positions() {
  constexpr double kSpacing = 0.4;
  std::vector<std::array<double, 3>> all;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 4; ++k) all.push_back({kSpacing * i, kSpacing * j, kSpacing * k});
    }
  }
  return all;
}

template <class Math>
RigidBox<Math>::RigidBox() : reference(positions()) {
  for (const auto& position : reference) {
    for (int d = 0; d < 3; ++d) start[d] += position[d] / static_cast<double>(reference.size());
  }
  for (auto& position : reference) {
    for (int d = 0; d < 3; ++d) position[d] -= start[d];
    for (int d = 0; d < 3; ++d) {
      const double one = position[(d + 1) % 3];
      const double other = position[(d + 2) % 3];
      inertia[d] += mass_each * (one * one + other * other);
    }
  }
  state.x = start;
  state.q = {1.0, 0.0, 0.0, 0.0};
}

template <class Math>
auto RigidBox<Math>::rates(const State& s, double t) const -> State {
  const Math math(period);
  const double kx = 2.0 * std::numbers::pi / period;
  const auto [a, b, c, d] = s.q;
  const double norm = 1.0 / (a * a + b * b + c * c + d * d);
  const double m[3][3] = {{1.0 - 2.0 * norm * (c * c + d * d), 2.0 * norm * (b * c - a * d),
                           2.0 * norm * (b * d + a * c)},
                          {2.0 * norm * (b * c + a * d), 1.0 - 2.0 * norm * (b * b + d * d),
                           2.0 * norm * (c * d - a * b)},
                          {2.0 * norm * (b * d - a * c), 2.0 * norm * (c * d + a * b),
                           1.0 - 2.0 * norm * (b * b + c * c)}};
  double spin[3];
  for (int k = 0; k < 3; ++k) spin[k] = m[k][0] * s.w[0] + m[k][1] * s.w[1] + m[k][2] * s.w[2];

  double sum[3] = {};
  double torque[3] = {};
  for (const auto& position : reference) {
    double r[3];
    for (int k = 0; k < 3; ++k) {
      r[k] = m[k][0] * position[0] + m[k][1] * position[1] + m[k][2] * position[2];
    }
    const double y = s.x[1] + r[1];
    double sine, cosine;
    math.sine_cosine(s.x[0] + r[0], sine, cosine);
    const double v = amplitude_each * Math::exponential(-decay * y * y);
    const double f[3] = {
        v * kx * sine - damping_each * (s.v[0] + spin[1] * r[2] - spin[2] * r[1]),
        2.0 * decay * y * v * cosine - damping_each * (s.v[1] + spin[2] * r[0] - spin[0] * r[2]),
        -damping_each * (s.v[2] + spin[0] * r[1] - spin[1] * r[0])};
    for (int k = 0; k < 3; ++k) sum[k] += f[k];
    torque[0] += r[1] * f[2] - r[2] * f[1];
    torque[1] += r[2] * f[0] - r[0] * f[2];
    torque[2] += r[0] * f[1] - r[1] * f[0];
  }

  State rate;
  const double mass = mass_each * static_cast<double>(reference.size());
  for (int k = 0; k < 3; ++k) {
    const double support = start[k] + (k == 0 ? speed * t : 0.0);
    rate.x[k] = s.v[k];
    rate.v[k] = (sum[k] + stiffness * (support - s.x[k])) / mass;
    const double along = m[0][k] * torque[0] + m[1][k] * torque[1] + m[2][k] * torque[2];
    const int one = (k + 1) % 3;
    const int other = (k + 2) % 3;
    rate.w[k] = (along - (inertia[other] - inertia[one]) * s.w[one] * s.w[other]) / inertia[k];
  }
  rate.q = {
      0.5 * (-b * s.w[0] - c * s.w[1] - d * s.w[2]), 0.5 * (a * s.w[0] + c * s.w[2] - d * s.w[1]),
      0.5 * (a * s.w[1] + d * s.w[0] - b * s.w[2]), 0.5 * (a * s.w[2] + b * s.w[1] - c * s.w[0])};
  return rate;
}

template <class Math>
[[gnu::noinline]] void RigidBox<Math>::advance(std::int64_t steps, double h) {
  const auto with = [](const State& s, double by, const State& rate) {
    State moved;
    for (int k = 0; k < 3; ++k) moved.x[k] = s.x[k] + by * rate.x[k];
    for (int k = 0; k < 3; ++k) moved.v[k] = s.v[k] + by * rate.v[k];
    for (int k = 0; k < 4; ++k) moved.q[k] = s.q[k] + by * rate.q[k];
    for (int k = 0; k < 3; ++k) moved.w[k] = s.w[k] + by * rate.w[k];
    return moved;
  };
  for (std::int64_t m = 0; m < steps; ++m) {
    const double t = static_cast<double>(done) * h;
    const State k1 = rates(state, t);
    const State k2 = rates(with(state, 0.5 * h, k1), t + 0.5 * h);
    const State k3 = rates(with(state, 0.5 * h, k2), t + 0.5 * h);
    const State k4 = rates(with(state, h, k3), t + h);
    state = with(with(state, h / 6.0, k1), h / 3.0, k2);
    state = with(with(state, h / 3.0, k3), h / 6.0, k4);
    ++done;
  }
}

// ---- chain --------------------------------------------------------------------------------------

template <class Math>
Chain<Math>::Chain(int particles, double spacing) : count(particles), rest_length(spacing) {
  for (std::vector<double>* a : {&x, &v, &xs, &vs, &acc, &sum_v, &sum_a}) a->assign(count, 0.0);
  for (int i = 0; i < count; ++i) x[i] = i * spacing;
  start_centre = 0.5 * (count - 1) * spacing;
}

// Returns the force of the driving spring. The chain cannot turn over in one dimension, so a bond
// needs no absolute value.
template <class Math>
double Chain<Math>::accelerations(const double* px, const double* pv, double t) {
  const Math math(period);
  const int n = count;
  const double k = bond_stiffness;
  const double r0 = rest_length;
  const double xi = damping_each;
  const double site = 2.0 * std::numbers::pi * amplitude_each / period;
  const double inverse_mass = 1.0 / mass_each;
  double* a = acc.data();

  double centre = 0.0;
  for (int i = 0; i < n; ++i) centre += px[i];
  centre /= n;
  const double driver = stiffness * (start_centre + speed * t - centre);
  const double spring = driver / n;

  double left = 0.0;  // each bond is evaluated once and handed on to its right end
  for (int i = 0; i < n - 1; ++i) {
    const double right = k * (px[i + 1] - px[i] - r0);
    a[i] = (spring + right - left - xi * pv[i] + site * math.sine(px[i])) * inverse_mass;
    left = right;
  }
  a[n - 1] = (spring - left - xi * pv[n - 1] + site * math.sine(px[n - 1])) * inverse_mass;
  return driver;
}

template <class Math>
[[gnu::noinline]] double Chain<Math>::energy() const {
  const Math math(period);
  double of_bonds = 0.0;
  for (int i = 0; i + 1 < count; ++i) {
    const double stretch = x[i + 1] - x[i] - rest_length;
    of_bonds += stretch * stretch;
  }
  double of_sites = 0.0;
  for (int i = 0; i < count; ++i) {
    double sine = 0.0;
    double cosine = 0.0;
    math.sine_cosine(x[i], sine, cosine);
    of_sites += cosine;
  }
  return 0.5 * bond_stiffness * of_bonds + amplitude_each * of_sites;
}

template <class Math>
[[gnu::noinline]] void Chain<Math>::advance(std::int64_t steps, double h) {
  const int n = count;
  const double half = 0.5 * h;
  const double sixth = h / 6.0;

  for (std::int64_t m = 0; m < steps; ++m) {
    const double t = static_cast<double>(done) * h;

    const double f1 = accelerations(x.data(), v.data(), t);
    for (int i = 0; i < n; ++i) {
      sum_v[i] = v[i];
      sum_a[i] = acc[i];
      xs[i] = x[i] + half * v[i];
      vs[i] = v[i] + half * acc[i];
    }

    const double f2 = accelerations(xs.data(), vs.data(), t + half);
    for (int i = 0; i < n; ++i) {
      sum_v[i] += 2.0 * vs[i];
      sum_a[i] += 2.0 * acc[i];
      xs[i] = x[i] + half * vs[i];
      vs[i] = v[i] + half * acc[i];
    }

    const double f3 = accelerations(xs.data(), vs.data(), t + half);
    for (int i = 0; i < n; ++i) {
      sum_v[i] += 2.0 * vs[i];
      sum_a[i] += 2.0 * acc[i];
      xs[i] = x[i] + h * vs[i];
      vs[i] = v[i] + h * acc[i];
    }

    const double f4 = accelerations(xs.data(), vs.data(), t + h);
    for (int i = 0; i < n; ++i) {
      x[i] += sixth * (sum_v[i] + vs[i]);
      v[i] += sixth * (sum_a[i] + acc[i]);
    }
    force_integral += sixth * (f1 + 2.0 * (f2 + f3) + f4);
    ++done;
  }
}

// ---- flake -------------------------------------------------------------------------------------

template <class Math>
Flake<Math>::Flake(int columns, int rows, double spacing) : PlaneParticles(columns * rows) {
  for (int i = 0; i < count; ++i) {
    x[i] = i % columns * spacing;
    y[i] = i / columns * spacing;
  }
  start_x = 0.5 * (columns - 1) * spacing;
  start_y = 0.5 * (rows - 1) * spacing;
}

// Numbers of one particle, or of eight.
template <class T>
static T taken(const double* from) {
  if constexpr (std::is_same_v<T, double>) {
    return *from;
  } else {
    return T::load_unaligned(from);
  }
}
static void put_down(double value, double* to) { *to = value; }
static void put_down(const Pack& value, double* to) { value.store_unaligned(to); }

template <class Math>
void Flake<Math>::accelerations(const double* px, const double* py, const double* ux,
                                const double* uy, double t, double& driver_x, double& driver_y) {
  using T = std::conditional_t<std::is_same_v<Math, OwnMath>, Pack, double>;
  constexpr int kAtOnce = sizeof(T) / sizeof(double);
  const Math along(period);
  const int n = count;
  double centre_x = 0.0;
  double centre_y = 0.0;
  for (int i = 0; i < n; ++i) {
    centre_x += px[i];
    centre_y += py[i];
  }
  driver_x = stiffness * (start_x + speed_x * t - centre_x / n);
  driver_y = stiffness * (start_y + speed_y * t - centre_y / n);
  const T spring_x(driver_x / n);
  const T spring_y(driver_y / n);
  const T damping(damping_each);
  const T tilt(1.0 / std::numbers::sqrt3);
  const T slope_x(2.0 * std::numbers::pi * amplitude_each / period);
  const T slope_y = tilt * slope_x;
  const T inverse_mass(1.0 / mass_each);
  for (int i = 0; i < n; i += kAtOnce) {
    const T across = tilt * taken<T>(py + i);
    T s1;
    T c1;
    T s2;
    T c2;
    along.sine_cosine(taken<T>(px + i) - across, s1, c1);
    along.sine_cosine(across + across, s2, c2);
    const T s3 = s1 * c2 + c1 * s2;
    const T force_x = slope_x * (s1 + s3);
    const T force_y = slope_y * (s2 + s2 + s3 - s1);
    put_down((spring_x - damping * taken<T>(ux + i) + force_x) * inverse_mass, &ax[i]);
    put_down((spring_y - damping * taken<T>(uy + i) + force_y) * inverse_mass, &ay[i]);
  }
}

template <class Math>
[[gnu::noinline]] void Flake<Math>::advance(std::int64_t steps, double h) {
  advance_in_plane(*this, steps, h);
}

// ---- bending -----------------------------------------------------------------------------------

Bending::Bending(int count, double radius) {
  for (std::vector<double>* a : {&x, &y, &fx, &fy}) a->assign(count, 0.0);
  for (int i = 0; i < count; ++i) {
    const double at = 2.0 * std::numbers::pi * i / count;
    x[i] = radius * std::cos(at);
    y[i] = radius * std::sin(at);
  }
}

// The angle turns with either bond, across it and by its inverse length.
[[gnu::noinline]] void Bending::evaluate() {
  const int n = static_cast<int>(x.size());
  for (int i = 0; i < n; ++i) fx[i] = fy[i] = 0.0;
  for (int i = 0; i < n; ++i) {
    const int before = i == 0 ? n - 1 : i - 1;
    const int behind = i + 1 == n ? 0 : i + 1;
    const double ax = x[before] - x[i];
    const double ay = y[before] - y[i];
    const double bx = x[behind] - x[i];
    const double by = y[behind] - y[i];
    const double signed_angle = std::atan2(ax * by - ay * bx, ax * bx + ay * by);
    const double slope = std::abs(signed_angle) - std::numbers::pi;
    const double turn = std::copysign(slope, signed_angle);
    const double of_a = turn / (ax * ax + ay * ay);
    const double of_b = turn / (bx * bx + by * by);
    const double fax = -of_a * ay;
    const double fay = of_a * ax;
    const double fbx = of_b * by;
    const double fby = -of_b * bx;
    fx[before] += fax;
    fy[before] += fay;
    fx[behind] += fbx;
    fy[behind] += fby;
    fx[i] -= fax + fbx;
    fy[i] -= fay + fby;
  }
}

// ---- one force ---------------------------------------------------------------------------------

template <class Math>
VariedSubstrate<Math>::VariedSubstrate(int count, double spacing) {
  for (std::vector<double>* a : {&x, &amplitude, &fx}) a->assign(count, 0.0);
  for (int i = 0; i < count; ++i) {
    x[i] = i * spacing;
    amplitude[i] = 0.05 + 0.01 * (i % 7);
  }
}

template <class Math>
[[gnu::noinline]] void VariedSubstrate<Math>::evaluate() {
  const Math along(1.0);
  const auto n = static_cast<int>(x.size());
  for (int i = 0; i < n; ++i) {
    fx[i] = 2.0 * std::numbers::pi * amplitude[i] * along.sine(x[i]);
  }
}

SplineSurface::SplineSurface(int points_along, int columns, int rows, double spacing)
    : points(points_along) {
  for (std::vector<double>* a : {&x, &y, &fx, &fy}) a->assign(columns * rows, 0.0);
  for (int i = 0; i < columns * rows; ++i) {
    x[i] = i % columns * spacing;
    y[i] = i / columns * spacing;
  }
  for (int i = 0; i < points * points; ++i) coefficient.push_back(0.1 * (i % 7) - 0.05 * (i % 11));
}

[[gnu::noinline]] void SplineSurface::evaluate() {
  const auto n = static_cast<int>(x.size());
  const auto weights = [](double f, double* w, double* s) {
    const double g = 1.0 - f;
    w[0] = g * g * g / 6.0;
    w[1] = (3.0 * f * f * f - 6.0 * f * f + 4.0) / 6.0;
    w[2] = (3.0 * g * g * g - 6.0 * g * g + 4.0) / 6.0;
    w[3] = f * f * f / 6.0;
    s[0] = -0.5 * g * g;
    s[1] = 0.5 * f * (3.0 * f - 4.0);
    s[2] = -0.5 * g * (3.0 * g - 4.0);
    s[3] = 0.5 * f * f;
  };
  for (int i = 0; i < n; ++i) {
    const double u = (x[i] - std::floor(x[i])) * points;
    const double v = (y[i] - std::floor(y[i])) * points;
    const int row = static_cast<int>(u);
    const int column = static_cast<int>(v);
    double wu[4];
    double su[4];
    double wv[4];
    double sv[4];
    weights(u - row, wu, su);
    weights(v - column, wv, sv);
    double along_u = 0.0;
    double along_v = 0.0;
    for (int m = 0; m < 4; ++m) {
      const double* line = coefficient.data() + (row + m) % points * points;
      double even = 0.0;
      double odd = 0.0;
      for (int k = 0; k < 4; ++k) {
        const double c = line[(column + k) % points];
        even += wv[k] * c;
        odd += sv[k] * c;
      }
      along_u += su[m] * even;
      along_v += wu[m] * odd;
    }
    fx[i] = -points * along_u;
    fy[i] = -points * along_v;
  }
}

DryFriction::DryFriction(int count) {
  for (std::vector<double>* a : {&vx, &vy, &fx, &fy}) a->assign(count, 0.0);
  for (int i = 0; i < count; ++i) {
    vx[i] = 0.01 * (i % 5);
    vy[i] = 0.01 * (i % 3);
  }
}

[[gnu::noinline]] void DryFriction::evaluate() {
  const auto n = static_cast<int>(vx.size());
  for (int i = 0; i < n; ++i) {
    const double scale = -force / std::sqrt(vx[i] * vx[i] + vy[i] * vy[i] + width * width);
    fx[i] = scale * vx[i];
    fy[i] = scale * vy[i];
  }
}

template struct VariedSubstrate<StdMath>;
template struct VariedSubstrate<OwnMath>;
template struct DraggedTip<StdMath, false>;
template struct DraggedTip<StdMath, true>;
template struct FlexibleRing<StdMath>;
template struct RigidRing<StdMath>;
template struct RigidBox<StdMath>;
template struct Chain<StdMath>;
template struct Flake<StdMath>;
template struct DraggedTip<OwnMath, false>;
template struct DraggedTip<OwnMath, true>;
template struct FlexibleRing<OwnMath>;
template struct RigidRing<OwnMath>;
template struct RigidBox<OwnMath>;
template struct Chain<OwnMath>;
template struct Flake<OwnMath>;

}  // namespace tomlin::plain
