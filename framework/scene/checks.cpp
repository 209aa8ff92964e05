#include "framework/scene/checks.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include <fmt/format.h>

namespace tomlin {
namespace {

bool is_vector(const ParameterValue& value) {
  return std::holds_alternative<SpaceVector>(value) ||
         std::holds_alternative<PerParticleVector>(value);
}

// Keys of BodyDescription; a body's shape does not depend on them.
bool is_common_key(std::string_view key) {
  return key == "particle_mass" || key == "velocity" || key == "coordinates";
}

/// Whether all keys that a body's shape depends on were read.
bool shape_is_known(const BodyDraft& body) {
  if (body.record == nullptr) return false;
  const auto& rows = body.record->parameters;
  return std::all_of(rows.begin(), rows.end(), [&body](const Parameter& row) {
    const bool absent = row.optional && body.reading.given->find(row.key) == nullptr;
    return absent || is_common_key(row.key) || body.reading.has(row.key);
  });
}

std::size_t length_of(const ParameterValue& value) {
  if (const auto* vector = std::get_if<SpaceVector>(&value)) return vector->components.size();
  const auto& vectors = std::get<PerParticleVector>(value).values;
  return vectors.empty() ? 0 : vectors.front().components.size();
}

/// Empty when every vector of the value has that many components.
std::string wrong_dimension(const ParameterValue& value, int dimension) {
  std::vector<SpaceVector> vectors;
  if (const auto* vector = std::get_if<SpaceVector>(&value)) vectors = {*vector};
  if (const auto* list = std::get_if<PerParticleVector>(&value)) vectors = list->values;
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const std::size_t length = vectors[i].components.size();
    if (length == 0 || length == static_cast<std::size_t>(dimension)) continue;
    const std::string which = vectors.size() > 1 ? fmt::format("vector {} has ", i) : "";
    return fmt::format(
        "mixed dimensions: {}{} component{}, but the scene has {}, by its first body", which,
        length, length == 1 ? "" : "s", dimension);
  }
  return "";
}

std::string wrong_pairs(const PairSelection& pairs, std::int64_t count) {
  std::set<std::array<std::int64_t, 2>> seen;
  for (const auto& [first, second] : pairs.list) {
    const std::string pair = fmt::format("pair [{}, {}]", first, second);
    if (std::min(first, second) < 0 || std::max(first, second) >= count) {
      return fmt::format("{}: indices are 0 to {}", pair, count - 1);
    }
    if (first == second) return pair + ": a particle and itself";
    if (!seen.insert({std::min(first, second), std::max(first, second)}).second) {
      return pair + " is given twice";
    }
  }
  return "";
}

/// Empty when lists have one entry or `count`, and indices name particles.
std::string wrong_for_count(const ParameterValue& value, std::int64_t count) {
  return std::visit(
      [count](const auto& given) -> std::string {
        using Kind = std::decay_t<decltype(given)>;
        if constexpr (std::is_same_v<Kind, PerParticle> ||
                      std::is_same_v<Kind, PerParticleVector>) {
          const std::size_t length = given.values.size();
          if (length <= 1 || length == static_cast<std::size_t>(count)) return "";
          return fmt::format("{} entries, but the body has {} particle{}", length, count,
                             count == 1 ? "" : "s");
        } else if constexpr (std::is_same_v<Kind, PairSelection>) {
          return wrong_pairs(given, count);
        } else if constexpr (std::is_same_v<Kind, Attachment>) {
          if (given.kind != Attachment::Kind::particle) return "";
          if (given.particle >= 0 && given.particle < count) return "";
          return fmt::format("there is no particle {}: indices are 0 to {}", given.particle,
                             count - 1);
        } else {
          return "";
        }
      },
      value);
}

/// Each sound key on its own; true when nothing is wrong.
bool check_values(const TableReading& reading, std::optional<int> dimension,
                  std::optional<std::int64_t> count, FaultList& faults) {
  bool sound = true;
  for (const auto& [key, value] : reading.values) {
    std::string why;
    if (dimension) why = wrong_dimension(value, *dimension);
    if (why.empty() && count) why = wrong_for_count(value, *count);
    if (why.empty()) continue;
    reading.complain(faults, key, {"", why});
    sound = false;
  }
  return sound;
}

/// The bodies that a force acts on; nothing when one of them is unfit or was not found.
std::optional<SceneOutline> outline_for(const ForceDraft& force,
                                        const std::vector<BodyDraft>& bodies,
                                        const std::vector<bool>& closed, int dimension) {
  if (force.bodies.empty()) return std::nullopt;
  SceneOutline outline;
  outline.dimension = dimension;
  for (const std::size_t index : force.bodies) {
    const BodyDraft& body = bodies[index];
    if (!body.sound || !body.count) return std::nullopt;
    outline.bodies.push_back({body.name, *body.count, closed[index]});
  }
  return outline;
}

}  // namespace

void count_particles(std::vector<BodyDraft>& bodies, FaultList& faults) {
  std::int64_t total = 0;
  for (BodyDraft& body : bodies) {
    if (!shape_is_known(body)) continue;
    const std::int64_t count = body.record->count(body.description.get());
    const std::string limit = fmt::format("at most {} particles in a scene", kMostParticles);
    if (count > kMostParticles) {
      body.reading.complain(faults, "count", {"", "too many particles", limit});
    } else if (total <= kMostParticles && total + count > kMostParticles) {
      body.reading.complain(
          faults, "count",
          {"", fmt::format("too many particles: {} with the bodies before", total + count), limit});
    } else if (count < 1) {
      body.reading.complain(faults, "count", {"", "a body has at least one particle"});
    } else {
      body.count = count;
    }
    if (count <= kMostParticles) total += count;
    if (!body.count) body.sound = false;
  }
}

std::optional<int> scene_dimension(const std::vector<BodyDraft>& bodies) {
  if (bodies.empty()) return std::nullopt;
  const BodyDraft& first = bodies.front();
  if (!shape_is_known(first)) return std::nullopt;
  if (const int dimension = first.record->dimension(first.description.get())) return dimension;

  // The body's shape has no vectors: its velocity has, or there are none at all.
  if (first.reading.given->find("velocity") == nullptr) return 1;
  const auto velocity = first.reading.values.find("velocity");
  if (velocity == first.reading.values.end() || !is_vector(velocity->second)) return std::nullopt;
  return static_cast<int>(length_of(velocity->second));
}

void check_bodies(std::vector<BodyDraft>& bodies, std::optional<int> dimension, FaultList& faults) {
  for (BodyDraft& body : bodies) {
    if (body.record == nullptr) continue;
    if (!check_values(body.reading, dimension, body.count, faults)) body.sound = false;
    if (!body.sound || !dimension) continue;
    const auto complaints = body.record->complaints(body.description.get(), *dimension);
    report(complaints, body.reading, faults);
    if (!complaints.empty()) body.sound = false;
  }
}

void check_forces(std::vector<ForceDraft>& forces, const std::vector<BodyDraft>& bodies,
                  std::optional<int> dimension, FaultList& faults) {
  // Whether a body is closed is known when it is built, and only a sound one can be.
  std::vector<bool> closed(bodies.size(), false);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!bodies[i].sound || !dimension) continue;
    closed[i] = bodies[i].record->build(bodies[i].description.get(), *dimension).closed;
  }
  for (ForceDraft& force : forces) {
    if (force.record == nullptr) continue;
    const bool one_body = force.bodies.size() == 1;
    const auto count = one_body ? bodies[force.bodies.front()].count : std::nullopt;
    if (!check_values(force.reading, dimension, count, faults)) force.sound = false;
    if (!force.sound || !dimension) continue;
    const auto outline = outline_for(force, bodies, closed, *dimension);
    if (!outline) continue;
    const auto complaints = force.record->complaints(force.description.get(), *outline);
    report(complaints, force.reading, faults);
    if (!complaints.empty()) force.sound = false;
  }
}

void report(const std::vector<Complaint>& complaints, const TableReading& reading,
            FaultList& faults) {
  for (const Complaint& complaint : complaints) {
    reading.complain(faults, complaint.key, {"", complaint.why, complaint.admissible});
  }
}

}  // namespace tomlin
