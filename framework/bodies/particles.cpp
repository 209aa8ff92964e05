#include "framework/bodies/particles.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "framework/bodies/outline.hpp"
#include "framework/core/records/fetched_numbers.hpp"
#include "framework/core/text/xyz_file.hpp"

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

/// The key of the scene comes first.
void take_species(Description& d, std::vector<std::string> species) {
  if (!d.species.names.empty() || species.empty()) return;
  const bool equal =
      std::adjacent_find(species.begin(), species.end(), std::not_equal_to<>()) == species.end();
  if (equal) species.resize(1);
  d.species.names = std::move(species);
}

void take_masses(Description& d, std::vector<double> masses) {
  if (d.particle_mass.values.empty()) d.particle_mass.values = std::move(masses);
}

void take_velocities(Description& d, const std::vector<double>& velocities, std::size_t dimension) {
  if (!d.velocity.values.empty()) return;
  for (std::size_t k = 0; k < velocities.size(); k += dimension) {
    const auto begin = velocities.begin() + static_cast<std::ptrdiff_t>(k);
    d.velocity.values.push_back({{begin, begin + static_cast<std::ptrdiff_t>(dimension)}});
  }
}

/// Fills in what a frame of the file holds, where the scene does not say it.
std::vector<Complaint> fetch_xyz(Description& d, const std::filesystem::path& folder) {
  FetchedText fetched = fetch_text(d.file, folder, "file");
  if (!fetched.complaints.empty()) return fetched.complaints;
  const std::int64_t wanted = std::isnan(d.frame) ? -1 : static_cast<std::int64_t>(d.frame);
  if (!std::isnan(d.frame) && static_cast<double>(wanted) != d.frame) {
    return {complaint_of(FaultCode::scene_out_of_range, "frame", "not a whole number")};
  }
  XyzFrame frame = parse_xyz(fetched.text, fetched.path.string(), wanted);
  std::vector<Complaint> found;
  for (std::string& fault : frame.faults) {
    found.push_back(complaint_of(FaultCode::file_invalid, "file", std::move(fault)));
  }
  take_velocities(d, frame.velocities, frame.dimension);
  take_species(d, std::move(frame.species));
  take_masses(d, std::move(frame.masses));
  d.positions = {frame.dimension, std::move(frame.positions)};
  d.read_from = std::move(fetched.path);
  d.file.clear();
  d.frame = std::numeric_limits<double>::quiet_NaN();
  return found;
}

/// Whether a text begins as a file of bare columns does: with a comment, or with numbers of which
/// one is no number of particles.
bool has_bare_columns(std::string_view text) {
  std::string_view line = text.substr(0, text.find_first_of("\r\n"));
  if (line.starts_with('#')) return true;
  if (line.find_first_not_of("0123456789+-.eE, \t") != line.npos) return false;
  const std::size_t first = line.find_first_not_of(" \t");
  if (first == line.npos) return false;
  line = line.substr(first, line.find_last_not_of(" \t") + 1 - first);
  return line.find_first_not_of("0123456789") != line.npos;
}

/// By its name, unless it begins with bare columns.
bool is_xyz(const std::string& file, const std::filesystem::path& folder) {
  if (!file.ends_with(".xyz") && !file.ends_with(".extxyz")) return false;
  const FetchedText fetched = fetch_text(file, folder, "file");
  return !fetched.complaints.empty() || !has_bare_columns(fetched.text);
}

/// Fills in the positions that the file holds.
std::vector<Complaint> fetch(Description& d, const std::filesystem::path& folder) {
  if (is_xyz(d.file, folder)) return fetch_xyz(d, folder);
  if (!std::isnan(d.frame)) {
    return {complaint_of(FaultCode::scene_conflict, "frame", "the file is none of extended XYZ",
                         "a file whose name ends in .xyz or .extxyz")};
  }
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

/// Returns the reasons why the particles are no closed outline.
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
  if (d.particle_mass.values.empty()) {
    return {complaint_of(FaultCode::scene_missing_key, "particle_mass", "missing",
                         "a number > 0, or a list of one per particle; or a file with masses")};
  }
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
  constexpr Interval kFrames{.low = -1e9, .high = 1e9};
  auto record = body_record<Description>(
      {parameter("positions", &Description::positions, dimension::length,
                 "a list of points; in one dimension of numbers")
           .or_absent(),
       parameter(
           "file", &Description::file, dimension::none,
           "in place of positions: a file with one particle per line, one column per "
           "dimension, # comments; or, where its name ends in .xyz or .extxyz and its first line "
           "is a number of particles, extended XYZ, whose species, velocities (velo) and masses "
           "are taken where the scene has no such "
           "key, in the units of the scene. Its path is relative to the scene's folder")
           .or_absent(),
       parameter(
           "frame", &Description::frame, dimension::none,
           "which frame of a file of extended XYZ, a whole number: from 0 on, or -1 for the last, "
           "-2 for the one before; the last by default")
           .in(kFrames)
           .or_absent(),
       parameter("outline", &Description::outline, dimension::none,
                 "closed: the particles in order are the outline of a planar body, which joins the "
                 "last to the first and rolls by its perimeter per revolution")
           .by_default(ParticleOutline::open)});
  for (Parameter& row : record.parameters) {
    if (row.key == "particle_mass") {
      row.optional = true;
      row.doc += "; may be absent where a file of extended XYZ has masses";
    }
  }
  record.prepare = of_description<&prepare>;
  record.read_from = of_description<&read_from>;
  record.name = "particles";
  record.summary = "particles at given positions, from a list or a file, as of extended XYZ";
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
