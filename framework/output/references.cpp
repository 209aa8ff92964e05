#include "framework/output/references.hpp"

#include <algorithm>
#include <cstddef>
#include <map>

#include "framework/core/text/citation.hpp"

namespace tomlin {
namespace {

constexpr const char* kH5mdSource =
    "P. de Buyl, P. H. Colberg and F. Hofling, H5MD: a structured, efficient, and portable file "
    "format for molecular data, Comput. Phys. Commun. 185 (2014) 1546, "
    "doi:10.1016/j.cpc.2014.01.018";
constexpr const char* kPhiloxSource =
    "J. K. Salmon, M. A. Moraes, R. O. Dror and D. E. Shaw, Parallel random numbers: as easy as 1, "
    "2, 3, Proc. SC11 (2011), doi:10.1145/2063384.2063405";
constexpr const char* kProgramSource = "The tomlin authors, tomlin " TOMLIN_VERSION " (2026)";

/// Works in the order in which they were first named.
class Bibliography {
 public:
  void add(const std::string& source, const std::string& used_for) {
    for (Citation& citation : citations(source)) {
      const auto [known, is_new] = indices_.try_emplace(identity_of(citation), works_.size());
      if (is_new) works_.push_back({std::move(citation.work), {}});
      auto& users = works_[known->second].used_for;
      if (std::find(users.begin(), users.end(), used_for) == users.end()) {
        users.push_back(used_for);
      }
    }
  }
  void add(const ComponentRecord& component) { add(component.source, component.name); }

  std::vector<CitedWork> works() && { return std::move(works_); }

 private:
  std::vector<CitedWork> works_;
  std::map<std::string, std::size_t> indices_;
};

}  // namespace

std::vector<CitedWork> references(const Scene& scene, const AccuracyResult* accuracy) {
  Bibliography all;
  for (const SceneBody& body : scene.bodies) all.add(*body.record);
  for (const SceneForce& force : scene.forces) {
    if (force.record->source != kSourceIsTheScene) all.add(*force.record);
  }
  for (const SceneObserver& observer : scene.observers) all.add(*observer.record);
  if (accuracy == nullptr) {
    // With an accuracy the scene's integrator is only one that could be taken.
    const IntegratorRecord* scheme = scene.run.integrator.record;
    if (scheme != nullptr && !scene.run.accuracy) all.add(*scheme);
  } else {
    for (const IntegratorRecord* scheme : {accuracy->scheme, accuracy->companion_scheme}) {
      if (scheme != nullptr) all.add(*scheme);
    }
  }
  all.add(scene.source, "scene");
  const OutputSettings& output = scene.output;
  if (output.trajectory && output.trajectory_format == TrajectoryFormat::h5md) {
    all.add(kH5mdSource, "trajectory.h5");
  }
  if (scene.draws_random) all.add(kPhiloxSource, "random numbers of the scene");
  if (scene.run.perturb) all.add(kPhiloxSource, "perturb");
  if (draws_by_stream(scene)) all.add(kPhiloxSource, "noise");
  all.add(kProgramSource, "tomlin");
  return std::move(all).works();
}

}  // namespace tomlin
