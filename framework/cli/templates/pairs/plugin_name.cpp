#include "plugin_name.hpp"

#include <vector>

#include "framework/core/elements/bonds.hpp"
#include "framework/plugin/plugin.hpp"

TOMLIN_DECLARE_KERNELS(PairPluginName)

namespace tomlin {
namespace {

/// Refuses a cutoff within which two images of a particle may be: only one of them would count.
std::vector<Complaint> complaints(const PairPluginNameDescription& d, const SceneOutline& scene) {
  for (const double length : scene.box) {
    if (!(length > 0.0) || d.cutoff <= 0.5 * length) continue;
    return {{.key = "cutoff",
             .why = "it is longer than half the periodic box",
             .admissible = "at most half of each periodic length of the box",
             .code = FaultCode::scene_out_of_range}};
  }
  return {};
}

}  // namespace

/// Returns the name, the source and the parameters of the force. A row for each
/// parameter reads scenes, refuses what is out of range and documents.
ForceRecord plugin_name_record() {
  using Description = PairPluginNameDescription;
  // Between all chosen particles of a body or of two, by the nearest images in a periodic box. Its
  // traits follow from the evaluator: an energy makes it conservative. `tomlin check` tests them.
  ForceRecord record = pair_potential<PairPluginName, kernels::PairPluginName>();
  record.name = "plugin_name";
  record.summary = "a soft repulsion between particles, up to a cutoff";
  record.equation = "V = height * (1 - r^2/cutoff^2)^3 for r < cutoff, each pair once";
  record.source = "the paper that the equation is from, with its number";
  record.complaints = of_description<&complaints>;
  record.parameters = {
      interacting_pairs<Description>().by_default(
          PairSelection{.kind = PairSelection::Kind::all, .list = {}}),
      parameter("height", &Description::height, dimension::energy, "of two coincident particles")
          .in(non_negative),
      parameter("cutoff", &Description::cutoff, dimension::length,
                "from where on there is no force")
          .in(positive)};
  record.example = R"(# Two particles that repel each other.
[[body]]
type = "chain"
count = 2
spacing = 0.5
particle_mass = 1.0

[[force]]
type = "plugin_name"
height = 1.0
cutoff = 1.0

[run]
duration = 10.0
integrator = { type = "rk4", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin

TOMLIN_PLUGIN(registry) { registry.add(tomlin::plugin_name_record()); }
