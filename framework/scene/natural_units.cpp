#include "framework/scene/natural_units.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <string_view>
#include <variant>
#include <vector>

#include "framework/core/numbers/constants.hpp"

namespace tomlin {
namespace {

constexpr double kNoLength = std::numeric_limits<double>::infinity();

/// A length, or the root or inverse of a number that is a power of one; infinite for all else.
double as_length(const Dimension& dimension, double value) {
  const int power = std::abs(dimension.length);
  if (dimension.mass != 0 || dimension.time != 0 || !(value > 0.0)) return kNoLength;
  if (power != 1 && power != 2) return kNoLength;
  const double root = power == 1 ? value : std::sqrt(value);
  return dimension.length > 0 ? root : 1.0 / root;
}

/// Distances from zero.
std::vector<double> sizes_of(const PointList& points) {
  std::vector<double> sizes;
  for (std::size_t k = 0; k < points.count(); ++k) {
    double size = 0.0;
    for (std::size_t d = 0; d < points.dimension; ++d) {
      const double x = std::abs(points.coordinates[k * points.dimension + d]);
      const double larger = std::max(size, x);
      if (!(larger > 0.0)) continue;
      const double part = std::min(size, x) / larger;
      size = larger * std::sqrt(std::fma(part, part, 1.0));
    }
    sizes.push_back(size);
  }
  return sizes;
}

/// The plain numbers of a row, of the kinds that stand for sizes.
std::vector<double> numbers_of(const Parameter& row, const void* description) {
  const ParameterValue value = row.read(description);
  if (const auto* number = std::get_if<double>(&value)) return {*number};
  if (const auto* numbers = std::get_if<WordOrNumbers>(&value)) return numbers->numbers;
  if (const auto* numbers = std::get_if<PerParticle>(&value)) return numbers->values;
  if (const auto* points = std::get_if<PointList>(&value)) return sizes_of(*points);
  return {};
}

/// The size of a row's vectors.
double largest_vector(const Parameter& row, const void* description) {
  const ParameterValue value = row.read(description);
  std::vector<SpaceVector> vectors;
  if (const auto* vector = std::get_if<SpaceVector>(&value)) vectors = {*vector};
  if (const auto* list = std::get_if<PerParticleVector>(&value)) vectors = list->values;
  double largest = 0.0;
  for (const SpaceVector& vector : vectors) {
    for (const double x : vector.components) largest = std::max(largest, std::abs(x));
  }
  return largest;
}

class Search {
 public:
  explicit Search(const Scene& scene) : scene_(scene) {}

  NaturalUnits units() {
    find_length();
    find_time();
    if (!(found_.length > 0.0)) find_length_by_motion();
    return found_;
  }

 private:
  struct Body {
    double particle = kNoLength;  ///< mass of the lightest
    double total = 0.0;
    double friction = kNoLength;  ///< the smallest coefficient of a particle
    bool moves = true;            ///< by forces
  };

  double period_of(const SceneForce& force) const {
    double shortest = kNoLength;
    for (int d = 0; d < scene_.dimension; ++d) {
      const double period = force.record->period(force.description.get(), d);
      if (period > 0.0) shortest = std::min(shortest, period);
    }
    return shortest;
  }

  /// The smallest distance between particles that follow each other.
  double spacing_of(const SceneBody& body) const {
    double shortest = kNoLength;
    try {
      const BodyGeometry geometry = body.record->build(body.description.get(), scene_.dimension);
      const auto& point = geometry.relative;
      for (std::size_t i = 1; i < point.size(); ++i) {
        double square = 0.0;
        for (std::size_t d = 0; d < point[i].size(); ++d) {
          const double apart = point[i][d] - point[i - 1][d];
          square = std::fma(apart, apart, square);
        }
        if (square > 0.0) shortest = std::min(shortest, std::sqrt(square));
      }
    } catch (const std::exception&) {
      return kNoLength;  // binding says what is wrong with it
    }
    return shortest;
  }

  void take_length(double length, const char* what) {
    if (!std::isnormal(length)) return;
    found_.length = length;
    found_.length_of = what;
  }

  void find_length() {
    found_.length = 0.0;
    double shortest = kNoLength;
    for (const SceneForce& force : scene_.forces) shortest = std::min(shortest, period_of(force));
    if (shortest < kNoLength) return take_length(shortest, "the shortest period");
    for (const SceneForce& force : scene_.forces) shortest = std::min(shortest, length_of(force));
    const double of_forces = shortest;
    for (const SceneBody& body : scene_.bodies) {
      if (body.record->count(body.description.get()) > 1) {
        shortest = std::min(shortest, spacing_of(body));
      }
    }
    if (shortest < kNoLength) {
      return take_length(shortest, shortest < of_forces ? "the shortest distance of neighbours"
                                                        : "the shortest length of a force");
    }
    bool unknown = false;
    for (const SceneForce& force : scene_.forces) {
      if (!says_nothing(force)) continue;
      const double length = force.record->length(force.description.get());
      if (length > 0.0) {
        shortest = std::min(shortest, length);
      } else {
        unknown = true;
      }
    }
    if (shortest < kNoLength) return take_length(shortest, "the length of a formula");
    if (unknown) take_length(1.0, "the unit, since a formula declares no length");
  }

  /// No number of it has a dimension: its scales stand in a formula.
  bool says_nothing(const SceneForce& force) const {
    const auto has_number = [&force](const Parameter& row) {
      if (row.dimension == dimension::none) return false;
      const std::vector<double> numbers = numbers_of(row, force.description.get());
      const auto is_given = [](double x) { return std::isnormal(x); };
      return std::any_of(numbers.begin(), numbers.end(), is_given) ||
             largest_vector(row, force.description.get()) > 0.0;
    };
    const auto& rows = force.record->parameters;
    return std::none_of(rows.begin(), rows.end(), has_number);
  }

  double length_of(const SceneForce& force) const {
    double shortest = kNoLength;
    for (const Parameter& row : force.record->parameters) {
      for (const double x : numbers_of(row, force.description.get())) {
        shortest = std::min(shortest, as_length(row.dimension, x));
      }
    }
    return shortest;
  }

  /// The largest component of the vectors of that dimension.
  double largest_of(const Dimension& wanted) const {
    double largest = 0.0;
    const auto consider = [&](const auto& component) {
      for (const Parameter& row : component.record->parameters) {
        if (row.dimension != wanted) continue;
        largest = std::max(largest, largest_vector(row, component.description.get()));
      }
    };
    for (const SceneForce& force : scene_.forces) consider(force);
    for (const SceneBody& body : scene_.bodies) consider(body);
    return largest;
  }

  /// The largest speed that is given.
  double speed() const {
    double fastest = largest_of(dimension::velocity);
    for (const SceneBody& body : scene_.bodies) {
      if (!body.motion) continue;
      for (const TimeFunction& function : body.motion->velocity) {
        if (function.is_constant()) fastest = std::max(fastest, std::abs(function.constant));
      }
    }
    return fastest;
  }

  void find_length_by_motion() {
    take_length(speed() * found_.time,
                "the distance that the fastest component moves in the scene's time");
    if (found_.length > 0.0) return;
    take_length(largest_of(dimension::length), "the largest distance from the origin");
    if (found_.length > 0.0) return;
    found_.length = 1.0;
    found_.length_of = "the unit, since nothing in the scene has a length";
  }

  std::vector<Body> bodies() const {
    std::vector<Body> all;
    for (const SceneBody& from : scene_.bodies) {
      const BodyDescription& common = from.record->common(from.description.get());
      const auto count = static_cast<double>(from.record->count(from.description.get()));
      const std::vector<double>& masses = common.particle_mass.values;
      Body body;
      for (const double mass : masses) {
        body.particle = std::min(body.particle, mass);
        body.total += mass;
      }
      if (masses.size() == 1) body.total *= count;
      body.moves = follows_forces(common.coordinates);
      all.push_back(body);
    }
    for (const SceneForce& force : scene_.forces) {
      double coefficient = kNoLength;
      for (const Parameter& row : force.record->parameters) {
        if (row.dimension != dimension::friction) continue;
        for (const double x : numbers_of(row, force.description.get())) {
          if (x > 0.0) coefficient = std::min(coefficient, x);
        }
      }
      for (const std::size_t b : force.bodies) {
        all[b].friction = std::min(all[b].friction, coefficient);
      }
    }
    return all;
  }

  /// Per particle, or of all particles together where it acts on their centre.
  struct Stiffness {
    double value = 0.0;
    bool of_centre = false;
  };

  Stiffness stiffness_of(const SceneForce& force) const {
    const void* description = force.description.get();
    double length = period_of(force) / kTau;
    if (!(length < kNoLength)) length = length_of(force);
    Stiffness found;
    for (const Parameter& row : force.record->parameters) {
      const ParameterValue value = row.read(description);
      if (const auto* attachment = std::get_if<Attachment>(&value)) {
        found.of_centre = attachment->kind == Attachment::Kind::centre_of_mass;
      }
      for (const double x : numbers_of(row, description)) {
        if (row.dimension == dimension::stiffness) found.value = std::max(found.value, x);
        if (row.dimension == dimension::energy && length < kNoLength) {
          found.value = std::max(found.value, std::abs(x) / length / length);
        }
      }
    }
    return found;
  }

  void take_time(double time, double mass, const char* what) {
    if (!std::isnormal(time)) return;
    found_.time = time;
    found_.mass = mass;
    found_.time_of = what;
  }

  /// Forces that tell the time, in this order.
  enum class Kind { periodic, outer, internal };

  Kind kind_of(const SceneForce& force) const {
    if (force.bodies.size() == 1 && force.traits().internal) return Kind::internal;
    return period_of(force) < kNoLength ? Kind::periodic : Kind::outer;
  }

  /// The fastest swing (without inertia, decay) by forces of one kind, unless it is slower than the
  /// run. A driver that hardly gives way says nothing of how fast a scene moves over a corrugation.
  void find_swing(const std::vector<Body>& bodies, Kind kind) {
    double fastest = kNoLength;
    double stiffness = 0.0;
    const bool inertial = scene_.run.dynamics == Dynamics::inertial;
    for (const SceneForce& force : scene_.forces) {
      if (kind_of(force) != kind) continue;
      const Stiffness own = stiffness_of(force);
      for (const std::size_t b : force.bodies) {
        const Body& body = bodies[b];
        if (!body.moves) continue;
        const double share = own.of_centre ? body.total / body.particle : 1.0;
        const double rate = own.value / share / (inertial ? body.particle : body.friction);
        const double time = 1.0 / (inertial ? std::sqrt(rate) : rate);
        if (!(time < fastest)) continue;
        fastest = time;
        stiffness = own.value;
      }
    }
    if (!(fastest <= scene_.run.duration)) return;
    take_time(fastest, stiffness * fastest * fastest,
              inertial ? "1/sqrt(stiffness/mass)" : "friction/stiffness");
  }

  /// A rigid body does, by its own gyroscopic forces, however little friction there is.
  bool rotates_in_space() const {
    return std::any_of(scene_.bodies.begin(), scene_.bodies.end(), [this](const SceneBody& body) {
      const void* description = body.description.get();
      return scene_.dimension == 3 && body.record->count(description) > 1 &&
             body.record->common(description).coordinates == Coordinates::rigid &&
             std::find(body.hold.begin(), body.hold.end(), "rotation") == body.hold.end();
    });
  }

  void find_time() {
    const std::vector<Body> all = bodies();
    double lightest = kNoLength;
    double damping = 0.0;
    for (const Body& body : all) {
      if (!(body.particle < kNoLength)) continue;
      lightest = std::min(lightest, body.total);
      if (body.moves && body.friction < kNoLength) {
        damping = std::max(damping, body.friction / body.particle);
      }
    }
    found_.time = 0.0;
    if (scene_.run.dynamics != Dynamics::quasistatic) {
      for (const Kind kind : {Kind::periodic, Kind::outer, Kind::internal}) {
        if (!(found_.time > 0.0)) find_swing(all, kind);
      }
      if (!(found_.time > 0.0) && damping > 0.0 && scene_.run.dynamics == Dynamics::inertial) {
        const double motion = found_.length / speed();
        if (rotates_in_space() && motion < 1.0 / damping) {
          take_time(motion, lightest, "the length by the largest speed");
        } else {
          take_time(1.0 / damping, lightest, "mass/friction");
        }
      }
    }
    const double mass = std::isnormal(lightest) ? lightest : 1.0;
    if (!(found_.time > 0.0) && found_.length > 0.0) {
      take_time(found_.length / speed(), mass, "the length by the largest speed");
    }
    if (!(found_.time > 0.0)) take_time(scene_.run.duration, mass, "the run's duration");
    if (!(found_.time > 0.0)) take_time(1.0, mass, "the unit, since nothing has a time");
  }

  const Scene& scene_;
  NaturalUnits found_;
};

double power(double x, int n) {
  double result = 1.0;
  for (int k = 0; k < std::abs(n); ++k) result = n < 0 ? result / x : result * x;
  return result;
}

}  // namespace

double NaturalUnits::of(const Dimension& dimension) const {
  const int energies = dimension.temperature;  // mass length^2/time^2
  return power(mass, dimension.mass + energies) * power(length, dimension.length + 2 * energies) *
         power(time, dimension.time - 2 * energies);
}

NaturalUnits natural_units(const Scene& scene) { return Search(scene).units(); }

bool has_natural_default(const Parameter& row) {
  if (row.dimension != dimension::length && row.dimension != dimension::time) return false;
  if (!row.standard) return false;
  const auto* number = std::get_if<double>(&*row.standard);
  return number != nullptr && *number > 0.0 && *number < kNoBound;
}

std::string natural_unit_text(const Parameter& row) {
  if (!has_natural_default(row)) return "";
  return row.dimension == dimension::length ? " of the scene's length" : " of the scene's time";
}

double natural_default(const Parameter& row, const NaturalUnits& units) {
  const double standard = std::get<double>(*row.standard);
  return has_natural_default(row) ? standard * units.of(row.dimension) : standard;
}

std::optional<double> tolerance_of(const SceneIntegrator& integrator, double length) {
  const IntegratorRecord& record = *integrator.record;
  if (record.tolerance == nullptr) return std::nullopt;
  std::optional<double> largest;
  for (const Parameter& row : record.parameters) {
    if (!std::string_view(row.key).ends_with("tolerance")) continue;
    const ParameterValue value = row.read(integrator.description.get());
    const auto* number = std::get_if<double>(&value);
    if (number == nullptr) continue;
    const double part = row.dimension == dimension::length ? *number / length : *number;
    largest = std::max(largest.value_or(0.0), part);
  }
  return largest ? *largest : record.tolerance(integrator.description.get());
}

}  // namespace tomlin
