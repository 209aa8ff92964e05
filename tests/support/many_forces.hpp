#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/numbers/constants.hpp"
#include "tests/support/scenes.hpp"

/// Random scenes of several bodies and many forces, and what these forces are: written down a
/// second time, particle by particle and pair by pair, from the equations and without the program.
namespace tomlin::test {

class ManyForces {
 public:
  using Point = std::array<double, 3>;

  struct Body {
    std::string name;
    std::string coordinates;  ///< "particles", "rigid", "fixed" or "prescribed"
    std::vector<std::string> hold;
    std::vector<Point> start;
    std::vector<double> mass;
    Point velocity{};  ///< of a prescribed one
    double angular_velocity = 0.0;

    // Now.
    std::vector<Point> x;
    std::vector<Point> v;
    // The force on each particle, and the size of the terms that it is made of.
    std::vector<Point> force;
    std::vector<Point> size;

    Point mean(const std::vector<Point>& of) const {
      Point mean{};
      double total = 0.0;
      for (const double m : mass) total += m;
      for (std::size_t i = 0; i < of.size(); ++i) {
        for (std::size_t d = 0; d < 3; ++d) mean[d] += mass[i] / total * of[i][d];
      }
      return mean;
    }
  };

  explicit ManyForces(std::uint64_t seed) : engine_(seed) {
    dimension = 1 + static_cast<int>(below(3));
    if (below(3) == 0) box = 8.0;
    const std::size_t count = 1 + below(3);
    for (std::size_t b = 0; b < count; ++b) add_body(b);
    const std::size_t forces = 2 + below(8);
    for (std::size_t k = 0; k < forces; ++k) add_force(k);
  }

  std::string text() const {
    std::string all;
    if (box > 0.0) {
      std::string lengths = digits(box);
      std::string periodic = "true";
      for (int d = 1; d < dimension; ++d) lengths += ", 9.0", periodic += ", false";
      all += "[box]\nlengths = [" + lengths + "]\nperiodic = [" + periodic + "]\n";
    }
    for (const Body& body : bodies) all += text_of(body);
    return all + forces_ +
           "[run]\nduration = 1.0\nallow_unstable = true\n"
           "integrator = { type = \"rk4\", dt = 1e-3 }\n";
  }

  /// Computes all forces on the particles at their positions.
  void evaluate(double time) {
    for (Body& body : bodies) {
      body.force.assign(body.x.size(), Point{});
      body.size.assign(body.x.size(), Point{});
    }
    for (const auto& law : laws_) law(time);
  }

  double uniform(double least, double most) {
    constexpr double kSteps = 9007199254740992.0;  // 2^53
    return least + (most - least) * (static_cast<double>(engine_() >> 11) / kSteps);
  }
  std::size_t below(std::size_t n) { return engine_() % n; }

  int dimension = 1;
  double box = 0.0;  ///< along x
  std::vector<Body> bodies;

 private:
  using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

  std::size_t axes() const { return static_cast<std::size_t>(dimension); }

  std::string vector_of(const Point& point) const {
    std::string list = "[" + digits(point[0]);
    for (std::size_t d = 1; d < axes(); ++d) list += ", " + digits(point[d]);
    return list + "]";
  }

  std::string text_of(const Body& body) const {
    std::string positions;
    std::string masses;
    for (std::size_t i = 0; i < body.start.size(); ++i) {
      positions += (i == 0 ? "" : ", ") + vector_of(body.start[i]);
      masses += (i == 0 ? "" : ", ") + digits(body.mass[i]);
    }
    std::string all =
        "[[body]]\nname = \"" + body.name + "\"\ntype = \"particles\"\npositions = [" + positions +
        "]\nparticle_mass = [" + masses + "]\ncoordinates = \"" + body.coordinates + "\"\n";
    if (body.coordinates == "prescribed") {
      all += "motion = { velocity = " + vector_of(body.velocity);
      if (dimension == 2) all += ", angular_velocity = " + digits(body.angular_velocity);
      all += " }\n";
    }
    std::string held;
    for (const std::string& axis : body.hold) held += (held.empty() ? "\"" : ", \"") + axis + "\"";
    if (!held.empty()) all += "hold = [" + held + "]\n";
    return all;
  }

  void add_body(std::size_t index) {
    static const char* const kKinds[] = {"particles", "particles", "rigid",
                                         "rigid",     "fixed",     "prescribed"};
    Body body;
    body.name = std::string(1, static_cast<char>('a' + index));
    body.coordinates = index == 0 ? kKinds[below(4)] : kKinds[below(6)];
    // Fewer than a group of eight, a whole one, and more.
    const std::size_t count = 1 + below(11);
    const Point centre = {uniform(-2.0, 2.0), uniform(-1.0, 1.0), uniform(-1.0, 1.0)};
    for (std::size_t i = 0; i < count; ++i) {
      Point position{};
      for (std::size_t d = 0; d < axes(); ++d) position[d] = centre[d] + uniform(-1.5, 1.5);
      body.start.push_back(position);
      body.mass.push_back(uniform(0.5, 2.0));
    }
    const bool moves = body.coordinates == "particles" || body.coordinates == "rigid";
    if (moves && below(4) == 0) body.hold.push_back("x");
    if (body.coordinates == "rigid" && dimension == 3) body.hold.push_back("rotation");
    if (body.coordinates == "rigid" && dimension == 2 && below(4) == 0) {
      body.hold.push_back("rotation");
    }
    for (std::size_t d = 0; d < axes(); ++d) body.velocity[d] = uniform(-0.5, 0.5);
    if (dimension == 2) body.angular_velocity = uniform(-1.0, 1.0);
    bodies.push_back(std::move(body));
  }

  // ---- forces

  void push(std::size_t b, std::size_t i, std::size_t d, double force) {
    bodies[b].force[i][d] += force;
    bodies[b].size[i][d] += std::abs(force);
  }

  void add_force(std::size_t index) {
    const std::size_t b = below(bodies.size());
    const std::string name = "f" + std::to_string(index);
    forces_ += "[[force]]\nname = \"" + name + "\"\n";
    const auto on = [&] { forces_ += "body = \"" + bodies[b].name + "\"\n"; };
    const bool bends = dimension > 1 && bodies[b].start.size() > 2;
    switch (below(bends ? 13 : 12)) {
      case 0:
        on();
        return constant(b);
      case 1:
        on();
        return substrate(b);
      case 2:
        on();
        return damping(b);
      case 3:
      case 4:
        on();
        return driver(b);
      case 5:
        on();
        return memory();
      case 6:
        on();
        return field(b);
      case 7:
        on();
        return flow(b);
      case 8:
        on();
        return of_centre(b);
      case 9:
      case 10:
      case 11:
        return pairs(b);
      default:
        on();
        return angles(b);
    }
  }

  void constant(std::size_t b) {
    Point force{};
    for (std::size_t d = 0; d < axes(); ++d) force[d] = uniform(-1.0, 1.0);
    forces_ += "type = \"constant_force\"\nforce = " + vector_of(force) + "\n";
    laws_.push_back([this, b, force](double) {
      for (std::size_t i = 0; i < bodies[b].x.size(); ++i) {
        for (std::size_t d = 0; d < axes(); ++d) push(b, i, d, force[d]);
      }
    });
  }

  void substrate(std::size_t b) {
    const double amplitude = uniform(0.1, 0.5);
    const double period = below(2) == 0 ? 1.0 : 2.0;  // of the box, too
    const double decay = dimension > 1 ? uniform(0.0, 1.0) : 0.0;
    forces_ += "type = \"sinusoidal_substrate\"\namplitude = " + digits(amplitude) +
               "\nperiod = " + digits(period) + "\n";
    if (dimension > 1) forces_ += "decay = " + digits(decay) + "\n";
    laws_.push_back([=, this](double) {
      for (std::size_t i = 0; i < bodies[b].x.size(); ++i) {
        const double x = bodies[b].x[i][0];
        const double y = dimension > 1 ? bodies[b].x[i][1] : 0.0;
        const double height = amplitude * std::exp(-decay * y * y);
        push(b, i, 0, height * kTau / period * std::sin(kTau * x / period));
        if (dimension > 1) push(b, i, 1, 2.0 * decay * y * height * std::cos(kTau * x / period));
      }
    });
  }

  void damping(std::size_t b) {
    const double coefficient = uniform(0.1, 2.0);
    forces_ += "type = \"viscous_damping\"\ncoefficient = " + digits(coefficient) + "\n";
    laws_.push_back([=, this](double) {
      for (std::size_t i = 0; i < bodies[b].x.size(); ++i) {
        for (std::size_t d = 0; d < axes(); ++d) push(b, i, d, -coefficient * bodies[b].v[i][d]);
      }
    });
  }

  /// Its own variables are zero at the start, and so is what it does.
  void memory() { forces_ += "type = \"memory_damping\"\ncoefficient = 0.7\nmemory_time = 0.4\n"; }

  void driver(std::size_t b) {
    const double stiffness = uniform(0.5, 3.0);
    Point velocity{};
    for (std::size_t d = 0; d < axes(); ++d) velocity[d] = uniform(-0.5, 0.5);
    const std::size_t kind = below(3);
    const std::size_t particle = below(bodies[b].start.size());
    const std::string attach = kind == 0   ? "\"centre_of_mass\""
                               : kind == 1 ? "\"each_particle\""
                                           : "{ particle = " + std::to_string(particle) + " }";
    forces_ += "type = \"driving_spring\"\nstiffness = " + digits(stiffness) +
               "\nvelocity = " + vector_of(velocity) + "\nattach = " + attach + "\n";
    laws_.push_back([=, this](double time) {
      Body& body = bodies[b];
      const Point from = body.mean(body.start);
      const Point centre = body.mean(body.x);
      double total = 0.0;
      for (const double m : body.mass) total += m;
      for (std::size_t i = 0; i < body.x.size(); ++i) {
        for (std::size_t d = 0; d < axes(); ++d) {
          const double way = velocity[d] * time;
          if (kind == 0) {
            push(b, i, d, body.mass[i] / total * stiffness * (from[d] + way - centre[d]));
          } else if (kind == 1 || i == particle) {
            push(b, i, d, stiffness * (body.start[i][d] + way - body.x[i][d]));
          }
        }
      }
    });
  }

  /// A formula of positions: V = c sin(1.1 x) (cos(0.7 y)).
  void field(std::size_t b) {
    const double c = uniform(0.1, 0.5);
    forces_ += "type = \"expression\"\nenergy = \"" + digits(c) + " * sin(1.1*x)" +
               (dimension > 1 ? " * cos(0.7*y)" : "") + "\"\n";
    laws_.push_back([=, this](double) {
      for (std::size_t i = 0; i < bodies[b].x.size(); ++i) {
        const double x = bodies[b].x[i][0];
        const double y = dimension > 1 ? bodies[b].x[i][1] : 0.0;
        push(b, i, 0, -1.1 * c * std::cos(1.1 * x) * std::cos(0.7 * y));
        if (dimension > 1) push(b, i, 1, 0.7 * c * std::sin(1.1 * x) * std::sin(0.7 * y));
      }
    });
  }

  /// A formula of velocities, positions and time.
  void flow(std::size_t b) {
    const double c = uniform(0.1, 0.5);
    static const char* const kAxes[] = {"x", "y", "z"};
    forces_ += "type = \"expression\"\nforce = [";
    for (std::size_t d = 0; d < axes(); ++d) {
      forces_ += std::string(d == 0 ? "\"" : ", \"") + digits(c) + " * t - v" + kAxes[d] +
                 " * (1 + " + kAxes[d] + "^2)\"";
    }
    forces_ += "]\n";
    laws_.push_back([=, this](double time) {
      for (std::size_t i = 0; i < bodies[b].x.size(); ++i) {
        for (std::size_t d = 0; d < axes(); ++d) {
          const double x = bodies[b].x[i][d];
          push(b, i, d, c * time);
          push(b, i, d, -bodies[b].v[i][d] * (1.0 + x * x));
        }
      }
    });
  }

  /// A formula of the centre of mass: V = c xc^2 (+ 0.3 xc yc).
  void of_centre(std::size_t b) {
    const double c = uniform(-1.0, 1.0);
    forces_ += "type = \"expression\"\nenergy = \"" + digits(c) + " * xc^2" +
               (dimension > 1 ? " + 0.3 * xc * yc" : "") + "\"\n";
    laws_.push_back([=, this](double) {
      const Body& body = bodies[b];
      const Point centre = body.mean(body.x);
      const double y = dimension > 1 ? centre[1] : 0.0;
      double total = 0.0;
      for (const double m : body.mass) total += m;
      for (std::size_t i = 0; i < body.x.size(); ++i) {
        push(b, i, 0, -body.mass[i] / total * (2.0 * c * centre[0] + 0.3 * y));
        if (dimension > 1) push(b, i, 1, -body.mass[i] / total * 0.3 * centre[0]);
      }
    });
  }

  /// Bonds and formulas of r, within a body or between two.
  void pairs(std::size_t b) {
    std::size_t other = below(bodies.size());
    Pairs chosen;
    const std::size_t n = bodies[b].start.size();
    std::string selection;
    bool neighbours = false;
    if (other != b) {
      selection = "pairs = \"all\"\n";
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < bodies[other].start.size(); ++j) chosen.emplace_back(i, j);
      }
      forces_ += "bodies = [\"" + bodies[b].name + "\", \"" + bodies[other].name + "\"]\n";
    } else if (n > 2 && below(3) == 0) {
      selection = "pairs = [[0, " + std::to_string(n - 1) + "], [1, 0]]\n";
      chosen = {{0, n - 1}, {1, 0}};
    } else if (below(2) == 0) {
      selection = "pairs = \"all\"\n";
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 1; j < n; ++j) chosen.emplace_back(i, j);
      }
    } else {
      selection = "pairs = \"neighbours\"\n";  // of particles in a list: nothing closes them
      neighbours = true;
      for (std::size_t i = 0; i + 1 < n; ++i) chosen.emplace_back(i, i + 1);
    }
    if (other == b) forces_ += "body = \"" + bodies[b].name + "\"\n";
    forces_ += selection;
    const double k = uniform(0.2, 2.0);
    const std::size_t kind = below(4);
    const double rest = kind == 1 ? 0.0 : uniform(0.3, 1.5);
    std::function<double(double)> tension;
    if (kind < 2) {
      forces_ += "type = \"harmonic_bonds\"\nstiffness = " + digits(k) +
                 "\nrest_lengths = " + digits(rest) + "\n";
      tension = [k, rest](double r) { return k * (r - rest); };
    } else if (kind == 2) {
      forces_ += "type = \"morse_bonds\"\ndepth = " + digits(k) +
                 "\ninverse_width = 0.8\nrest_lengths = " + digits(rest) + "\n";
      tension = [k, rest](double r) {
        const double e = std::exp(-0.8 * (r - rest));
        return 2.0 * k * 0.8 * e * (1.0 - e);
      };
    } else {
      forces_ += "type = \"expression\"\nenergy = \"" + digits(k) + " / (1 + r^2)\"\n";
      tension = [k](double r) { return -2.0 * k * r / ((1.0 + r * r) * (1.0 + r * r)); };
    }
    const bool keeps = kind < 3;
    laws_.push_back([=, this](double) {
      for (const auto& [i, j] : chosen) {
        Point apart{};
        double square = 0.0;
        for (std::size_t d = 0; d < axes(); ++d) {
          apart[d] = bodies[other].x[j][d] - bodies[b].x[i][d];
          if (d == 0 && box > 0.0 && !neighbours) {
            // A bond is that of the nearest images at the start, a potential that of today's.
            const double of = keeps ? bodies[other].start[j][0] - bodies[b].start[i][0] : apart[0];
            apart[0] -= box * std::nearbyint(of / box);
          }
          square += apart[d] * apart[d];
        }
        const double r = std::sqrt(square);
        for (std::size_t d = 0; d < axes(); ++d) {
          const double pull = tension(r) * apart[d] / r;
          push(b, i, d, pull);
          push(other, j, d, -pull);
        }
      }
    });
  }

  /// A formula of the angles between neighbours: V = c (theta - 2)^2, by differences in long
  /// doubles, whose error falls as h^6.
  void angles(std::size_t b) {
    const double c = uniform(0.1, 0.5);
    forces_ += "type = \"expression\"\nenergy = \"" + digits(c) + " * (theta - 2)^2\"\n";
    laws_.push_back([=, this](double) {
      using Real = long double;
      const auto energy = [&](const std::array<std::array<Real, 3>, 3>& at) {
        Real dot = 0.0L;
        Real first = 0.0L;
        Real last = 0.0L;
        for (std::size_t d = 0; d < 3; ++d) {
          const Real s = at[0][d] - at[1][d];
          const Real u = at[2][d] - at[1][d];
          dot += s * u;
          first += s * s;
          last += u * u;
        }
        const Real theta = std::acos(dot / std::sqrt(first * last));
        return static_cast<Real>(c) * (theta - 2.0L) * (theta - 2.0L);
      };
      for (std::size_t middle = 1; middle + 1 < bodies[b].x.size(); ++middle) {
        std::array<std::array<Real, 3>, 3> at{};
        for (std::size_t p = 0; p < 3; ++p) {
          for (std::size_t d = 0; d < axes(); ++d) at[p][d] = bodies[b].x[middle + p - 1][d];
          // The images of the start.
          if (p != 1 && box > 0.0) {
            const double of = bodies[b].start[middle + p - 1][0] - bodies[b].start[middle][0];
            at[p][0] -= static_cast<Real>(box * std::nearbyint(of / box));
          }
        }
        for (std::size_t p = 0; p < 3; ++p) {
          for (std::size_t d = 0; d < axes(); ++d) {
            constexpr Real h = 1e-4L;
            constexpr Real kWeight[] = {0.75L, -0.15L, 1.0L / 60.0L};
            Real slope = 0.0L;
            for (int k = 1; k <= 3; ++k) {
              auto ahead = at;
              auto behind = at;
              ahead[p][d] += k * h;
              behind[p][d] -= k * h;
              slope += kWeight[k - 1] * (energy(ahead) - energy(behind)) / h;
            }
            push(b, middle + p - 1, d, static_cast<double>(-slope));
          }
        }
      }
    });
  }

  std::mt19937_64 engine_;
  std::string forces_;
  std::vector<std::function<void(double)>> laws_;
};

}  // namespace tomlin::test
