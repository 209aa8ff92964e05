#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "framework/core/records/body.hpp"
#include "framework/core/records/force.hpp"
#include "framework/core/records/integrator.hpp"
#include "framework/core/records/number_type.hpp"
#include "framework/core/records/observer.hpp"
#include "framework/core/records/registry.hpp"
#include "framework/core/records/unit_system.hpp"
#include "framework/core/records/variation.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/core/text/warning.hpp"
#include "framework/core/text/words.hpp"
#include "framework/scene/motion.hpp"

/// A scene: what a TOML file says, checked and immutable. Nothing is bound yet; see
/// framework/model for that.
namespace tomlin {

/// Source location of a table of a scene, for messages.
struct LocatedTable {
  SourceLocation location;
  std::map<std::string, SourceLocation> locations;  ///< of each key that was given

  /// Location of a key, or of the table where the key was not given.
  const SourceLocation& location_of(const std::string& key) const {
    const auto found = locations.find(key);
    return found == locations.end() ? location : found->second;
  }
};

/// One component of a scene: its record and its filled-in description.
template <class Record>
struct SceneComponent : LocatedTable {
  std::string name;
  const Record* record = nullptr;
  std::shared_ptr<const void> description;
};

struct SceneBody : SceneComponent<BodyRecord> {
  std::vector<std::string> hold;  ///< frozen coordinates: each of "x", "y", "z", "rotation",
                                  ///< and in space "rotation_x", "rotation_y", "rotation_z"
  std::optional<Motion> motion;   ///< of a prescribed body, and of no other
};

/// `active = { from = 200.0, until = 400.0 }` of a force: it acts between these times, and is not
/// there before and after.
struct ActiveSettings {
  double from = 0.0;
  std::optional<double> until;  ///< it stays active without
};

struct SceneForce : SceneComponent<ForceRecord> {
  Traits traits() const { return traits_of(*record, description.get()); }
  /// Along an axis; 0 where it declares none.
  double period(int axis) const { return record->period(description.get(), axis); }

  std::vector<std::size_t> bodies;       ///< indices into Scene::bodies, in the order named
  std::vector<Variation> variations;     ///< its parameters that differ between particles
  std::vector<Warning> warnings;         ///< of what its record finds odd and not wrong
  bool driver = false;                   ///< reported under drivers, whatever its type
  std::optional<ActiveSettings> active;  ///< at all times without
};

struct SceneObserver : SceneComponent<ObserverRecord> {
  std::vector<std::size_t> bodies;  ///< indices into Scene::bodies, in the order named
};

struct SceneIntegrator : SceneComponent<IntegratorRecord> {
  std::string not_used;  ///< the one that is given, where the dynamics have a scheme of their own
};

/// `perturb = { ... }`: runs repeated from slightly other starts, to see how far the result is
/// determined at all.
struct PerturbSettings : LocatedTable {
  std::vector<std::size_t> bodies;       ///< indices into Scene::bodies; all by default
  double size = 0.0;                     ///< of the noise on each generalised coordinate
  std::int64_t repeats = 3;              ///< one seed each
  std::vector<std::string> observables;  ///< empty: the mean forces of all drivers
};

/// `until = { steady = "driver.mean_force.x", tolerance = 1e-6, max = 1e5 }`: the run ends when an
/// observable is the same from one driver period to the next. Or `until = { error = 0.01, of =
/// "driver.mean_force.x" }`: when the statistical error of a mean is as small as this.
struct UntilSettings : LocatedTable {
  std::string steady;  ///< the observable, over one period; empty with an error
  double tolerance = 0.0;
  std::string of;             ///< the mean; empty with `steady`
  double error = 0.0;         ///< its largest standard error, in its own unit
  std::optional<double> max;  ///< the latest time

  bool is_steady() const { return of.empty(); }
  const std::string& observable() const { return is_steady() ? steady : of; }
};

/// The equations of motion.
enum class Dynamics { inertial, overdamped, quasistatic };

constexpr auto word_table(Dynamics) {
  using enum Dynamics;
  return std::to_array<Word<Dynamics>>(
      {{inertial, "inertial"}, {overdamped, "overdamped"}, {quasistatic, "quasistatic"}});
}

struct RunSettings : LocatedTable {
  Dynamics dynamics = Dynamics::inertial;
  double duration = 0.0;  ///< with `until` the latest time at which the run ends
  SceneIntegrator integrator;
  NumberType number_type = NumberType::double_precision;
  bool ledger = false;
  std::int64_t seed = 0;
  std::int64_t stream = 0;   ///< of the seed's random numbers: a repeat
  std::int64_t repeats = 1;  ///< runs with the noise of so many streams, whose results are averaged
  bool allow_unstable = false;
  /// Asked for in place of an integrator, relative to the size of each result; the integrator above
  /// is then one that could be taken, and whoever runs the scene looks for the cheapest.
  std::optional<double> accuracy;
  double checkpoint_every = 60.0;
  std::optional<PerturbSettings> perturb;
  std::optional<UntilSettings> until;
};

/// `[measure]`: the window over which means, work and extremes are taken.
struct MeasureSettings : LocatedTable {
  /// whole_run: there is no [measure].
  enum class Unit { whole_run, time, driver_periods } unit = Unit::whole_run;
  double from = 0.0;
  std::optional<double> to;              ///< the end of the run when absent
  std::string driver;                    ///< whose periods are counted; empty: the only one
  std::optional<double> period;          ///< a length, when given
  std::vector<std::string> observables;  ///< empty: all that there are
};

constexpr auto word_table(MeasureSettings::Unit) {
  using enum MeasureSettings::Unit;
  return std::to_array<Word<MeasureSettings::Unit>>(
      {{whole_run, nullptr}, {time, "time"}, {driver_periods, "driver_periods"}});
}

enum class TrajectoryFormat { h5md, xyz };

constexpr auto word_table(TrajectoryFormat) {
  using enum TrajectoryFormat;
  return std::to_array<Word<TrajectoryFormat>>({{h5md, "h5md"}, {xyz, "xyz"}});
}

struct OutputSettings : LocatedTable {
  std::optional<double> every;  ///< sampling interval in time units; no table without it
  bool trajectory = false;      ///< particles' positions too
  TrajectoryFormat trajectory_format = TrajectoryFormat::h5md;
};

/// `[box]`: along a periodic axis everything repeats with the box's length.
struct BoxSettings : LocatedTable {
  std::vector<double> lengths;  ///< [dimension]; empty: there is no box
  std::vector<bool> periodic;   ///< [dimension]; the length of another axis is only recorded
};

/// `axes = { length = "a", force = "V_0/a" }` of `[scene]` in reduced units: what the axes of
/// figures call the units. Empty: they have no name.
struct AxisUnits {
  std::string length;
  std::string time;
  std::string mass;
  std::string velocity;
  std::string force;
  std::string energy;
};

struct Scene {
  std::string file;  ///< as given; for messages
  std::string name;
  std::string source;
  UnitSystem units = UnitSystem::reduced;  ///< of its file; descriptions are in the engine's
  AxisUnits axes;
  int dimension = 0;
  std::vector<std::pair<std::string, double>> parameters;  ///< resolved, in file order
  BoxSettings box;
  std::vector<SceneBody> bodies;
  std::vector<std::string> species;  ///< that particles of its bodies are, each once
  std::vector<SceneForce> forces;
  std::vector<SceneObserver> observers;
  std::vector<Library> libraries;  ///< that it names, and those that were loaded for all scenes
  RunSettings run;
  MeasureSettings measure;
  OutputSettings output;
  bool draws_random = false;  ///< an expression of it calls random or normal
  /// The scene with every default filled in; reading it again gives the same scene. Empty where it
  /// was left out.
  std::string effective_toml;
  const Registry* registry = nullptr;  ///< that it was read with: outlives it, and stays in place
};

/// Whether one of its forces is stochastic.
inline bool has_noise(const Scene& scene) {
  return std::any_of(scene.forces.begin(), scene.forces.end(),
                     [](const SceneForce& force) { return force.traits().stochastic; });
}

/// Whether bodies of it are kept at a temperature, by noise or without: results are means.
inline bool has_thermostat(const Scene& scene) {
  return has_noise(scene) ||
         std::any_of(scene.forces.begin(), scene.forces.end(),
                     [](const SceneForce& force) { return force.record->thermostat; });
}

/// Whether a run depends on `[run] stream`.
inline bool draws_by_stream(const Scene& scene) {
  return has_noise(scene) ||
         std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const SceneBody& body) {
           return body.record->common != nullptr &&
                  body.record->common(body.description.get()).start_temperature > 0.0;
         });
}

/// `--set PATH=VALUE`: a parameter's name or a dotted path (`run.integrator.dt`,
/// `body.ring.coordinates`, `force.driver.stiffness`); a TOML value or else an expression. Setting
/// `run.accuracy` takes the integrator away, which it stands in place of, and the other way round.
struct Setting {
  std::string path;
  std::string value;
};

/// Read and check a scene file. Throws InputError with every fault found.
std::shared_ptr<const Scene> read_scene(const std::string& file, const Registry& registry,
                                        const std::vector<Setting>& settings = {});

/// Reads and checks a text; `file` is the name in messages.
std::shared_ptr<const Scene> parse_scene(std::string_view text, const std::string& file,
                                         const Registry& registry,
                                         const std::vector<Setting>& settings = {});

}  // namespace tomlin
