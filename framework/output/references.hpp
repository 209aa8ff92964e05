#pragma once

#include <string>
#include <vector>

#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"

/// Works to cite for a run.
namespace tomlin {

struct CitedWork {
  std::string work;                   ///< with its DOI where it has one
  std::vector<std::string> used_for;  ///< types of components, "scene", "tomlin" and the like
};

/// The works behind everything that the scene uses, each once: of bodies, forces and integrators,
/// the scene's own, those of file formats and random numbers where they are used, and tomlin
/// itself. `accuracy`: of a run that chose its integrator, which is then the one that counts.
std::vector<CitedWork> references(const Scene& scene, const AccuracyResult* accuracy = nullptr);

}  // namespace tomlin
