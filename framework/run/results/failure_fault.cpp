#include "framework/run/results/failure_fault.hpp"

#include <cstddef>
#include <string>
#include <string_view>

#include "framework/core/records/integrator.hpp"

namespace tomlin {
namespace {

bool is_part_of_word(char c) {
  return c == '_' || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

/// Whether the text has the key as a word of its own.
bool names(std::string_view text, std::string_view key) {
  for (std::size_t at = text.find(key); at != std::string_view::npos; at = text.find(key, at + 1)) {
    const std::size_t end = at + key.size();
    const bool begins = at == 0 || !is_part_of_word(text[at - 1]);
    if (begins && (end == text.size() || !is_part_of_word(text[end]))) return true;
  }
  return false;
}

}  // namespace

Fault fault_of(const RunFailure& failure, const Scene& scene) {
  Fault fault(failure.code);
  fault.location.file = scene.file;
  fault.why = to_string(failure);
  const SceneIntegrator& integrator = scene.run.integrator;
  // With an accuracy the integrator is nowhere in the scene.
  if (integrator.record == nullptr || scene.run.accuracy) return fault;
  for (const std::string* text : {&failure.what, &failure.cause}) {
    for (const Parameter& row : integrator.record->parameters) {
      if (!names(*text, row.key)) continue;
      fault.location = integrator.location_of(row.key);
      fault.key = "run.integrator." + row.key;
      return fault;
    }
  }
  return fault;
}

}  // namespace tomlin
