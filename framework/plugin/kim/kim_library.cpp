#include "framework/plugin/kim/kim_library.hpp"

#include <algorithm>
#include <mutex>
#include <stdexcept>

#include <KIM_Log.hpp>
#include <KIM_SimulatorHeaders.hpp>
#include <fmt/format.h>

#include "framework/core/text/nearest_name.hpp"
#include "framework/plugin/kim/kim_citation.hpp"

namespace tomlin::kim {
namespace {

/// The first error that the library, or a model, has written on this thread since this was emptied:
/// what follows says where it led.
std::string& first_entry() {
  thread_local std::string entry;
  return entry;
}

int keep_entry(const std::string& entry) {
  if (first_entry().empty()) first_entry() = entry;
  return 0;
}

/// Message of an entry of the log: it comes after the time, the kind and the origin.
std::string said(const std::string& entry) {
  std::string text = entry.substr(0, entry.find_last_not_of(" \r\n") + 1);
  const std::size_t at = text.rfind(" * ");
  return at == std::string::npos ? text : text.substr(at + 3);
}

/// Models are made and discarded one at a time: the library keeps what it has loaded in tables of
/// its own. By default it would write a file kim.log.
std::unique_lock<std::mutex> only_one() {
  static std::mutex mutex;
  static const bool quiet = [] {
    KIM::Log::PushDefaultVerbosity(KIM::LOG_VERBOSITY::error);
    KIM::Log::PushDefaultPrintFunction(KIM::LANGUAGE_NAME::cpp,
                                       reinterpret_cast<KIM::Function*>(&keep_entry));
    return true;
  }();
  (void)quiet;
  return std::unique_lock(mutex);
}

struct DestroyCollections {
  void operator()(KIM::Collections* collections) const { KIM::Collections::Destroy(&collections); }
};

/// Items that are installed.
class Installed {
 public:
  Installed() {
    KIM::Collections* collections = nullptr;
    if (KIM::Collections::Create(&collections) != 0) return;
    collections_.reset(collections);
  }

  std::vector<std::string> portable_models() const {
    std::vector<std::string> names;
    int count = 0;
    if (!collections_ || collections_->CacheListOfItemNamesByType(
                             KIM::COLLECTION_ITEM_TYPE::portableModel, &count) != 0) {
      return names;
    }
    for (int k = 0; k < count; ++k) {
      const std::string* name = nullptr;
      if (collections_->GetItemNameByType(k, &name) == 0) names.push_back(*name);
    }
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return names;
  }

  /// "portableModel", say; empty where there is no such item.
  std::string kind_of(const std::string& name) const {
    KIM::CollectionItemType type;
    if (!collections_ || collections_->GetItemType(name, &type) != 0) return {};
    return type.ToString();
  }

  std::string kimspec_of(const std::string& name) const {
    int count = 0;
    if (!collections_ || collections_->CacheListOfItemMetadataFiles(
                             KIM::COLLECTION_ITEM_TYPE::portableModel, name, &count) != 0) {
      return {};
    }
    for (int k = 0; k < count; ++k) {
      const std::string* file = nullptr;
      const std::string* text = nullptr;
      const unsigned char* bytes = nullptr;
      unsigned int length = 0;
      int is_text = 0;
      if (collections_->GetItemMetadataFile(k, &file, &length, &bytes, &is_text, &text) != 0) {
        continue;
      }
      if (*file == "kimspec.edn" && is_text != 0) return *text;
    }
    return {};
  }

 private:
  std::unique_ptr<KIM::Collections, DestroyCollections> collections_;
};

/// "MO_405512056662_005" of "SW_StillingerWeber_1985_Si__MO_405512056662_005".
std::string id_in(const std::string& name) {
  const std::size_t at = name.rfind("__MO_");
  return at == std::string::npos ? std::string() : name.substr(at + 2);
}

/// A model with its arguments; both null where it cannot be had.
struct Loaded {
  KIM::Model* model = nullptr;
  KIM::ComputeArguments* arguments = nullptr;
};

void discard(Loaded& loaded) {
  if (loaded.arguments != nullptr) loaded.model->ComputeArgumentsDestroy(&loaded.arguments);
  if (loaded.model != nullptr) KIM::Model::Destroy(&loaded.model);
}

std::string units_of(const KIM::Model& model) {
  KIM::LengthUnit length;
  KIM::EnergyUnit energy;
  KIM::ChargeUnit charge;
  KIM::TemperatureUnit temperature;
  KIM::TimeUnit time;
  model.GetUnits(&length, &energy, &charge, &temperature, &time);
  return energy.ToString() + " and " + length.ToString();
}

/// A need of the model that is not met; empty where there is none.
std::string unmet_need(const Loaded& loaded) {
  int count = 0;
  KIM::MODEL_ROUTINE_NAME::GetNumberOfModelRoutineNames(&count);
  for (int k = 0; k < count; ++k) {
    KIM::ModelRoutineName routine;
    KIM::MODEL_ROUTINE_NAME::GetModelRoutineName(k, &routine);
    int present = 0;
    int required = 0;
    if (loaded.model->IsRoutinePresent(routine, &present, &required) != 0) continue;
    using namespace KIM::MODEL_ROUTINE_NAME;
    const bool used = routine == Create || routine == ComputeArgumentsCreate ||
                      routine == Compute || routine == Refresh ||
                      routine == ComputeArgumentsDestroy || routine == Destroy;
    if (present != 0 && required != 0 && !used) return "its routine " + routine.ToString();
  }
  KIM::COMPUTE_ARGUMENT_NAME::GetNumberOfComputeArgumentNames(&count);
  for (int k = 0; k < count; ++k) {
    KIM::ComputeArgumentName name;
    KIM::COMPUTE_ARGUMENT_NAME::GetComputeArgumentName(k, &name);
    KIM::SupportStatus status;
    if (loaded.arguments->GetArgumentSupportStatus(name, &status) != 0) continue;
    using namespace KIM::COMPUTE_ARGUMENT_NAME;
    const bool given = name == numberOfParticles || name == particleSpeciesCodes ||
                       name == particleContributing || name == coordinates ||
                       name == partialEnergy || name == partialForces;
    if (status == KIM::SUPPORT_STATUS::required && !given) return "the argument " + name.ToString();
  }
  KIM::COMPUTE_CALLBACK_NAME::GetNumberOfComputeCallbackNames(&count);
  for (int k = 0; k < count; ++k) {
    KIM::ComputeCallbackName name;
    KIM::COMPUTE_CALLBACK_NAME::GetComputeCallbackName(k, &name);
    KIM::SupportStatus status;
    if (loaded.arguments->GetCallbackSupportStatus(name, &status) != 0) continue;
    const bool given = name == KIM::COMPUTE_CALLBACK_NAME::GetNeighborList;
    if (status == KIM::SUPPORT_STATUS::required && !given) return "the function " + name.ToString();
  }
  return {};
}

/// Whether it gives energies, or forces.
bool offers(const Loaded& loaded, KIM::ComputeArgumentName what) {
  KIM::SupportStatus status;
  return loaded.arguments->GetArgumentSupportStatus(what, &status) == 0 &&
         status != KIM::SUPPORT_STATUS::notSupported;
}

std::vector<std::string> species_in(const KIM::Model& model) {
  std::vector<std::string> all;
  int count = 0;
  KIM::SPECIES_NAME::GetNumberOfSpeciesNames(&count);
  for (int k = 0; k < count; ++k) {
    KIM::SpeciesName name;
    KIM::SPECIES_NAME::GetSpeciesName(k, &name);
    int supported = 0;
    int code = 0;
    if (model.GetSpeciesSupportAndCode(name, &supported, &code) == 0 && supported != 0) {
      all.push_back(name.ToString());
    }
  }
  return all;
}

/// A model that is installed, in the units of the engine; what is wrong is in the facts.
Loaded load_model(const std::string& name, ModelFacts& facts) {
  Loaded loaded;
  const auto refuse = [&](const std::string& why, const std::string& admissible) {
    facts.why = why;
    facts.admissible = admissible;
    discard(loaded);
    return loaded;
  };
  first_entry().clear();
  int accepted = 0;
  if (KIM::Model::Create(KIM::NUMBERING::zeroBased, KIM::LENGTH_UNIT::A, KIM::ENERGY_UNIT::eV,
                         KIM::CHARGE_UNIT::e, KIM::TEMPERATURE_UNIT::K, KIM::TIME_UNIT::ps, name,
                         &accepted, &loaded.model) != 0) {
    return refuse(fmt::format("the model cannot be loaded: {}", said(first_entry())),
                  "a model that is complete, with its driver");
  }
  if (accepted == 0) {
    return refuse("the model computes in " + units_of(*loaded.model) + ", and converts nothing",
                  "a model in eV and Angstrom, or one that converts units");
  }
  if (loaded.model->ComputeArgumentsCreate(&loaded.arguments) != 0) {
    return refuse(fmt::format("the model cannot be used: {}", said(first_entry())),
                  "another model");
  }
  if (!offers(loaded, KIM::COMPUTE_ARGUMENT_NAME::partialForces) ||
      !offers(loaded, KIM::COMPUTE_ARGUMENT_NAME::partialEnergy)) {
    const bool energy = offers(loaded, KIM::COMPUTE_ARGUMENT_NAME::partialEnergy);
    return refuse(fmt::format("the model gives no {}", energy ? "forces" : "energy"),
                  "a model that gives its energy and forces");
  }
  if (const std::string need = unmet_need(loaded); !need.empty()) {
    return refuse("the model needs " + need + ", which tomlin does not offer", "another model");
  }
  facts.species = species_in(*loaded.model);
  loaded.model->GetInfluenceDistance(&facts.influence_distance);
  int lists = 0;
  const double* cutoffs = nullptr;
  const int* flags = nullptr;
  loaded.model->GetNeighborListPointers(&lists, &cutoffs, &flags);
  facts.cutoffs.assign(cutoffs, cutoffs + lists);
  const bool finite = facts.reach() > 0.0 && facts.reach() < 1e4;
  if (!finite) {
    return refuse(fmt::format("the model's neighbours are within {} Angstrom", facts.reach()),
                  "a model with a cutoff");
  }
  return loaded;
}

int give_neighbours(void* const data, const int lists, const double* const cutoffs, const int list,
                    const int particle, int* const count, const int** const neighbours) {
  (void)cutoffs;
  const auto& seen = *static_cast<const SeenParticles*>(data);
  const auto at = static_cast<std::size_t>(particle);
  *count = 0;
  if (static_cast<std::size_t>(lists) != seen.lists.size() || list < 0 || list >= lists ||
      particle < 0 || at >= seen.count()) {
    return 1;
  }
  const ModelList& from = seen.lists[static_cast<std::size_t>(list)];
  // The list of a particle about which the model has said that it does not ask.
  if (at + 1 >= from.start.size()) return 1;
  *count = static_cast<int>(from.start[at + 1] - from.start[at]);
  *neighbours = from.neighbours.data() + from.start[at];
  return 0;
}

}  // namespace

double ModelFacts::reach() const {
  double longest = influence_distance;
  for (const double cutoff : cutoffs) longest = std::max(longest, cutoff);
  return longest;
}

ModelFacts examine_model(const std::string& name) {
  const auto lock = only_one();
  ModelFacts facts;
  const Installed installed;
  const std::string kind = installed.kind_of(name);
  if (kind != "portableModel") {
    const std::vector<std::string> names = installed.portable_models();
    facts.code = FaultCode::scene_unknown_name;
    facts.why = kind == "simulatorModel" ? "this is a model for another program to run"
                : kind == "modelDriver"  ? "this is a driver, which a model gives its numbers to"
                                         : "no such model is installed";
    facts.admissible = fmt::format(
        "one of {} portable models, which kim-api-collections-management lists", names.size());
    facts.nearest = nearest_name(name, names).value_or("");
    return facts;
  }
  Loaded loaded = load_model(name, facts);
  discard(loaded);
  facts.id = id_in(name);
  facts.citation = citation_of(installed.kimspec_of(name));
  return facts;
}

PortableModel::PortableModel(const std::string& name) : name_(name) {
  const auto lock = only_one();
  Loaded loaded = load_model(name, facts_);
  if (!facts_.why.empty()) throw std::runtime_error(facts_.why);
  model_ = loaded.model;
  arguments_ = loaded.arguments;
  int lists = 0;
  const double* cutoffs = nullptr;
  const int* never_asks = nullptr;
  model_->GetNeighborListPointers(&lists, &cutoffs, &never_asks);
  for (int k = 0; k < lists; ++k) asks_around_others_.push_back(never_asks[k] == 0);
}

PortableModel::~PortableModel() {
  const auto lock = only_one();
  Loaded loaded{model_, arguments_};
  discard(loaded);
}

int PortableModel::code_of(const std::string& species) const {
  int supported = 0;
  int code = 0;
  if (model_->GetSpeciesSupportAndCode(KIM::SpeciesName(species), &supported, &code) != 0 ||
      supported == 0) {
    throw std::runtime_error("the model has no numbers for " + species);
  }
  return code;
}

bool PortableModel::compute(const SeenParticles& seen, double& energy,
                            std::vector<double>& forces) {
  using namespace KIM::COMPUTE_ARGUMENT_NAME;
  const int count = static_cast<int>(seen.count());
  auto* const data = const_cast<SeenParticles*>(&seen);  // which the callback does not change
  energy = 0.0;
  forces.assign(seen.positions.size(), 0.0);
  first_entry().clear();
  const bool failed =
      arguments_->SetArgumentPointer(numberOfParticles, &count) != 0 ||
      arguments_->SetArgumentPointer(particleSpeciesCodes, seen.species.data()) != 0 ||
      arguments_->SetArgumentPointer(particleContributing, seen.contributing.data()) != 0 ||
      arguments_->SetArgumentPointer(coordinates, seen.positions.data()) != 0 ||
      arguments_->SetArgumentPointer(partialEnergy, &energy) != 0 ||
      arguments_->SetArgumentPointer(partialForces, forces.data()) != 0 ||
      arguments_->SetCallbackPointer(
          KIM::COMPUTE_CALLBACK_NAME::GetNeighborList, KIM::LANGUAGE_NAME::cpp,
          reinterpret_cast<KIM::Function*>(&give_neighbours), data) != 0 ||
      model_->Compute(arguments_) != 0;
  if (failed) error_ = said(first_entry());
  return !failed;
}

}  // namespace tomlin::kim
