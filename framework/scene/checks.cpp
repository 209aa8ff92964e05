#include "framework/scene/checks.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "framework/scene/effective.hpp"
#include "framework/scene/engine_units.hpp"
#include "framework/scene/size_checks.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

// Keys of BodyDescription; a body's shape does not depend on them.
bool is_common_key(std::string_view key) {
  return key == "particle_mass" || key == "species" || key == "velocity" || key == "displacement" ||
         key == "start_temperature" || key == "coordinates";
}

/// Whether all keys that a body's shape depends on were read.
bool shape_was_read(const BodyDraft& body) {
  if (body.record == nullptr) return false;
  const auto& rows = body.record->parameters;
  return std::all_of(rows.begin(), rows.end(), [&body](const Parameter& row) {
    const bool absent = row.optional && body.reading.given->find(row.key) == nullptr;
    return absent || is_common_key(row.key) || body.reading.has(row.key);
  });
}

bool says_nothing(const ParameterValue& value) {
  const auto* text = std::get_if<std::string>(&value);
  return text ? text->empty() : !to_node(value);
}

/// Brings the effective scene up to date with the description.
template <class Record>
void update_effective(ComponentDraft<Record>& component) {
  TableReading& reading = component.reading;
  Table effective;
  for (const Parameter& row : component.record->parameters) {
    const Node* before = reading.effective.find(row.key);
    if (before == nullptr && !row.optional) continue;  // it has a fault
    if (before != nullptr && !reading.has(row.key)) {
      effective.set(row.key, *before);  // it waits until the particles are counted
      continue;
    }
    ParameterValue value = row.read(component.description.get());
    const auto known = reading.values.find(row.key);
    if (before != nullptr && known != reading.values.end() && known->second == value) {
      effective.set(row.key, *before);
    } else if (row.optional && says_nothing(value)) {
      reading.values.erase(row.key);
    } else if (auto node =
                   to_node(in_scene_units(value, scene_unit(reading.units, row.dimension)))) {
      effective.set(row.key, *std::move(node));
      reading.values.insert_or_assign(row.key, std::move(value));
    }
  }
  reading.effective = std::move(effective);
}

/// Converts numbers from a file, which are in the scene's units, as keys are.
template <class Record>
void convert_fetched(ComponentDraft<Record>& component) {
  const TableReading& reading = component.reading;
  for (const Parameter& row : component.record->parameters) {
    const double unit = scene_unit(reading.units, row.dimension);
    const bool waits = reading.effective.find(row.key) != nullptr && !reading.has(row.key);
    if (unit == 1.0 || waits) continue;
    ParameterValue value = row.read(component.description.get());
    const auto known = reading.values.find(row.key);
    if (known != reading.values.end() && known->second == value) continue;
    row.assign(component.description.get(), in_engine_units(std::move(value), unit));
  }
}

/// False when what the component refers to cannot be had.
template <class Record>
bool prepare(ComponentDraft<Record>& component, const std::filesystem::path& folder,
             FaultList& faults) {
  if (component.record->prepare == nullptr) return true;
  const auto complaints = component.record->prepare(component.description.get(), folder);
  report(complaints, component.reading, faults);
  if (complaints.empty()) {
    convert_fetched(component);
    update_effective(component);
  } else {
    component.valid = component.reading.valid = false;
  }
  return complaints.empty();
}

/// Value that does not fit the scene's dimension or the bodies.
struct WrongValue {
  FaultCode code;
  std::string why;
};

/// Nothing when every vector of the value has that many components.
std::optional<WrongValue> wrong_dimension(const ParameterValue& value, int dimension) {
  std::vector<SpaceVector> vectors;
  if (const auto* vector = std::get_if<SpaceVector>(&value)) vectors = {*vector};
  if (const auto* list = std::get_if<PerParticleVector>(&value)) vectors = list->values;
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const std::size_t length = vectors[i].components.size();
    if (length == 0 || length == static_cast<std::size_t>(dimension)) continue;
    const std::string which = vectors.size() > 1 ? fmt::format("vector {} has ", i) : "";
    return WrongValue{
        FaultCode::scene_wrong_count,
        fmt::format(
            "mixed dimensions: {}{} component{}, but the first body sets the dimension to {}",
            which, length, length == 1 ? "" : "s", dimension)};
  }
  return std::nullopt;
}

std::optional<WrongValue> wrong_index(const std::string& pair, std::int64_t index,
                                      const BodyDraft& body) {
  if (index >= 0 && index < *body.count) return std::nullopt;
  return WrongValue{
      FaultCode::scene_out_of_range,
      fmt::format("{}: indices of {} are 0 to {}", pair, quoted_text(body.name), *body.count - 1)};
}

/// Indices of different particles of a body, in messages a `kind`: pairs or angles, of which the
/// opposite order is the same one.
template <std::size_t N>
std::optional<WrongValue> wrong_tuples(const std::vector<std::array<std::int64_t, N>>& tuples,
                                       const char* kind, const char* repeated,
                                       const BodyDraft& body) {
  std::set<std::array<std::int64_t, N>> seen;
  for (std::array<std::int64_t, N> tuple : tuples) {
    const std::string written = fmt::format("{} [{}]", kind, fmt::join(tuple, ", "));
    const auto [least, most] = std::minmax_element(tuple.begin(), tuple.end());
    if (*least < 0 || *most >= *body.count) {
      return WrongValue{FaultCode::scene_out_of_range,
                        fmt::format("{}: indices are 0 to {}", written, *body.count - 1)};
    }
    if (std::set<std::int64_t>(tuple.begin(), tuple.end()).size() < N) {
      return WrongValue{FaultCode::component_invalid, written + repeated};
    }
    if (tuple.front() > tuple.back()) std::swap(tuple.front(), tuple.back());
    if (!seen.insert(tuple).second) {
      return WrongValue{FaultCode::scene_duplicate_key, written + " is given twice"};
    }
  }
  return std::nullopt;
}

std::optional<WrongValue> wrong_pairs(const PairSelection& pairs, const BodyDraft& body) {
  return wrong_tuples(pairs.list, "pair", ": a particle cannot be paired with itself", body);
}

/// Throws where the pairs that a body lists as neighbours are none of its own.
void check_neighbours(const BodyDraft& body) {
  const PairSelection listed{.kind = PairSelection::Kind::list,
                             .list = body.record->neighbours(body.description.get(), {})};
  if (const auto found = wrong_pairs(listed, body)) {
    throw std::out_of_range("its list of neighbours: " + found->why);
  }
}

/// Pairs of a particle of the first body with one of the second.
std::optional<WrongValue> wrong_pairs(const PairSelection& pairs, const BodyDraft& one,
                                      const BodyDraft& other) {
  if (pairs.kind == PairSelection::Kind::neighbours) {
    return WrongValue{
        FaultCode::component_unsuitable,
        "particles of two bodies are no neighbours; give \"all\" or a list of index pairs"};
  }
  std::set<std::array<std::int64_t, 2>> seen;
  for (const auto& [first, second] : pairs.list) {
    const std::string pair = fmt::format("pair [{}, {}]", first, second);
    if (auto found = wrong_index(pair, first, one)) return found;
    if (auto found = wrong_index(pair, second, other)) return found;
    if (!seen.insert({first, second}).second) {
      return WrongValue{FaultCode::scene_duplicate_key, pair + " is given twice"};
    }
  }
  return std::nullopt;
}

template <class Values>
std::size_t entries_of(const Values& given) {
  return given.values.size();
}
std::size_t entries_of(const NamePerParticle& given) { return given.names.size(); }

/// Nothing when lists have one entry or one per particle, and indices name particles.
std::optional<WrongValue> wrong_for_body(const ParameterValue& value, const BodyDraft& body) {
  const std::int64_t count = *body.count;
  return std::visit(
      [&](const auto& given) -> std::optional<WrongValue> {
        using Kind = std::decay_t<decltype(given)>;
        if constexpr (std::is_same_v<Kind, PerParticle> ||
                      std::is_same_v<Kind, PerParticleVector> ||
                      std::is_same_v<Kind, NamePerParticle>) {
          const std::size_t length = entries_of(given);
          if (length <= 1 || length == static_cast<std::size_t>(count)) return std::nullopt;
          return WrongValue{FaultCode::scene_wrong_count,
                            fmt::format("{} entries, but the body has {} particle{}", length, count,
                                        count == 1 ? "" : "s")};
        } else if constexpr (std::is_same_v<Kind, PairSelection>) {
          return wrong_pairs(given, body);
        } else if constexpr (std::is_same_v<Kind, AngleSelection>) {
          return wrong_tuples(given.list, "angle", ": an angle has three different particles",
                              body);
        } else if constexpr (std::is_same_v<Kind, Attachment>) {
          if (given.kind != Attachment::Kind::particle) return std::nullopt;
          if (given.particle >= 0 && given.particle < count) return std::nullopt;
          return WrongValue{FaultCode::scene_out_of_range,
                            fmt::format("there is no particle {}: indices are 0 to {}",
                                        given.particle, count - 1)};
        } else {
          return std::nullopt;
        }
      },
      value);
}

/// Checks a value for several bodies; what a list would have one entry for each of is not known.
std::optional<WrongValue> wrong_for_bodies(const ParameterValue& value,
                                           const std::vector<const BodyDraft*>& bodies) {
  if (bodies.size() == 1) return wrong_for_body(value, *bodies.front());
  const auto* pairs = std::get_if<PairSelection>(&value);
  if (bodies.size() == 2 && pairs) return wrong_pairs(*pairs, *bodies[0], *bodies[1]);
  return std::nullopt;
}

/// Each valid key on its own; true when nothing is wrong. No bodies: not all counts are known.
bool check_values(const TableReading& reading, std::optional<int> dimension,
                  const std::vector<const BodyDraft*>& bodies, FaultList& faults) {
  bool valid = true;
  for (const auto& [key, value] : reading.values) {
    std::optional<WrongValue> found;
    if (dimension) found = wrong_dimension(value, *dimension);
    if (!found) found = wrong_for_bodies(value, bodies);
    if (!found) continue;
    reading.complain(faults, key, {found->code, "", found->why});
    valid = false;
  }
  return valid;
}

/// Returns these bodies if the particles of all could be counted; else none.
std::vector<const BodyDraft*> counted_bodies(const std::vector<std::size_t>& indices,
                                             const std::vector<BodyDraft>& bodies) {
  std::vector<const BodyDraft*> counted;
  for (const std::size_t index : indices) {
    if (!bodies[index].count) return {};
    counted.push_back(&bodies[index]);
  }
  return counted;
}

/// Each once.
std::vector<std::string> species_of(const BodyDraft& body) {
  std::vector<std::string> species = body.record->common(body.description.get()).species.names;
  std::sort(species.begin(), species.end());
  species.erase(std::unique(species.begin(), species.end()), species.end());
  return species;
}

/// Outlines of the bodies in a box, which forces and observers read.
class Outlines {
 public:
  /// Without box or dimension nothing is known of any body.
  Outlines(const std::vector<BodyDraft>& bodies, const BoxSettings* box,
           std::optional<int> dimension)
      : bodies_(bodies), dimension_(dimension), known_(dimension && box) {
    for (std::size_t axis = 0; known_ && axis < box->lengths.size(); ++axis) {
      if (box->periodic[axis]) box_[axis] = box->lengths[axis];
    }
  }

  /// Outline of these bodies; nothing when one of them is not valid or was not found.
  std::optional<SceneOutline> of(const std::vector<std::size_t>& indices) const {
    if (!known_ || indices.empty()) return std::nullopt;
    SceneOutline outline;
    outline.dimension = *dimension_;
    outline.box = box_;
    for (const std::size_t index : indices) {
      const BodyDraft& body = bodies_[index];
      if (!body.valid || !body.count) return std::nullopt;
      outline.bodies.push_back({body.name, *body.count, is_closed(body),
                                neighbour_list(*body.record, body.description, box_),
                                species_of(body)});
    }
    return outline;
  }

 private:
  /// Whether the body's ends are joined, by itself or through the box.
  bool is_closed(const BodyDraft& body) const {
    const BodyEnds ends = body.record->ends(body.description.get(), *dimension_);
    const int axis = ends.open_along;
    return ends.closed || (axis >= 0 && box_[static_cast<std::size_t>(axis)] > 0.0);
  }

  const std::vector<BodyDraft>& bodies_;
  std::optional<int> dimension_;
  bool known_;
  std::array<double, 3> box_{};  ///< lengths of the periodic axes
};

bool is_fault(const Complaint& complaint) {
  return kind_of(complaint.code).severity == Severity::error;
}

/// Complaints of the record; if parameters differ between particles, for the first at fault.
std::vector<Complaint> complaints_of_each(const ForceDraft& force, const SceneOutline& outline) {
  void* const description = force.description.get();
  const std::vector<Variation> variations = variations_of(force);
  std::vector<Complaint> found = force.record->complaints(description, outline);
  if (variations.empty()) return found;
  const std::size_t count = count_of(variations.front());
  for (std::size_t i = 0; i < count && std::none_of(found.begin(), found.end(), is_fault); ++i) {
    assign_particle(variations, i, description);
    found = force.record->complaints(description, outline);
  }
  for (const Variation& one : variations) one.row->assign(description, representative(one));
  return found;
}

}  // namespace

std::vector<Variation> variations_of(const ForceDraft& force) {
  std::vector<Variation> variations;
  for (const auto& [key, variation] : force.reading.variations) variations.push_back(variation);
  return variations;
}

void prepare_bodies(std::vector<BodyDraft>& bodies, const std::filesystem::path& folder,
                    FaultList& faults) {
  for (BodyDraft& body : bodies) {
    body.shape_is_known = shape_was_read(body) && prepare(body, folder, faults);
  }
}

void prepare_force(ForceDraft& force, const std::filesystem::path& folder, FaultList& faults) {
  if (force.record != nullptr && force.reading.valid) prepare(force, folder, faults);
}

std::optional<int> scene_dimension(const std::vector<BodyDraft>& bodies) {
  if (bodies.empty()) return std::nullopt;
  const BodyDraft& first = bodies.front();
  if (!first.shape_is_known) return std::nullopt;
  if (const int dimension = first.record->dimension(first.description.get())) return dimension;

  // The body's shape has no vectors: its motion or velocity has, or there are none at all.
  if (first.motion && !first.motion->velocity.empty()) {
    return static_cast<int>(first.motion->velocity.size());
  }
  const Node* velocity = first.reading.given->find("velocity");
  if (velocity == nullptr) return 1;
  // It may wait until the particles are counted.
  const List* list = velocity->as<List>();
  if (list != nullptr && !list->empty() && list->front().as<List>())
    list = list->front().as<List>();
  if (list == nullptr || list->empty()) return std::nullopt;
  return static_cast<int>(list->size());
}

void check_bodies(std::vector<BodyDraft>& bodies, std::optional<int> dimension, FaultList& faults) {
  for (BodyDraft& body : bodies) {
    if (body.record == nullptr) continue;
    std::vector<const BodyDraft*> counted;
    if (body.count) counted.push_back(&body);
    if (!check_values(body.reading, dimension, counted, faults)) body.valid = false;
    if (!body.valid || !dimension) continue;
    const auto complaints = complaints_of(*body.record, [&] {
      auto found = body.record->complaints(body.description.get(), *dimension);
      const bool lists_neighbours = body.record->neighbours != nullptr;
      const bool of_plugin = !body.record->library.empty();  // all others have tests of their own
      if (found.empty() && lists_neighbours && of_plugin && body.count) check_neighbours(body);
      return found;
    });
    report(complaints, body.reading, faults);
    if (!complaints.empty()) body.valid = false;
  }
}

void check_forces(std::vector<ForceDraft>& forces, const std::vector<BodyDraft>& bodies,
                  const BoxSettings* box, std::optional<int> dimension, FaultList& faults) {
  const Outlines outlines(bodies, box, dimension);
  PairCount pairs;
  for (ForceDraft& force : forces) {
    if (force.record == nullptr) continue;
    const auto counted = counted_bodies(force.bodies, bodies);
    if (!check_values(force.reading, dimension, counted, faults)) force.valid = false;
    if (!force.valid) continue;
    auto outline = outlines.of(force.bodies);
    if (!outline) continue;
    outline->units = force.reading.units;
    bool fits = false;
    const auto complaints = complaints_of(*force.record, [&] {
      auto found = complaints_of_each(force, *outline);
      fits = pairs.add(force, *outline, faults);
      return found;
    });
    for (const Complaint& one : complaints) {
      const TableReading& reading =
          one.body ? bodies[force.bodies[*one.body]].reading : force.reading;
      if (is_fault(one)) {
        report({one}, reading, faults);
        fits = false;
      } else {
        const std::string key = reading.path + "." + one.key;
        force.warnings.push_back(
            {one.code, fmt::format("{}: {}; {}", key, one.why, one.admissible), key});
      }
    }
    if (!fits) force.valid = false;
  }
}

void check_observers(std::vector<ObserverDraft>& observers, const std::vector<BodyDraft>& bodies,
                     const BoxSettings* box, std::optional<int> dimension, FaultList& faults) {
  const Outlines outlines(bodies, box, dimension);
  for (ObserverDraft& observer : observers) {
    if (observer.record == nullptr) continue;
    const auto counted = counted_bodies(observer.bodies, bodies);
    if (!check_values(observer.reading, dimension, counted, faults)) observer.valid = false;
    if (!observer.valid) continue;
    const auto outline = outlines.of(observer.bodies);
    if (!outline) continue;
    const auto complaints = complaints_of(*observer.record, [&] {
      return observer.record->complaints(observer.description.get(), *outline);
    });
    report(complaints, observer.reading, faults);
    if (!complaints.empty()) observer.valid = false;
  }
}

void report(const std::vector<Complaint>& complaints, const TableReading& reading,
            FaultList& faults) {
  for (const Complaint& complaint : complaints) {
    const Wrong wrong{complaint.code, "", complaint.why, complaint.admissible, complaint.nearest};
    if (complaint.column) {
      reading.complain_inside(faults, complaint.key, complaint.index, *complaint.column, wrong);
    } else {
      reading.complain(faults, complaint.key, wrong);
    }
  }
}

}  // namespace tomlin
