#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/core/records/registry.hpp"
#include "framework/plot/figure.hpp"
#include "framework/plot/quantities.hpp"
#include "framework/plot/stored_run.hpp"

namespace tomlin {

struct SurfaceRequest {
  Owners owners;
  std::optional<double> from;  ///< of the path, along x
  std::optional<double> to;
  double width = kPanelWidth;  ///< of the panel as drawn at last
};

/// The path of a body's centre of mass along x and y over the potential energy of one particle on
/// the substrates of scene.toml, in shades of grey and to scale. Substrates are forces with a
/// period that act on this body alone from outside it and have an energy which does not depend on
/// time; in three dimensions the particle is at the height where the path begins. Throws InputError
/// where there is no such force.
Figure surface_figure(const StoredRun& run, const SurfaceRequest& request,
                      const Registry& registry);

}  // namespace tomlin
