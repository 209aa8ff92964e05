#include "framework/bodies/particles.hpp"

#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "framework/bodies/outline.hpp"
#include "framework/core/records/fetched_numbers.hpp"

namespace tomlin {
namespace {

using Description = ParticlesDescription;

constexpr std::size_t kMostColumns = 3;

const std::filesystem::path& read_from(const Description& d) { return d.read_from; }

int dimension_of(const Description& d) { return static_cast<int>(d.positions.dimension); }

std::int64_t count(const Description& d) { return static_cast<std::int64_t>(d.positions.count()); }

Complaint complaint_of(FaultCode code, std::string key, std::string why,
                       std::string admissible = "") {
  return {.key = std::move(key),
          .why = std::move(why),
          .admissible = std::move(admissible),
          .code = code};
}

/// Fills in the positions that the file holds.
std::vector<Complaint> fetch(Description& d, const std::filesystem::path& folder) {
  FetchedNumbers fetched =
      fetch_numbers(d.file, folder, "file", kMostColumns, ", but space has at most 3 dimensions");
  d.positions = {fetched.file.columns, std::move(fetched.file.numbers)};
  d.read_from = std::move(fetched.path);
  d.file.clear();
  return std::move(fetched.complaints);
}

std::vector<Complaint> prepare(Description& d, const std::filesystem::path& folder) {
  const bool listed = !d.positions.coordinates.empty();
  const bool in_file = !d.file.empty();
  if (listed && in_file) {
    return {complaint_of(FaultCode::scene_conflict, "file", "positions are given too",
                         "one of the two")};
  }
  if (!listed && !in_file) {
    return {complaint_of(FaultCode::scene_missing_key, "positions", "missing",
                         "positions = [[..], ..] or file = \"..\"")};
  }
  return in_file ? fetch(d, folder) : std::vector<Complaint>();
}

std::vector<double> relative_to_first(const PointList& positions, std::size_t particle) {
  std::vector<double> relative(positions.dimension);
  for (std::size_t axis = 0; axis < positions.dimension; ++axis) {
    relative[axis] =
        positions.coordinates[particle * positions.dimension + axis] - positions.coordinates[axis];
  }
  return relative;
}

BodyGeometry build(const Description& d, int dimension) {
  const PointList& positions = d.positions;
  BodyGeometry geometry;
  geometry.anchor.assign(positions.coordinates.begin(), positions.coordinates.begin() + dimension);
  geometry.relative.reserve(positions.count());
  for (std::size_t i = 0; i < positions.count(); ++i) {
    geometry.relative.push_back(relative_to_first(positions, i));
  }
  if (d.outline == ParticleOutline::closed) roll_along_particles(geometry);
  return geometry;
}

BodyEnds ends(const Description& d, int) {
  return {.closed = d.outline == ParticleOutline::closed};
}

/// What keeps particles from being a closed outline.
std::vector<Complaint> outline_complaints(const Description& d, int dimension) {
  const auto refused = [](FaultCode code, std::string why, std::string admissible = "") {
    return std::vector<Complaint>{
        complaint_of(code, "outline", std::move(why), std::move(admissible))};
  };
  const std::size_t count = d.positions.count();
  if (dimension < 2) {
    return refused(FaultCode::scene_conflict, "an outline needs two dimensions", "\"open\"");
  }
  if (count < 3) {
    return refused(FaultCode::scene_wrong_count, fmt::format("{} particles are no outline", count),
                   "at least 3 particles, or \"open\"");
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = (i + 1) % count;
    if (relative_to_first(d.positions, i) != relative_to_first(d.positions, next)) continue;
    return refused(FaultCode::component_invalid,
                   fmt::format("particles {} and {} coincide", i, next),
                   "neighbours along the outline apart from each other");
  }
  if (!std::isfinite(build(d, dimension).rolling_radius)) {
    return refused(FaultCode::scene_not_finite, "the perimeter is not finite", "a smaller outline");
  }
  return {};
}

std::vector<Complaint> complaints(const Description& d, int dimension) {
  const std::string key = d.read_from.empty() ? "positions" : "file";
  if (d.positions.dimension != static_cast<std::size_t>(dimension)) {
    return {complaint_of(
        FaultCode::scene_wrong_count, key,
        fmt::format("mixed dimensions: points of {}, but the first body sets the dimension to {}",
                    d.positions.dimension, dimension))};
  }
  for (std::size_t i = 0; i < d.positions.count(); ++i) {
    for (const double distance : relative_to_first(d.positions, i)) {
      if (std::isfinite(distance)) continue;
      return {complaint_of(FaultCode::scene_not_finite, key,
                           fmt::format("particle {} is infinitely far from the first", i))};
    }
  }
  if (d.outline == ParticleOutline::closed) return outline_complaints(d, dimension);
  return {};
}

}  // namespace

BodyRecord particles_record() {
  auto record = body_record<Description>(
      {parameter("positions", &Description::positions, dimension::length,
                 "a list of points; in one dimension of numbers")
           .or_absent(),
       parameter("file", &Description::file, dimension::none,
                 "in place of positions: a file with one particle per line, one column per "
                 "dimension, # comments; its path is relative to the scene's folder")
           .or_absent(),
       parameter("outline", &Description::outline, dimension::none,
                 "closed: the particles in order are the outline of a planar body, which joins the "
                 "last to the first and rolls by its perimeter per revolution")
           .by_default(ParticleOutline::open)});
  record.prepare = of_description<&prepare>;
  record.read_from = of_description<&read_from>;
  record.name = "particles";
  record.summary = "particles at given positions, from a list or a file";
  record.equation = "x_i = positions[i]";
  record.source =
      "D. Frenkel and B. Smit, Understanding Molecular Simulation (Academic Press, 2002), "
      "ISBN 978-0-12-267351-1";
  record.dimension = of_description<&dimension_of>;
  record.count = of_description<&count>;
  record.complaints = of_description<&complaints>;
  record.ends = of_description<&ends>;
  record.build = of_description<&build>;
  record.example = R"(# Three particles, bonded to each other in a triangle.
[[body]]
type = "particles"
positions = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.8]]
velocity = [[0.1, 0.0], [0.0, 0.0], [0.0, 0.0]]
particle_mass = 1.0

[[force]]
type = "harmonic_bonds"
pairs = "all"
stiffness = 1.0

[run]
duration = 1.0
integrator = { type = "rk4", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
