#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "forcefields/register_forces.hpp"
#include "framework/bodies/register_bodies.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/scene/scene.hpp"
#include "integrators/register_integrators.hpp"

/// Any bytes are a scene or are refused with InputError. A scene that is accepted is read again
/// from its effective form, to the same. Lines that begin with "#set " are given as `--set`, so
/// that the input itself stays TOML.
namespace tomlin {
namespace {

constexpr const char* kFile = "fuzz.toml";
constexpr std::string_view kSettingMark = "#set ";

Registry all_components() {
  Registry registry;
  register_bodies(registry);
  register_forcefields(registry);
  register_integrators(registry);
  return registry;
}

std::vector<Setting> settings_in(std::string_view text) {
  std::vector<Setting> settings;
  while (!text.empty()) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(line.size() < text.size() ? line.size() + 1 : line.size());
    if (!line.starts_with(kSettingMark)) continue;
    line.remove_prefix(kSettingMark.size());
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) continue;
    settings.push_back({std::string(line.substr(0, equals)), std::string(line.substr(equals + 1))});
  }
  return settings;
}

[[noreturn]] void fail(const char* what, const std::string& text) {
  std::fprintf(stderr, "%s:\n%s\n", what, text.c_str());
  std::abort();
}

void read_again(const std::string& effective, const Registry& registry) {
  try {
    const auto again = parse_scene(effective, kFile, registry);
    if (again->effective_toml == effective) return;
    fail("the effective scene is not read as itself, but as", again->effective_toml);
  } catch (const InputError& error) {
    fail("the effective scene is refused", std::string(error.what()) + "\n" + effective);
  }
}

void read(std::string_view text) {
  static const Registry registry = all_components();
  std::string effective;
  try {
    effective = parse_scene(text, kFile, registry, settings_in(text))->effective_toml;
  } catch (const InputError& error) {
    if (error.faults().empty() || *error.what() == '\0') fail("refused without a reason", "");
    return;
  }
  read_again(effective, registry);
}

}  // namespace
}  // namespace tomlin

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  tomlin::read({reinterpret_cast<const char*>(data), size});
  return 0;
}
