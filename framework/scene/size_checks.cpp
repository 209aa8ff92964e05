#include "framework/scene/size_checks.hpp"

#include <string>

#include <fmt/format.h>

#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

constexpr double kGigabyte = 1e9;

std::string memory(double bytes) {
  const double gigabytes = bytes / kGigabyte;
  return gigabytes < 100.0 ? fmt::format("about {:.2g} GB", gigabytes)
                           : fmt::format("about {:.0f} GB", gigabytes);
}

/// The first value with which the expressions below a node become too long; null: they do not.
class ExpressionText {
 public:
  const Node* exceeded_at(const Node& node) {
    if (const auto* text = node.as<std::string>()) {
      if (!is_component_name(*text)) bytes_ += text->size();
      return bytes_ > kMostExpressionText ? &node : nullptr;
    }
    if (const auto* list = node.as<List>()) {
      for (const Node& element : *list) {
        if (const Node* found = exceeded_at(element)) return found;
      }
    } else if (const auto* table = node.as<Table>()) {
      for (const Entry& entry : table->entries) {
        if (const Node* found = exceeded_at(entry.value)) return found;
      }
    }
    return nullptr;
  }

 private:
  std::size_t bytes_ = 0;
};

/// Key that gives the number of particles; empty where that is no key.
std::string count_key(const BodyDraft& body) {
  for (const char* key : {"count", "size", "cells", "length"}) {
    if (body.reading.has(key)) return key;
  }
  return "";
}

double bytes_of(std::int64_t particles, int dimension) {
  return static_cast<double>(particles) * (kBytesPerParticle + kBytesPerCoordinate * dimension);
}

/// "1000000000 particles would take about 420 GB".
std::string too_many_particles(std::int64_t count, std::int64_t before,
                               std::optional<int> dimension) {
  // A sum could overflow, and two numbers tell more.
  const std::string which =
      before > 0 ? fmt::format(" and the {} of the preceding bodies", before) : "";
  const double bytes =
      bytes_of(count, dimension.value_or(1)) + bytes_of(before, dimension.value_or(1));
  return fmt::format("{} particles{} would take {}", count, which, memory(bytes));
}

}  // namespace

bool check_expressions(const Table& document, FaultList& faults) {
  ExpressionText text;
  for (const Entry& entry : document.entries) {
    if (entry.key == "scene") continue;
    const Node* node = text.exceeded_at(entry.value);
    if (node == nullptr) continue;
    faults.of_value(*node, {FaultCode::scene_too_large, entry.key,
                            "the expressions of the scene, including this one, are too long",
                            fmt::format("at most {} bytes in all", kMostExpressionText)});
    return false;
  }
  return true;
}

void count_particles(std::vector<BodyDraft>& bodies, std::optional<int> dimension,
                     FaultList& faults) {
  std::int64_t total = 0;
  for (BodyDraft& body : bodies) {
    if (!body.shape_is_known) continue;
    const std::int64_t count = body.record->count(body.description.get());
    const bool too_many = count > kMostParticles - total;
    if (too_many) {
      body.reading.complain(
          faults, count_key(body),
          {FaultCode::scene_too_large, "", too_many_particles(count, total, dimension),
           fmt::format("at most {} particles in a scene", kMostParticles)});
    } else if (count < 1) {
      body.reading.complain(
          faults, count_key(body),
          {FaultCode::scene_out_of_range, "", "a body has at least one particle"});
    } else {
      body.count = count;
      total += count;
    }
    if (!body.count) body.valid = false;
  }
}

bool PairCount::add(ForceDraft& force, const SceneOutline& outline, FaultList& faults) {
  const std::uint64_t count = force.record->pairs(force.description.get(), outline);
  if (count <= kMostPairs - total_) {
    total_ += count;
    return true;
  }
  const std::string which =
      total_ > 0 ? fmt::format(" and the {} of the forces before", total_) : "";
  const double bytes = (static_cast<double>(count) + static_cast<double>(total_)) * kBytesPerPair;
  force.reading.complain(faults, force.reading.has("pairs") ? "pairs" : "",
                         {FaultCode::scene_too_large, "",
                          fmt::format("{} pairs{} would take {}", count, which, memory(bytes)),
                          fmt::format("at most {} pairs in a scene", kMostPairs)});
  return false;
}

}  // namespace tomlin
