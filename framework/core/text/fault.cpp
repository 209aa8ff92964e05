#include "framework/core/text/fault.hpp"

#include <utility>

#include <fmt/format.h>

namespace tomlin {
namespace {

std::string joined(const std::vector<Fault>& faults) {
  std::string text;
  for (const Fault& fault : faults) {
    if (!text.empty()) text += '\n';
    text += to_string(fault);
  }
  return text;
}

}  // namespace

std::string to_string(const Fault& fault) {
  std::string text = fault.place.file;
  if (fault.place.line > 0) {
    text += ':' + std::to_string(fault.place.line) + ':' + std::to_string(fault.place.column);
  }
  text += ": error: ";
  if (!fault.key.empty()) {
    text += fault.key;
    if (!fault.value.empty()) text += " = " + fault.value;
    text += ": ";
  }
  text += fault.why;
  if (!fault.admissible.empty()) text += "; admissible: " + fault.admissible;
  if (!fault.nearest.empty()) text += "; did you mean \"" + fault.nearest + "\"?";
  text += fmt::format(" [{}]", id_of(fault.code));
  return text;
}

InputError::InputError(std::vector<Fault> faults)
    : std::runtime_error(joined(faults)), faults_(std::move(faults)) {}

void refuse_input(FaultCode code, std::string file, std::string key, std::string why,
                  std::string admissible, std::string nearest) {
  throw InputError({Fault(code, {.file = std::move(file)}, std::move(key), "", std::move(why),
                          std::move(admissible), std::move(nearest))});
}

}  // namespace tomlin
