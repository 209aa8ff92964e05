#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/records/registry.hpp"
#include "framework/scene/scene.hpp"
#include "framework/scene/scene_document.hpp"
#include "framework/scene/sweep_refinement.hpp"
#include "framework/scene/sweep_settings.hpp"

/// A sweep: the same scene over many values of its parameters.
///
///   SweepPlan     what is run: points 0 .. n-1 in the order of the axes, the first one outermost,
///                 each a list of settings as in `--set`, and the columns of the results. Every
///                 process makes the same of the same input, and nothing is changed afterwards but
///                 that points of a refinement are added.
///   SweepBisection  adds them in rounds, by the rows of all points before.
///   SweepQueue    hands out the points that have no row yet, some at a time.
///   run_sweep()   threads that take points from the queue, run them and keep their rows.
///   SweepRows     where rows are kept: SweepJournal, fixed-size checked records in a file, each
///                 under its own number, so that the order in which points end leaves no trace.
///   write_...()   sweep.csv and sweep.h5, made from the rows in the order of the points.
///
/// A row depends on its point alone and has the bits of `tomlin run` with the point's settings.
/// It depends on those before it in its line where points continue from their neighbour: a line has
/// all values of the last dimension for given others, which one thread runs one after the other.
///
/// The computation of rows can therefore be exchanged: lanes take batches of points of one
/// structure from the queue; the workers of an executor (SweepOptions::run_points) get theirs from
/// the queue of the process that has the journal. A part of the points (SweepPart) may be run
/// elsewhere with a journal of its own, and the journals of one plan are merged record by record
/// (merge.hpp).
namespace tomlin {

/// One result that is kept of each run.
struct SweepObservable {
  std::string path;     ///< in full: "drivers.driver.mean_force.x"
  std::string name;     ///< of its column: "driver.mean_force.x"
  std::string unit;     ///< "force"
  std::string meaning;  ///< one line
};

/// A number of each row.
struct SweepColumn {
  enum class Kind {
    value,
    error,   ///< estimated: of the steps, with `[run] accuracy`; statistical, where there is noise
    spread,  ///< between starts that hardly differ; with `[run] perturb`
  } kind = Kind::value;
  std::size_t observable = 0;  ///< index into SweepPlan::observables()
  std::string name;            ///< "driver.mean_force.x", "error.driver.mean_force.x"
};

struct RunResult;

class SweepPlan {
 public:
  /// The registry must outlive the plan. `settings` are those of all points. Throws InputError with
  /// the faults that were found before and those of the scene, the axes and the observables.
  SweepPlan(SceneDocument document, const Registry& registry, std::vector<Setting> settings,
            SweepSettings sweep, std::string program_version, std::vector<Fault> faults = {});

  /// The scene with the settings of all points and without those of the axes; where only they make
  /// it one, the scene of the first point that is not refused.
  const Scene& scene() const { return *scene_; }
  const std::vector<SweepAxis>& axes() const { return sweep_.over; }
  const std::vector<SweepDimension>& dimensions() const { return dimensions_; }
  const std::vector<SweepObservable>& observables() const { return observables_; }
  const std::vector<SweepColumn>& columns() const { return columns_; }
  /// The paths of the observables.
  const std::vector<std::string>& paths() const { return paths_; }
  const std::string& program_version() const { return program_version_; }

  /// Number of points of all dimensions together.
  std::size_t points() const { return points_; }
  /// The refinement that adds points to those of the dimensions, if there is one.
  const std::optional<SweepRefinement>& refinement() const { return refinement_; }
  /// Index into columns() of the observable that decides where points are added.
  std::size_t refined_column() const { return refined_column_; }
  /// Numbers that a point can have: those of the dimensions, then one for each round between each
  /// of these and the next one along the refined axis, whether there is such a point or not.
  std::size_t point_numbers() const { return points_ + added_.size(); }
  /// The number of a point that a round adds.
  std::size_t number_between(std::size_t left, std::size_t round) const {
    return points_ + left * refinement_->rounds + round;
  }
  bool exists(std::size_t point) const {
    return point < points_ || !std::isnan(added_[point - points_]);
  }
  /// Adds a point with this value of the refined axis. Threads may run other points meanwhile.
  void add(std::size_t point, double value) { added_[point - points_] = value; }
  /// The point of the dimensions itself, or the one on the left of an added one.
  std::size_t left_of(std::size_t point) const {
    return point < points_ ? point : (point - points_) / refinement_->rounds;
  }
  /// The number of points from one value of an axis to the next.
  std::size_t stride(std::size_t axis) const { return stride_[dimension_of_[axis]]; }
  /// Points that follow one another, each from the end of the one before it: all of the last
  /// dimension; 1 where they do not.
  std::size_t line() const {
    return sweep_.continues && !dimensions_.empty() ? dimensions_.back().count : 1;
  }
  /// Index of the value that an axis has at a point. At added points the refined axis has none of
  /// its values.
  std::size_t index(std::size_t axis, std::size_t point) const;
  /// Its value there, as SweepValues has it.
  double number(std::size_t axis, std::size_t point) const;
  std::string text(std::size_t axis, std::size_t point) const;
  /// The settings by which a point differs from the scene.
  std::vector<Setting> settings_at(std::size_t point) const;
  /// Throws InputError where the point is refused.
  std::shared_ptr<const Scene> scene_at(std::size_t point,
                                        EffectiveText text = EffectiveText::written) const;

  /// Whether the scene, or that of the last point, has noise.
  bool has_noise_somewhere() const;
  /// Whether a run of the scene, or of the last point, depends on `[run] stream`.
  bool is_random_somewhere() const;
  /// Title of an axis among the columns and the variables of the results: its name, after
  /// "parameters." where that name is taken.
  std::string axis_title(std::size_t axis) const;
  /// The scene with `[sweep]` as it was asked for: `tomlin sweep` of it is the same sweep.
  const std::string& scene_text() const { return scene_text_; }
  /// Texts of the files that axes name, or components that axes change, by their names.
  const std::map<std::string, std::string>& files() const { return files_; }
  /// Identifies the program, scene, plugins, files, axes and observables: a checksum of them all.
  std::uint64_t identity() const { return identity_; }

 private:
  template <class Holds>
  bool somewhere(Holds holds) const;
  bool is_added(std::size_t axis, std::size_t point) const {
    return point >= points_ && refinement_->axis == axis;
  }
  void find_points(std::vector<Fault>& faults);
  void find_scene(std::vector<Fault>& faults);
  void check_axis(std::size_t axis, std::vector<Fault>& faults);
  std::vector<Setting> all_settings_at(std::size_t point) const;
  bool is_accepted(std::size_t point);
  std::optional<Fault> fault_of(const std::vector<Setting>& settings, std::size_t n) const;
  void find_observables(std::vector<Fault>& faults);
  void find_observable(const RunResult& result, const std::string& given,
                       const SourceLocation& location, std::vector<Fault>& faults);
  void name_columns();
  std::string scene_without_sweep();
  std::string write_scene();
  std::uint64_t find_identity() const;

  SceneDocument document_;
  const Registry& registry_;
  std::vector<Setting> settings_;
  SweepSettings sweep_;
  std::string program_version_;
  std::shared_ptr<const Scene> scene_;
  std::vector<SweepDimension> dimensions_;
  std::vector<std::size_t> dimension_of_;  ///< [axis]
  std::vector<std::size_t> stride_;  ///< [dimension]: points from one of its values to the next
  std::size_t points_ = 0;           ///< 0: the axes are not right
  std::optional<SweepRefinement> refinement_;
  std::vector<double> added_;  ///< values of the refined axis; NaN where there is no point
  std::size_t refined_column_ = 0;
  std::vector<SweepObservable> observables_;
  std::vector<std::string> paths_;
  std::vector<SweepColumn> columns_;
  std::map<std::string, std::string> files_;
  std::uint64_t contents_ = 0;  ///< checksum of the scenes of values that are no numbers
  std::string scene_text_;
  std::uint64_t identity_ = 0;
};

}  // namespace tomlin
