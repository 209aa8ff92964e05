#include "plugin_name.hpp"

#include "framework/core/elements/site_force.hpp"
#include "framework/plugin/plugin.hpp"

TOMLIN_DECLARE_KERNELS(PluginName)

namespace tomlin {

/// Returns the name, the source and the parameters of the force. A row for each
/// parameter reads scenes, refuses what is out of range and documents.
ForceRecord plugin_name_record() {
  // Its traits follow from the evaluator: an energy makes it conservative. `tomlin check` tests
  // them.
  ForceRecord record = site_force<PluginName, kernels::PluginName>();
  record.name = "plugin_name";
  record.summary = "a harmonic trap about zero, for each particle";
  record.equation = "V = (stiffness/2) |x|^2, per particle";
  record.source = "the paper that the equation is from, with its number";
  record.parameters = {parameter("stiffness", &PluginNameDescription::stiffness,
                                 dimension::stiffness, "how strongly the trap binds")
                           .in(positive)};
  record.example = R"(# A particle that swings in the trap.
[[body]]
type = "point"
position = [1.0]
particle_mass = 1.0

[[force]]
type = "plugin_name"
stiffness = 4.0

[run]
duration = 10.0
integrator = { type = "rk4", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin

TOMLIN_PLUGIN(registry) { registry.add(tomlin::plugin_name_record()); }
