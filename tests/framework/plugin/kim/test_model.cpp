// Small portable models for the tests of kim_model: this file is compiled once for each, with its
// name as TOMLIN_TEST_MODEL_NAME and what it is as TOMLIN_TEST_MODEL_KIND.
//
//   pair         the Lennard-Jones potential of argon and krypton with a linear term by which the
//                force ends at the cutoff, each pair once; no neighbours of others
//   coordinated  sum_i sum_j phi(r_ij) (1 + c n_j), n_j = sum_k f(r_jk): the energy of an atom
//                depends on its neighbours' neighbours, two lists, those of others, too
//   faulty       the pair potential with the fault that the variable FAULT of the environment names
//
// Numbers of both stand in test_models.hpp.

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <vector>

#include <KIM_ModelHeaders.hpp>
#include <KIM_SharedLibrarySchema.hpp>

#include "tests/framework/plugin/kim/test_models.hpp"

namespace {

using tomlin::test::coordination;
using tomlin::test::kCoordinatedReach;
using tomlin::test::kCoordinationReach;
using tomlin::test::kCoordinationWeight;
using tomlin::test::kPairCutoff;
using tomlin::test::pair_energy;
using tomlin::test::phi;
using tomlin::test::ValueAndSlope;

enum Kind { pair, coordinated, faulty };
constexpr Kind kKind = TOMLIN_TEST_MODEL_KIND;

/// One that stays: the API keeps pointers to these.
struct Settings {
  double influence = kKind == coordinated ? kCoordinatedReach + kCoordinationReach : kPairCutoff;
  double cutoffs[2] = {kKind == coordinated ? kCoordinatedReach : kPairCutoff, kCoordinationReach};
  int never_asks[2] = {1, 0};
};
Settings settings;

bool has_fault(const char* name) {
  const char* fault = kKind == faulty ? std::getenv("FAULT") : nullptr;
  return fault != nullptr && std::strcmp(fault, name) == 0;
}

struct Given {
  const int* count = nullptr;
  const int* species = nullptr;
  const int* contributing = nullptr;
  const double* positions = nullptr;
  double* energy = nullptr;
  double* forces = nullptr;
};

struct Separation {
  double way[3];
  double distance;
};

Separation between(const Given& g, int i, int j) {
  Separation s{};
  double squared = 0.0;
  for (int d = 0; d < 3; ++d) {
    s.way[d] = g.positions[3 * j + d] - g.positions[3 * i + d];
    squared += s.way[d] * s.way[d];
  }
  s.distance = std::sqrt(squared);
  return s;
}

/// Adds the force along a separation to both ends.
void pull(const Given& g, int i, int j, const Separation& s, double slope) {
  for (int d = 0; d < 3 && g.forces != nullptr; ++d) {
    const double part = slope * s.way[d] / s.distance;
    g.forces[3 * i + d] += part;
    g.forces[3 * j + d] -= part;
  }
}

struct List {
  int count = 0;
  const int* near = nullptr;
};

bool list_of(const KIM::ModelComputeArguments* arguments, int list, int particle, List& found) {
  return arguments->GetNeighborList(list, particle, &found.count, &found.near) == 0;
}

bool add_pairs(const KIM::ModelComputeArguments* arguments, const Given& g) {
  for (int i = 0; i < *g.count; ++i) {
    if (g.contributing[i] == 0) continue;
    List near;
    if (!list_of(arguments, 0, i, near)) return false;
    for (int k = 0; k < near.count; ++k) {
      const int j = near.near[k];
      if (g.contributing[j] != 0 && j < i) continue;
      const Separation s = between(g, i, j);
      if (has_fault("error_when_near") && s.distance < 3.0) return false;
      if (!(s.distance < kPairCutoff)) continue;
      const double share = g.contributing[j] != 0 ? 1.0 : 0.5;
      const ValueAndSlope v = pair_energy(g.species[i], g.species[j], s.distance);
      *g.energy += share * v.value;
      pull(g, i, j, s, share * v.slope);
    }
  }
  return true;
}

bool add_coordinated(const KIM::ModelComputeArguments* arguments, const Given& g) {
  for (int i = 0; i < *g.count; ++i) {
    if (g.contributing[i] == 0) continue;
    List near;
    if (!list_of(arguments, 0, i, near)) return false;
    // The next list is asked for before this one is done with.
    const std::vector<int> neighbours(near.near, near.near + near.count);
    for (const int j : neighbours) {
      const Separation s = between(g, i, j);
      if (!(s.distance < kCoordinatedReach)) continue;
      List around;
      if (!list_of(arguments, 1, j, around)) return false;
      double n = 0.0;
      for (int k = 0; k < around.count; ++k) {
        n += coordination(between(g, j, around.near[k]).distance).value;
      }
      const ValueAndSlope v = phi(g.species[i] + g.species[j], s.distance);
      *g.energy += v.value * (1.0 + kCoordinationWeight * n);
      pull(g, i, j, s, v.slope * (1.0 + kCoordinationWeight * n));
      for (int k = 0; k < around.count; ++k) {
        const Separation r = between(g, j, around.near[k]);
        const ValueAndSlope f = coordination(r.distance);
        pull(g, j, around.near[k], r, kCoordinationWeight * v.value * f.slope);
      }
    }
  }
  return true;
}

int create_arguments(const KIM::ModelCompute*, KIM::ModelComputeArgumentsCreate* const arguments) {
  using namespace KIM::SUPPORT_STATUS;
  const bool no_forces = has_fault("no_forces");
  int error =
      arguments->SetArgumentSupportStatus(KIM::COMPUTE_ARGUMENT_NAME::partialEnergy, required);
  error |= arguments->SetArgumentSupportStatus(KIM::COMPUTE_ARGUMENT_NAME::partialForces,
                                               no_forces ? notSupported : optional);
  if (has_fault("needs_derivatives")) {
    error |=
        arguments->SetCallbackSupportStatus(KIM::COMPUTE_CALLBACK_NAME::ProcessDEDrTerm, required);
  }
  return error;
}

int destroy_arguments(const KIM::ModelCompute*, KIM::ModelComputeArgumentsDestroy*) { return 0; }
int destroy(KIM::ModelDestroy*) { return 0; }

int compute(const KIM::ModelCompute* const model,
            const KIM::ModelComputeArguments* const arguments) {
  using namespace KIM::COMPUTE_ARGUMENT_NAME;
  Given g;
  const bool unknown = arguments->GetArgumentPointer(numberOfParticles, &g.count) != 0 ||
                       arguments->GetArgumentPointer(particleSpeciesCodes, &g.species) != 0 ||
                       arguments->GetArgumentPointer(particleContributing, &g.contributing) != 0 ||
                       arguments->GetArgumentPointer(coordinates, &g.positions) != 0 ||
                       arguments->GetArgumentPointer(partialEnergy, &g.energy) != 0 ||
                       arguments->GetArgumentPointer(partialForces, &g.forces) != 0;
  if (unknown) return 1;
  *g.energy = 0.0;
  for (int k = 0; k < 3 * *g.count; ++k) g.forces[k] = 0.0;
  const bool done = kKind == coordinated ? add_coordinated(arguments, g) : add_pairs(arguments, g);
  if (!done) {
    model->LogEntry(KIM::LOG_VERBOSITY::error, "two atoms are too near", __LINE__, __FILE__);
    return 1;
  }
  if (has_fault("no_number")) g.forces[3] = std::numeric_limits<double>::quiet_NaN();
  return 0;
}

int create(KIM::ModelCreate* const model, const KIM::LengthUnit, const KIM::EnergyUnit,
           const KIM::ChargeUnit, const KIM::TemperatureUnit, const KIM::TimeUnit) {
  using namespace KIM::MODEL_ROUTINE_NAME;
  const auto routine = [](auto* f) { return reinterpret_cast<KIM::Function*>(f); };
  const KIM::LanguageName cpp = KIM::LANGUAGE_NAME::cpp;
  if (has_fault("not_created")) {
    model->LogEntry(KIM::LOG_VERBOSITY::error, "no parameters", __LINE__, __FILE__);
    return 1;
  }
  int error = model->SetModelNumbering(KIM::NUMBERING::zeroBased);
  error |= model->SetUnits(
      KIM::LENGTH_UNIT::A, has_fault("units") ? KIM::ENERGY_UNIT::kcal_mol : KIM::ENERGY_UNIT::eV,
      KIM::CHARGE_UNIT::unused, KIM::TEMPERATURE_UNIT::unused, KIM::TIME_UNIT::unused);
  error |= model->SetRoutinePointer(ComputeArgumentsCreate, cpp, 1, routine(&create_arguments));
  error |= model->SetRoutinePointer(Compute, cpp, 1, routine(&compute));
  error |= model->SetRoutinePointer(ComputeArgumentsDestroy, cpp, 1, routine(&destroy_arguments));
  error |= model->SetRoutinePointer(Destroy, cpp, 1, routine(&destroy));
  error |= model->SetSpeciesCode(KIM::SPECIES_NAME::Ar, 0);
  error |= model->SetSpeciesCode(KIM::SPECIES_NAME::Kr, 1);
  model->SetInfluenceDistancePointer(&settings.influence);
  model->SetNeighborListPointers(kKind == coordinated ? 2 : 1, settings.cutoffs,
                                 settings.never_asks);
  return error;
}

}  // namespace

extern "C" {

extern int kim_shared_library_schema_version;
extern KIM::SHARED_LIBRARY_SCHEMA::SharedLibrarySchemaV2 kim_shared_library_schema;

int kim_shared_library_schema_version = 2;
KIM::SHARED_LIBRARY_SCHEMA::SharedLibrarySchemaV2 kim_shared_library_schema = {
    KIM::COLLECTION_ITEM_TYPE::portableModel,
    TOMLIN_TEST_MODEL_NAME,
    KIM::LANGUAGE_NAME::cpp,
    reinterpret_cast<KIM::Function*>(&create),
    "",
    nullptr,
    0,
    nullptr,
    0,
    nullptr};
}
