#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/records/body.hpp"
#include "framework/core/records/force.hpp"
#include "framework/core/records/observer.hpp"
#include "framework/core/text/warning.hpp"
#include "framework/scene/fault_list.hpp"
#include "framework/scene/scene.hpp"
#include "framework/scene/table_reader.hpp"

/// Faults that only show when keys are held against each other or against the bodies.
namespace tomlin {

/// A body or a force while its scene is read.
template <class Record>
struct ComponentDraft {
  std::string name;                ///< empty when it has none that is fit
  const Record* record = nullptr;  ///< nullptr when its type is unfit
  std::shared_ptr<void> description;
  TableReading reading;
  bool valid = false;  ///< no fault so far
};

struct BodyDraft : ComponentDraft<BodyRecord> {
  std::vector<std::string> hold;
  std::optional<Motion> motion;
  bool shape_is_known = false;        ///< every key that the shape depends on was read
  std::optional<std::int64_t> count;  ///< when known
};

struct ForceDraft : ComponentDraft<ForceRecord> {
  std::vector<std::size_t> bodies;  ///< those that could be found
  bool driver = false;
  std::optional<ActiveSettings> active;
  Table active_effective;  ///< with its defaults filled in
  std::vector<Warning> warnings;
};

/// Its parameters that differ between particles.
std::vector<Variation> variations_of(const ForceDraft& force);

struct ObserverDraft : ComponentDraft<ObserverRecord> {
  std::vector<std::size_t> bodies;  ///< those that could be found
};

/// Files that bodies refer to are fetched; afterwards it is known which shapes are.
void prepare_bodies(std::vector<BodyDraft>& bodies, const std::filesystem::path& folder,
                    FaultList& faults);

/// The file that a force refers to is fetched; before the values of particles are read.
void prepare_force(ForceDraft& force, const std::filesystem::path& folder, FaultList& faults);

/// The scene's dimension: the length of the first body's vectors. Nothing when faults hide it.
std::optional<int> scene_dimension(const std::vector<BodyDraft>& bodies);

/// Lengths of vectors and lists, indices, and what the records themselves find.
void check_bodies(std::vector<BodyDraft>& bodies, std::optional<int> dimension, FaultList& faults);
/// The box is null where it has faults; then what the records find is not asked for.
void check_forces(std::vector<ForceDraft>& forces, const std::vector<BodyDraft>& bodies,
                  const BoxSettings* box, std::optional<int> dimension, FaultList& faults);

void check_observers(std::vector<ObserverDraft>& observers, const std::vector<BodyDraft>& bodies,
                     const BoxSettings* box, std::optional<int> dimension, FaultList& faults);

/// Complaints by `look` about a component's values. When the code of a plugin throws instead,
/// that is the complaint, about the type that brought it in.
template <class Look>
std::vector<Complaint> complaints_of(const ComponentRecord& record, Look look) {
  if (record.library.empty()) return look();
  const auto thrown = [&](const std::string& said) -> std::vector<Complaint> {
    return {{.key = "type",
             .why = "the plugin " + record.library +
                    " has thrown an exception while looking at the scene: " + said,
             .code = FaultCode::plugin_error}};
  };
  try {
    return look();
  } catch (const std::exception& error) {
    return thrown(error.what());
  } catch (...) {
    return thrown("an exception that is no std::exception");
  }
}

/// Reports what a record found when it compared a component's keys with each other.
void report(const std::vector<Complaint>& complaints, const TableReading& reading,
            FaultList& faults);

}  // namespace tomlin
