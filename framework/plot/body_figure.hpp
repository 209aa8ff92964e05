#pragma once

#include <string>
#include <vector>

#include "framework/core/records/registry.hpp"
#include "framework/plot/figure.hpp"
#include "framework/plot/quantities.hpp"
#include "framework/plot/stored_run.hpp"

namespace tomlin {

/// A planar body at chosen moments: its particles, one of them marked.
struct BodyRequest {
  std::string x = "time";  ///< a quantity or a column, by which moments are named
  std::vector<double> at;  ///< its values, each where the run first has it; empty: five of them
  Owners owners;
};

/// A panel for each run, to scale: the particles of the body, from its centre, its rotation and the
/// shape it has in scene.toml, the first particle marked, the centre of mass and where the drivers
/// pull. Between samples it is interpolated. A flexible body is drawn in the shape it starts with,
/// which `notes` then says. Throws InputError for values outside a run and what the files do not
/// have.
Figure body_figure(const std::vector<StoredRun>& runs, const std::vector<std::string>& labels,
                   const BodyRequest& request, const Registry& registry,
                   std::vector<std::string>& notes);

}  // namespace tomlin
