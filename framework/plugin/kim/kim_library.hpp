#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "framework/core/text/fault_code.hpp"

namespace KIM {  // NOLINT(readability-identifier-naming): the library's own
class ComputeArguments;
class Model;
}  // namespace KIM

/// Interatomic models as the KIM API has them (E. B. Tadmor et al., JOM 63 (2011) 17,
/// doi:10.1007/s11837-011-0102-6). Nothing here knows of bodies or of a scene. Lengths are in
/// Angstrom, energies in eV, forces in eV/Angstrom.
namespace tomlin::kim {

/// Facts that a model gives about itself, or the reason why it cannot be used.
struct ModelFacts {
  std::string why;  ///< empty: it can
  std::string admissible;
  std::string nearest;  ///< the name of an installed model that was probably meant
  FaultCode code = FaultCode::component_unsuitable;

  std::vector<std::string> species;  ///< that it has numbers for
  double influence_distance = 0.0;   ///< what is further from an atom is not in its energy
  std::vector<double> cutoffs;       ///< of its neighbour lists
  std::string id;                    ///< "MO_405512056662_005"; empty: it has none
  std::string citation;              ///< of the work that it says it is from; empty: it says none

  /// The largest of the cutoffs of all lists and of the influence distance.
  double reach() const;
};
ModelFacts examine_model(const std::string& name);

/// Neighbours of the particles that a model sees: [start of i, start of i + 1) are near particle i.
struct ModelList {
  std::vector<std::size_t> start;
  std::vector<int> neighbours;
};

/// Particles as a model sees them: first those whose energies are asked for, then others.
struct SeenParticles {
  std::vector<int> species;       ///< the model's codes
  std::vector<int> contributing;  ///< 1 where the energy is asked for
  std::vector<double> positions;  ///< [particle][axis]
  std::vector<ModelList> lists;   ///< one for each cutoff of the model

  std::size_t count() const { return species.size(); }
};

/// A model at work. Each run has one of its own.
class PortableModel {
 public:
  /// Throws std::runtime_error where examine_model() says why.
  explicit PortableModel(const std::string& name);
  ~PortableModel();
  PortableModel(const PortableModel&) = delete;
  PortableModel& operator=(const PortableModel&) = delete;

  const std::string& name() const { return name_; }
  const ModelFacts& facts() const { return facts_; }
  /// Whether it asks for the neighbours, in a list, of particles whose energies are not asked for.
  bool asks_around_others(std::size_t list) const { return asks_around_others_[list]; }
  int code_of(const std::string& species) const;

  /// The energies' sum and its negative gradient [particle][axis]. False: the model has returned
  /// an error, which `error()` says, and what is in the two is undefined.
  bool compute(const SeenParticles& seen, double& energy, std::vector<double>& forces);
  const std::string& error() const { return error_; }

 private:
  std::string name_;
  ModelFacts facts_;
  std::vector<bool> asks_around_others_;
  std::string error_;
  KIM::Model* model_ = nullptr;
  KIM::ComputeArguments* arguments_ = nullptr;
};

}  // namespace tomlin::kim
