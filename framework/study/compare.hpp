#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/records/registry.hpp"
#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"

/// Models side by side: which is the simplest that still gives the answer?
///
/// Models are comparable when they are driven alike over like substrates: the same driving velocity
/// and the same lattice periods along it, to rounding. Of scenes of different dimensions the speeds
/// are compared, whatever the axis; and a scene that declares no period, such as a sheet of atoms,
/// is compared with any. Driver stiffness and amplitude may differ, as they do for one tip and for
/// N of them; what differs is said. The model with the most free coordinates is what the others are
/// held against. One agrees when its observable is within the tolerance of that one's, the
/// estimated errors of both included; where the errors alone are larger than the tolerance, that is
/// undecided.
namespace tomlin {

struct ComparedModel {
  enum class Verdict { reference, agrees, differs, undecided, failed } verdict = Verdict::failed;
  std::string file;
  std::string name;  ///< of the scene, or of its file
  std::size_t bodies = 0;
  std::size_t particles = 0;
  std::size_t coordinates = 0;  ///< free ones
  RunResult result;
  std::optional<double> value;
  std::optional<double> error;       ///< estimated, in the observable's unit
  std::optional<double> difference;  ///< from the reference
  /// The driver's force along its pull against its way, in the observable's window; no more than a
  /// thousand points.
  std::vector<double> way;
  std::vector<double> force;

  std::uint64_t cost() const { return result.force_evaluations + result.jacobian_columns; }
};

constexpr auto word_table(ComparedModel::Verdict) {
  using enum ComparedModel::Verdict;
  return std::to_array<Word<ComparedModel::Verdict>>({{reference, "reference"},
                                                      {agrees, "agrees"},
                                                      {differs, "differs"},
                                                      {undecided, "undecided"},
                                                      {failed, "failed"}});
}

struct CompareRequest {
  std::string observable;   ///< "driver" and "body" stand for the only one of a scene
  double tolerance = 1e-2;  ///< relative to the reference's value; absolute where that is zero
  const std::atomic<bool>* stop = nullptr;
  std::function<void(const std::string&)> on_progress = {};  ///< called with each scene's file
};

struct Comparison {
  std::string observable;
  UnitSystem units = UnitSystem::reduced;  ///< of all scenes
  double tolerance = 0.0;
  std::vector<ComparedModel> models;     ///< in the order given
  std::optional<std::size_t> reference;  ///< nothing when it failed
  std::optional<std::size_t> simplest;   ///< the fewest coordinates of those that agree
  std::vector<std::string> notes;        ///< what differs between the scenes
  bool interrupted = false;
};

/// Throws InputError for scenes that are not comparable, and for an observable that one of them
/// does not have. A run that fails is a model that failed.
Comparison compare_models(const std::vector<std::shared_ptr<const Scene>>& scenes,
                          const CompareRequest& request);

}  // namespace tomlin
