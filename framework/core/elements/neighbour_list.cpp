#include "framework/core/elements/neighbour_list.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/axis_names.hpp"

namespace tomlin {
namespace {

struct NearPair {
  std::size_t one = 0;
  std::size_t other = 0;
  double apart = 0.0;
};

/// The nearest two particles of all that are nearer than `least`.
std::optional<NearPair> nearest_pair(const StartingParticles& one, const StartingParticles& other,
                                     int dimension, const std::array<double, 3>& box,
                                     double least) {
  const std::size_t count = other.positions.size();
  std::vector<double> positions(static_cast<std::size_t>(dimension) * count);
  for (std::size_t j = 0; j < count; ++j) {
    for (int d = 0; d < dimension; ++d) positions[d * count + j] = other.positions[j][d];
  }
  NeighbourSearch search(dimension, least, box);
  search.sort(positions, count);
  std::optional<NearPair> nearest;
  std::vector<Neighbour> found;
  for (std::size_t i = 0; i < one.positions.size(); ++i) {
    const std::array<double, 3>& here = one.positions[i];
    search.find(here, found);
    for (const Neighbour& near : found) {
      if (one.body == other.body && near.particle == i) continue;
      double squared = 0.0;
      for (int d = 0; d < dimension; ++d) {
        const double apart = (positions[d * count + near.particle] - here[d]) + near.shift[d];
        squared += apart * apart;
      }
      const double apart = std::sqrt(squared);
      if (!(apart < least) || (nearest && apart >= nearest->apart)) continue;
      nearest = {i, near.particle, apart};
    }
  }
  return nearest;
}

/// The axis across which all particles of one body lie in a plane, while the other has particles on
/// both sides of it; none where there is no such axis.
std::optional<int> plane_passed(const StartingParticles& flat, const StartingParticles& other,
                                double least) {
  constexpr double kFlat = 1e-6;  // of `least`
  const auto range = [](const StartingParticles& body, int axis) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const std::array<double, 3>& position : body.positions) {
      low = std::min(low, position[axis]);
      high = std::max(high, position[axis]);
    }
    return std::array{low, high};
  };
  constexpr std::size_t kFewest = 3;  // that span a plane
  if (flat.positions.size() < kFewest) return std::nullopt;
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] = range(flat, axis);
    if (!(high - low <= kFlat * least)) continue;
    const auto [below, above] = range(other, axis);
    if (below < low && above > high) return axis;
  }
  return std::nullopt;
}

}  // namespace

std::string name_of(const StartingParticles& body, std::size_t particle) {
  std::string name = fmt::format("particle {} of \"{}\"", particle, body.name);
  if (body.species.empty()) return name;
  return name + " (" + body.species_names[static_cast<std::size_t>(body.species[particle])] + ")";
}

void check_distances(const StartingParticles& one, const StartingParticles& other, int dimension,
                     const std::array<double, 3>& box, double least, const std::string& why) {
  if (!(least > 0.0)) return;
  const std::optional<NearPair> pair = nearest_pair(one, other, dimension, box, least);
  if (!pair) return;
  const bool same = one.body == other.body;
  std::string through;
  for (const auto& [flat, body] : {std::pair{&one, &other}, std::pair{&other, &one}}) {
    if (same || dimension < 3) break;
    const std::optional<int> axis = plane_passed(*flat, *body, least);
    if (!axis) continue;
    through =
        fmt::format("\"{}\" passes through \"{}\", which lies in a plane across {}: ", body->name,
                    flat->name, kAxisNames[*axis]);
    break;
  }
  throw BindError(
      {.key = same ? "body" : "bodies",
       .why = fmt::format("{}{} and {} are {:.3g} apart at the start", through,
                          name_of(one, pair->one), name_of(other, pair->other), pair->apart),
       .admissible = fmt::format("at least {:.3g}, {}", least, why),
       .code = FaultCode::body_invalid_coordinates});
}

std::vector<Complaint> cutoff_complaints(const char* key, double cutoff, const SceneOutline& scene,
                                         ListReach (*list)(double cutoff)) {
  const double in_parts = list(1.0).reach;
  const double shortest = 2.0 * cutoff * in_parts;
  for (const double length : scene.box) {
    if (!(length > 0.0) || length >= shortest) continue;
    return {{.key = key,
             .why = fmt::format("the periodic box is {:.6g} long, less than twice the cutoff and "
                                "the skin of its neighbour list, {:.6g}",
                                length, shortest),
             .admissible = fmt::format("at most {:.6g}, or a longer box", 0.5 * length / in_parts),
             .code = FaultCode::scene_out_of_range}};
  }
  return {};
}

}  // namespace tomlin
