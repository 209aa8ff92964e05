#pragma once

#include <memory>
#include <string>

#include "framework/core/records/force.hpp"
#include "framework/plugin/kim/kim_library.hpp"

/// An interatomic potential by the KIM API: any portable model that is installed.
///
///   V = sum_i V_i,  the energy of each atom as the model gives it
///
/// Bodies that are fixed are atoms of the configuration, too: what depends on them alone is a
/// constant of V, and they take no force.
namespace tomlin {

struct KimModelDescription {
  std::string model;
  std::shared_ptr<const kim::ModelFacts> facts;  ///< since it was prepared
};

ForceRecord kim_model_record();

}  // namespace tomlin
