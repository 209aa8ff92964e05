#include "framework/bodies/ellipse.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "framework/bodies/outline.hpp"
#include "framework/core/numbers/math.hpp"

namespace tomlin {
namespace {

using Description = EllipseDescription;

/// Ratio of the semi-axes below which arc lengths are not tested.
constexpr double kLeastAxisRatio = 1e-9;

/// Carlson's symmetric integrals R_F(x, y, z) and R_D(x, y, z) for z > 0 and at most one 0.
struct CarlsonIntegrals {
  double f = 0.0;
  double d = 0.0;
};

/// Each duplication brings the arguments together by a factor of 4; what the series leaves out is
/// of the sixth order in what they differ by.
CarlsonIntegrals carlson_integrals(double x, double y, double z) {
  constexpr double kRelativeSpread = 1e-3;
  double sum = 0.0;
  double weight = 1.0;
  for (;;) {
    const double mean = (x + y + z) / 3.0;
    const double apart = max(abs(mean - x), max(abs(mean - y), abs(mean - z)));
    if (apart < kRelativeSpread * mean) break;
    const double root_x = sqrt(x);
    const double root_y = sqrt(y);
    const double root_z = sqrt(z);
    const double lambda = fma(root_x, root_y, root_z * (root_x + root_y));
    sum += weight / (root_z * (z + lambda));
    weight *= 0.25;
    x = 0.25 * (x + lambda);
    y = 0.25 * (y + lambda);
    z = 0.25 * (z + lambda);
  }
  CarlsonIntegrals result;
  {
    const double mean = (x + y + z) / 3.0;
    const double u = 1.0 - x / mean;
    const double v = 1.0 - y / mean;
    const double w = -(u + v);
    const double e2 = u * v - w * w;
    const double e3 = u * v * w;
    const double series =
        1.0 + e2 * (-1.0 / 10.0 + e2 / 24.0) + e3 * (1.0 / 14.0 - 3.0 * e2 / 44.0);
    result.f = series / sqrt(mean);
  }
  {
    const double mean = (x + y + 3.0 * z) / 5.0;
    const double u = 1.0 - x / mean;
    const double v = 1.0 - y / mean;
    const double w = -(u + v) / 3.0;
    const double uv = u * v;
    const double w2 = w * w;
    const double e2 = uv - 6.0 * w2;
    const double e3 = (3.0 * uv - 8.0 * w2) * w;
    const double e4 = 3.0 * (uv - w2) * w2;
    const double e5 = uv * w2 * w;
    const double series = 1.0 - 3.0 * e2 / 14.0 + e3 / 6.0 + 9.0 * e2 * e2 / 88.0 -
                          3.0 * e4 / 22.0 - 9.0 * e2 * e3 / 52.0 + 3.0 * e5 / 26.0;
    result.d = fma(3.0, sum, weight * series / (mean * sqrt(mean)));
  }
  return result;
}

/// A quarter of an ellipse, from an end of its minor axis to one of the major axis. Lengths are in
/// units of the major semi-axis, angles are parametric ones.
class EllipseArc {
 public:
  explicit EllipseArc(double ratio)
      : complement_(ratio * ratio),
        square_((1.0 - ratio) * (1.0 + ratio)),
        quarter_(length(1, 0)) {}

  double quarter() const { return quarter_; }

  /// Sine and cosine of the angle up to which a part of the quarter reaches, 0 to 1.
  void find(double part, double& sine, double& cosine) const {
    const double wanted = part * quarter_;
    // The length bends downwards, and is at most the angle: Newton's steps approach from below,
    // and never pass the angle but by rounding.
    double turns = wanted / kTau;
    for (;;) {
      sincos_turns(turns, sine, cosine);
      const double slope = kTau * sqrt(speed_squared(sine, cosine));
      const double next = std::min(turns + (wanted - length(sine, cosine)) / slope, 0.25);
      if (!(next > turns)) return;
      turns = next;
    }
  }

 private:
  double speed_squared(double sine, double cosine) const {
    return fma(complement_ * sine, sine, cosine * cosine);
  }

  /// E(phi, k), DLMF 19.25.10 by the homogeneity of the integrals; square_ is k^2.
  double length(double sine, double cosine) const {
    const double speed_2 = speed_squared(sine, cosine);
    const CarlsonIntegrals integral = carlson_integrals(cosine * cosine, 1.0, speed_2);
    const double inner = fma(square_ * sine * sine / 3.0, integral.d, integral.f);
    return sine * fma(complement_, inner, square_ * cosine / sqrt(speed_2));
  }

  double complement_;  ///< 1 - k^2
  double square_;
  double quarter_;
};

double first(const Description& d) { return d.semi_axes.numbers[0]; }
double second(const Description& d) { return d.semi_axes.numbers[1]; }
double major(const Description& d) { return max(first(d), second(d)); }
EllipseArc arc_of(const Description& d) { return EllipseArc(min(first(d), second(d)) / major(d)); }

std::vector<Complaint> complaints(const Description& d, int dimension) {
  std::vector<Complaint> found = complaints_without_plane("an ellipse", dimension);
  const std::vector<double>& axes = d.semi_axes.numbers;
  if (axes.size() != 2) {
    found.push_back({.key = "semi_axes",
                     .why = fmt::format("{} given", axes.size()),
                     .admissible = "two numbers, along its first and along its second axis",
                     .code = FaultCode::scene_wrong_count});
  } else if (min(axes[0], axes[1]) < kLeastAxisRatio * major(d)) {
    found.push_back(
        {.key = "semi_axes",
         .why = "the ellipse is so thin that arc lengths along it are not reliable",
         .admissible = fmt::format("a ratio of at least {:g}; a chain is a line", kLeastAxisRatio),
         .code = FaultCode::scene_out_of_range});
  }
  return found;
}

/// Sine and cosine of the parametric angle of particle i.
class EllipseAngles {
 public:
  explicit EllipseAngles(const Description& d)
      : arc_(arc_of(d)), count_(d.count), spacing_(d.spacing), wide_(first(d) >= second(d)) {}

  void find(std::int64_t i, double& sine, double& cosine) const {
    if (spacing_ == EllipseSpacing::angle) {
      sincos_turns(static_cast<double>(i) / static_cast<double>(count_), sine, cosine);
      return;
    }
    // Quarters are mirror images of each other, to the bit.
    const std::int64_t quarter = 4 * i / count_;
    const std::int64_t beyond = 4 * i - quarter * count_;
    const bool backwards = quarter % 2 == 1;
    in_first_quarter(backwards ? count_ - beyond : beyond, sine, cosine);
    if (quarter == 1 || quarter == 2) cosine = -cosine;
    if (quarter >= 2) sine = -sine;
  }

 private:
  /// `parts` of the quarter's count_ from the first axis.
  void in_first_quarter(std::int64_t parts, double& sine, double& cosine) const {
    const std::int64_t from_minor = wide_ ? count_ - parts : parts;
    const double part = static_cast<double>(from_minor) / static_cast<double>(count_);
    double to_major = 0.0;
    double to_minor = 1.0;
    if (from_minor == count_) {
      to_major = 1.0;
      to_minor = 0.0;
    } else if (from_minor > 0) {
      arc_.find(part, to_major, to_minor);
    }
    cosine = wide_ ? to_major : to_minor;
    sine = wide_ ? to_minor : to_major;
  }

  EllipseArc arc_;
  std::int64_t count_;
  EllipseSpacing spacing_;
  bool wide_;  ///< its first axis is the major one
};

BodyGeometry build(const Description& d, int dimension) {
  const EllipseAngles angles(d);
  std::vector<PlanePoint> points(static_cast<std::size_t>(d.count));
  for (std::size_t i = 0; i < points.size(); ++i) {
    double sine = 0.0;
    double cosine = 1.0;
    angles.find(static_cast<std::int64_t>(i), sine, cosine);
    points[i] = {first(d) * cosine, second(d) * sine};
  }
  BodyGeometry geometry = placed_in_plane(points, d.orientation, d.centre, dimension);
  geometry.rolling_radius = major(d) * (4.0 * arc_of(d).quarter() / kTau);
  geometry.rolling_rise = abs(first(d) - second(d));
  return geometry;
}

}  // namespace

BodyRecord ellipse_record() {
  auto record = closed_body_record<Description>(
      {parameter("count", &Description::count, dimension::none, "number of particles").in(positive),
       parameter("semi_axes", &Description::semi_axes, dimension::length,
                 "[a, b]: along its first axis and along its second")
           .in(positive),
       parameter("centre", &Description::centre, dimension::length,
                 "of the ellipse; the centre of mass lies off it where an odd count of particles "
                 "is spaced along the arc"),
       parameter("orientation", &Description::orientation, dimension::none,
                 "angle from x to its first axis, in rad, counter-clockwise")
           .in(kWithinOneTurn)
           .by_default(0.0),
       parameter(
           "spacing", &Description::spacing, dimension::none,
           "what is equal between neighbours: the length along the ellipse, or the parametric "
           "angle")
           .by_default(EllipseSpacing::arc)});
  record.name = "ellipse";
  record.summary =
      "particles on an ellipse in the x-y plane; rolls by its perimeter per revolution";
  record.equation =
      "x_i = centre + R(orientation) (a cos t_i, b sin t_i), with equal arc lengths, or t_i = 2 pi "
      "i/count";
  record.source =
      "B. C. Carlson, Numer. Algorithms 10 (1995) 13, doi:10.1007/BF02198293, arc lengths";
  record.complaints = of_description<&complaints>;
  record.build = of_description<&build>;
  record.example =
      rolling_example("A rigid ellipse pulled over a corrugated substrate.", R"(type = "ellipse"
count = 12
semi_axes = [1.2, 0.8]
centre = [0.0, 1.0]
)");
  return record;
}

}  // namespace tomlin
