#include "framework/plugin/load.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "framework/core/records/force.hpp"
#include "framework/core/records/integrator.hpp"
#include "framework/core/records/number_type.hpp"
#include "framework/core/records/observer.hpp"
#include "framework/core/text/text_file.hpp"
#include "framework/plugin/content_hash.hpp"
#include "framework/plugin/elf_note.hpp"
#include "framework/plugin/note.hpp"
#include "framework/plugin/registration.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kLargestLibrary = std::size_t{1} << 30;  // bytes

const ComponentRecord* component(const Registry& registry, const std::string& name) {
  if (const auto* record = registry.body(name)) return record;
  if (const auto* record = registry.force(name)) return record;
  if (const auto* record = registry.integrator(name)) return record;
  return registry.observer(name);
}

/// Why a component cannot be taken; empty when it can.
std::string taken(const Registry& registry, const ComponentRecord& record) {
  const ComponentRecord* there = component(registry, record.name);
  if (there == nullptr) return "";
  return fmt::format("its component \"{}\" has the name of one {}", record.name,
                     there->library.empty() ? "that is built in" : "from " + there->library);
}

bool holds(const std::vector<std::string>& types, NumberType type) {
  return std::find(types.begin(), types.end(), to_string(type)) != types.end();
}

/// Forces cannot be run in a number type for which the library has no kernels.
template <class Record>
void keep_number_types(Record& record, const std::vector<std::string>& types) {
  if constexpr (requires { record.bind; }) {
    if (!holds(types, NumberType::quadruple_precision)) record.bind.in_quadruple = nullptr;
  }
}

template <class Records>
void hand_over(const Records& records, const PluginFile& file, const fs::path& path,
               Registry& registry) {
  for (const auto& record : records) {
    record->library = path.string();
    keep_number_types(*record, file.number_types);
    registry.add(std::move(*record));
  }
}

std::vector<std::string>& loaded() {
  static std::vector<std::string> paths;  // like what is loaded, the whole process's
  return paths;
}

/// Empty when the library's components are in the registry now.
std::string load(const PluginRequest& request, const PluginFile& file, Registry& registry) {
  if (std::string why = probe_registration(request.path); !why.empty()) return why;
  // On its own first, so that of a library that fails nothing is left.
  loaded().push_back(request.path.string());
  Registry added;
  if (std::string why = register_components(request.path, added); !why.empty()) return why;
  std::string why;
  for_each_kind(added, [&](const auto& records) {
    for (const auto& record : records) {
      if (why.empty()) why = taken(registry, *record);
    }
  });
  if (!why.empty()) return why;
  for_each_kind(added,
                [&](const auto& records) { hand_over(records, file, request.path, registry); });
  registry.add(Library{request.given, request.path.string(), file.hash, request.everywhere});
  return "";
}

}  // namespace

const std::vector<std::string>& loaded_plugins() { return loaded(); }

PluginFile examine_plugin(const fs::path& path) {
  PluginFile file;
  std::error_code error;
  const auto size = fs::file_size(path, error);
  if (!error && size > kLargestLibrary) {
    file.why = fmt::format("it has {} MB; at most {} MB", size >> 20, kLargestLibrary >> 20);
    return file;
  }
  TextFile content = read_text_file(path, error ? 0 : static_cast<std::size_t>(size));
  if (content.too_large) content.why = "the file is changing while it is read";
  if (!content.why.empty()) {
    file.why = content.why;
    return file;
  }
  const auto bytes = std::as_bytes(std::span(content.text));
  file.hash = content_hash(bytes);
  const ElfNote elf = read_elf_note(bytes);
  if (!elf.why.empty()) {
    file.why = elf.why;
    return file;
  }
  const auto note = parse_note(elf.text);
  if (!note) {
    file.why = "tomlin's note in it is damaged";
    return file;
  }
  file.number_types = note->number_types;
  file.why = mismatch(*note, own_note());
  if (file.why.empty() && !holds(file.number_types, NumberType::double_precision))
    file.why = "it has no doubles";
  if (!file.why.empty()) file.code = FaultCode::plugin_mismatch;
  return file;
}

void load_plugins(const std::vector<PluginRequest>& requests, Registry& registry) {
  std::vector<Fault> faults;
  for (const PluginRequest& request : requests) {
    if (registry.library(request.path.string()) != nullptr) continue;
    const PluginFile file = examine_plugin(request.path);
    const std::string why = file.why.empty() ? load(request, file, registry) : file.why;
    if (why.empty()) continue;
    faults.emplace_back(file.code, request.location, "plugins",
                        fmt::format("\"{}\"", request.given),
                        fmt::format("the plugin {}: {}", request.path.string(), why));
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

}  // namespace tomlin
