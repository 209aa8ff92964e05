#include "framework/scene/language.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "framework/core/records/body.hpp"
#include "framework/core/records/force.hpp"
#include "framework/core/records/integrator.hpp"
#include "framework/core/records/observer.hpp"
#include "framework/scene/scene.hpp"

namespace tomlin {
namespace {

/// Number types that the build has kernels for (TOMLIN_NUMBER_TYPES in cmake/TomlinKernels.cmake).
std::vector<std::string> compiled_number_types() {
  std::vector<std::string> types = {to_string(NumberType::double_precision)};
#if !defined(TOMLIN_WITHOUT_QUAD)
  types.emplace_back(to_string(NumberType::quadruple_precision));
#endif
  return types;
}

/// A row for a number that may be absent.
template <class D>
Parameter optional_number(std::string key, std::optional<double> D::*member, Dimension dimension,
                          std::string doc) {
  Parameter row;
  row.key = std::move(key);
  row.doc = std::move(doc);
  row.dimension = dimension;
  row.prototype = 0.0;
  row.optional = true;
  row.assign = [member](void* description, ParameterValue value) {
    static_cast<D*>(description)->*member = std::get<double>(value);
  };
  row.read = [member](const void* description) {
    const auto& number = static_cast<const D*>(description)->*member;
    return ParameterValue(number.value_or(std::numeric_limits<double>::quiet_NaN()));
  };
  return row;
}

/// A row for a member that holds the contents of W plainly.
template <class W, class D, class T>
Parameter plain_list(std::string key, T D::*member, T W::*contents, Dimension dimension,
                     std::string doc) {
  Parameter row;
  row.key = std::move(key);
  row.doc = std::move(doc);
  row.dimension = dimension;
  row.prototype = W{};
  row.assign = [member, contents](void* description, ParameterValue value) {
    static_cast<D*>(description)->*member = std::get<W>(std::move(value)).*contents;
  };
  row.read = [member, contents](const void* description) {
    W list;
    list.*contents = static_cast<const D*>(description)->*member;
    return ParameterValue(std::move(list));
  };
  return row;
}

/// A component's layout: its record's rows, and what all components of the kind take.
TableLayout component_layout(const ComponentRecord& record, std::vector<OwnKey> own_keys) {
  TableLayout layout;
  layout.own_keys = std::move(own_keys);
  layout.rows = record.parameters;
  return layout;
}

}  // namespace

std::vector<std::string> TableLayout::keys() const {
  std::vector<std::string> result;
  for (const OwnKey& own : own_keys) result.push_back(own.key);
  for (const Parameter& parameter : rows) result.push_back(parameter.key);
  return result;
}

const Parameter* TableLayout::row(std::string_view key) const {
  const auto found = std::find_if(
      rows.begin(), rows.end(), [key](const Parameter& candidate) { return candidate.key == key; });
  return found == rows.end() ? nullptr : &*found;
}

bool TableLayout::is_own_key(std::string_view key) const {
  return std::any_of(own_keys.begin(), own_keys.end(),
                     [key](const OwnKey& own) { return own.key == key; });
}

TableLayout scene_layout() {
  TableLayout layout;
  layout.own_keys = {{"axes", "what figures call the units: { length = \"a\", ... }"}};
  layout.rows = {
      parameter("name", &Scene::name, dimension::none, "what the scene is, for people")
          .by_default(""),
      parameter("source", &Scene::source, dimension::none,
                "where it was taken from: works with their DOIs, parted by \"; \"")
          .by_default(""),
      parameter(
          "units", &Scene::units, dimension::none,
          "the system of units: reduced or any consistent ones; or metal, in which numbers are "
          "in eV, Angstrom, ps, u and K")
          .by_default(UnitSystem::reduced),
  };
  return layout;
}

TableLayout axes_layout() {
  const auto row = [](const char* key, std::string AxisUnits::*member, const char* doc) {
    return parameter(key, member, dimension::none, doc).or_absent();
  };
  TableLayout layout;
  layout.rows = {
      row("length", &AxisUnits::length, "the unit of lengths, as axes of figures have it: \"a\""),
      row("time", &AxisUnits::time, "of times"),
      row("mass", &AxisUnits::mass, "of masses"),
      row("velocity", &AxisUnits::velocity,
          "of velocities; made of those of lengths and times by default"),
      row("force", &AxisUnits::force, "of forces: \"V_0/a\""),
      row("energy", &AxisUnits::energy, "of energies"),
  };
  return layout;
}

TableLayout box_layout() {
  TableLayout layout;
  layout.rows = {
      plain_list("lengths", &BoxSettings::lengths, &SpaceVector::components, dimension::length,
                 "of the box along each axis; along a periodic one every period of a force "
                 "divides it")
          .in(positive),
      plain_list("periodic", &BoxSettings::periodic, &FlagList::flags, dimension::none,
                 "the axes along which everything repeats with the box"),
  };
  return layout;
}

TableLayout run_layout(bool until) {
  TableLayout layout;
  layout.own_keys = {{"integrator", "the scheme: { type = ..., ... }"},
                     {"perturb", "repeats from perturbed starts: { size = ..., ... }"},
                     {"until",
                      "end when an observable is steady or known well enough: { steady = ..., ... "
                      "} or { error = ..., ... }"}};
  Parameter duration = parameter("duration", &RunSettings::duration, dimension::time,
                                 "length of the run; the last step is shortened to end exactly")
                           .in(positive);
  duration.optional = until;  // which has a latest time of its own
  layout.rows = {
      parameter("dynamics", &RunSettings::dynamics, dimension::none, "the equations of motion")
          .by_default(Dynamics::inertial),
      std::move(duration),
      parameter("number_type", &RunSettings::number_type, dimension::none,
                "the numbers that the state is held in")
          .one_of(compiled_number_types())
          .by_default(NumberType::double_precision),
      parameter("ledger", &RunSettings::ledger, dimension::none, "keep the energy ledger")
          .by_default(false),
      parameter("seed", &RunSettings::seed, dimension::none, "key of all random numbers")
          .in(non_negative)
          .by_default(std::int64_t{0}),
      parameter("stream", &RunSettings::stream, dimension::none,
                "of the noise of forces: runs with other streams repeat the run with independent "
                "random numbers")
          .in({.low = 0.0, .high = 1e12, .low_open = false, .high_open = false})
          .by_default(std::int64_t{0}),
      parameter(
          "repeats", &RunSettings::repeats, dimension::none,
          "so many runs with independent noise: results over the window are their means, with "
          "standard errors")
          .in({.low = 1.0, .high = 1e6, .low_open = false, .high_open = false})
          .by_default(std::int64_t{1}),
      parameter("checkpoint_every", &RunSettings::checkpoint_every, dimension::none,
                "wall time between checkpoints, in seconds")
          .in(positive)
          .by_default(60.0),
      parameter("allow_unstable", &RunSettings::allow_unstable, dimension::none,
                "run even when the step is beyond the estimated stability limit")
          .by_default(false),
      optional_number("accuracy", &RunSettings::accuracy, dimension::none,
                      "in place of an integrator: the relative error that results may have; the "
                      "program picks the integrator and estimates the errors")
          .in({.low = 0.0, .high = 1.0, .low_open = true, .high_open = true}),
  };
  return layout;
}

TableLayout perturb_layout() {
  TableLayout layout;
  layout.own_keys = {{"bodies", "those whose starts are perturbed; all by default"}};
  layout.rows = {
      parameter("size", &PerturbSettings::size, dimension::none,
                "of the uniform noise that is added to each generalised coordinate")
          .in(positive),
      parameter("repeats", &PerturbSettings::repeats, dimension::none, "number of perturbed runs")
          .in({.low = 1.0, .high = 1000.0, .low_open = false, .high_open = false})
          .by_default(std::int64_t{3}),
      plain_list("observables", &PerturbSettings::observables, &WordList::words, dimension::none,
                 "what is looked at; the mean forces of all drivers by default")
          .or_absent(),
  };
  return layout;
}

namespace {

Parameter latest_time() {
  return optional_number("max", &UntilSettings::max, dimension::time,
                         "the latest time at which the run ends; run.duration by default")
      .in(positive);
}

}  // namespace

TableLayout until_layout() {
  TableLayout layout;
  layout.rows = {
      parameter("steady", &UntilSettings::steady, dimension::none,
                "the observable that is to be the same from one driver period to the next"),
      parameter("tolerance", &UntilSettings::tolerance, dimension::none,
                "largest estimated distance from its steady value, relative to it")
          .in(positive),
      latest_time(),
  };
  return layout;
}

TableLayout until_error_layout() {
  TableLayout layout;
  for (const char* key : {"steady", "tolerance"}) {
    layout.elsewhere.push_back({key, "the other condition, { steady = ..., tolerance = ... }"});
  }
  layout.rows = {
      parameter("error", &UntilSettings::error, dimension::none,
                "largest standard error of the mean, in the unit of the mean")
          .in(positive),
      parameter("of", &UntilSettings::of, dimension::none,
                "the mean whose statistical error is looked at"),
      latest_time(),
  };
  return layout;
}

namespace {

/// Both conditions, of which a scene has one.
TableLayout until_table() {
  TableLayout table = until_layout();
  const TableLayout other = until_error_layout();
  table.rows.insert(table.rows.end() - 1, other.rows.begin(), other.rows.end() - 1);
  for (Parameter& row : table.rows) row.optional = true;
  return table;
}

}  // namespace

TableLayout measure_layout() {
  TableLayout layout;
  layout.rows = {
      parameter("from", &MeasureSettings::from, dimension::none, "where the window begins")
          .in(non_negative)
          .by_default(0.0),
      optional_number("to", &MeasureSettings::to, dimension::none,
                      "where the window ends; the end of the run by default")
          .in(positive),
      parameter("in", &MeasureSettings::unit, dimension::none,
                "the unit of from and to: time, or periods that a driver has travelled")
          .by_default(MeasureSettings::Unit::time),
      parameter("driver", &MeasureSettings::driver, dimension::none,
                "the force whose periods are counted, where several forces drive")
          .or_absent(),
      optional_number("period", &MeasureSettings::period, dimension::length,
                      "the period that is counted, where there are several")
          .in(positive),
      plain_list("observables", &MeasureSettings::observables, &WordList::words, dimension::none,
                 "the only quantities that are looked at and reported; all of them without it")
          .or_absent(),
  };
  return layout;
}

TableLayout output_layout() {
  TableLayout layout;
  layout.rows = {
      optional_number("every", &OutputSettings::every, dimension::time,
                      "sampling interval; no table of observables without it")
          .in(positive),
      parameter("trajectory", &OutputSettings::trajectory, dimension::none,
                "write the particles' positions too")
          .by_default(false),
      parameter("trajectory_format", &OutputSettings::trajectory_format, dimension::none,
                "H5MD in trajectory.h5, or extended XYZ in trajectory.xyz")
          .by_default(TrajectoryFormat::h5md),
  };
  return layout;
}

TableLayout sweep_layout() {
  TableLayout layout;
  layout.own_keys = {
      {"over",
       "names as in `--set` with their values, an axis each, the first one outermost: "
       "{ v = \"1e-4:1e-1:31:log\", k = [1.0, 2.0] }"},
      {"zip",
       "names of `over` that make up one axis together: [\"k\", \"v\"], or a list of such lists"},
      {"continue_from_neighbour",
       "a point starts where the one before it along the last axis has ended; false by default"},
      {"refine",
       "points between those of an axis, by bisection: where an observable crosses a level, "
       "\"events.slips=0.5\", or jumps, \"driver.mean_force.x\"; none by default"},
      {"refine_along", "the axis that is refined, one of numbers; the last one by default"},
      {"refine_to",
       "width of an interval that is not bisected any more, on a logarithmic axis of the "
       "logarithm; 1e-4 of the axis by default"},
      {"repeats",
       "so many runs of each point, with independent noise: a first axis run.stream = 0, 1, ..."},
      {"observables", "what is kept of each run: dotted paths as in summary.json"},
      {"files",
       "texts of files by their names, which are taken in place of the files: the scene.toml of a "
       "sweep has those that its axes name"},
  };
  return layout;
}

std::vector<SceneTable> scene_tables() {
  return {{"scene", "what the scene is; may be absent", scene_layout()},
          {"scene.axes", "what the axes of figures call the units", axes_layout()},
          {"box", "its size, and where everything repeats; no box without it", box_layout()},
          {"run", "how long, and by which equations, steps and numbers", run_layout()},
          {"run.perturb", "repeats from other starts: is the result determined at all?",
           perturb_layout()},
          {"run.until",
           "end when steady (steady, tolerance), or when a mean is known well enough (error, of)",
           until_table()},
          {"measure", "the window of means, work and extremes; the whole run without it",
           measure_layout()},
          {"output", "what is written beside the summary", output_layout()},
          {"sweep", "many runs over values of parameters; other commands only check it",
           sweep_layout()}};
}

TableLayout body_layout(const BodyRecord& record) {
  static const std::vector<OwnKey> keys = {
      {"name", "by default its type, if no other body has that type"},
      {"type", "which body it is"},
      {"hold", hold_row().doc},
      {"motion",
       "of a prescribed body: { velocity = [..], angular_velocity = .. }, numbers or "
       "expressions in t; zero by default"}};
  return component_layout(record, keys);
}

Parameter hold_row() {
  return plain_list(
             "hold", &SceneBody::hold, &WordList::words, dimension::none,
             "coordinates to freeze: \"x\", \"y\", \"z\" of each particle, or of the "
             "centre of a rigid body, and its \"rotation\"; in space also two of \"rotation_x\", "
             "\"rotation_y\", \"rotation_z\", so that it rotates about the third axis alone")
      .one_of({"x", "y", "z", "rotation", "rotation_x", "rotation_y", "rotation_z"})
      .or_absent();
}

Parameter driver_row() {
  return parameter("driver", &SceneForce::driver, dimension::none,
                   "true: report this force under drivers, with its force, its work and its "
                   "support; a driving_spring is always reported there")
      .by_default(false);
}

TableLayout active_layout() {
  TableLayout layout;
  layout.rows = {
      parameter(
          "from", &ActiveSettings::from, dimension::time,
          "the force acts from this time on; a driving spring without start then starts where "
          "the attached point is")
          .by_default(0.0)
          .in(non_negative),
      optional_number("until", &ActiveSettings::until, dimension::time,
                      "and until this one; to the end of the run by default")
          .in(positive)};
  return layout;
}

TableLayout force_layout(const ForceRecord& record) {
  static const std::vector<OwnKey> keys = {
      {"name", "by default its type, if no other force has that type"},
      {"type", "which force it is"},
      {"body", "the body it acts on; may be omitted if the scene has one body"},
      {"bodies", "in place of body: a list, where a force acts between two"},
      {"driver", driver_row().doc},
      {"active",
       "{ from = 0.0, until = TIME }, the interval in which the force acts; by default always. A "
       "driving "
       "spring without start then starts where the attached point is"}};
  return component_layout(record, keys);
}

TableLayout observer_layout(const ObserverRecord& record) {
  static const std::vector<OwnKey> keys = {
      {"name", "by default its type, if no other observer has that type"},
      {"type", "which observer it is"},
      {"body", "the body it observes; may be omitted if the scene has one body"},
      {"bodies", "in place of body: a list, where it observes two or more"}};
  return component_layout(record, keys);
}

TableLayout integrator_layout(const IntegratorRecord& record) {
  return component_layout(record, {{"type", "which integrator it is"}});
}

const std::vector<std::string>& top_level_keys() {
  static const std::vector<std::string> keys = {"plugins", "scene",  "parameters", "box",
                                                "body",    "force",  "observer",   "run",
                                                "measure", "output", "sweep"};
  return keys;
}

bool is_word_of_summary(std::string_view name) {
  static constexpr std::string_view kWords[] = {
      "time",    "energy",     "events",      "window",     "performance", "parameters",
      "status",  "drivers",    "bodies",      "warnings",   "error",       "determined",
      "failure", "left_out",   "equilibrium", "references", "observers",   "program",
      "scene",   "integrator", "until",       "accuracy",   "plugins",     "warning_codes"};
  return std::find(std::begin(kWords), std::end(kWords), name) != std::end(kWords);
}

}  // namespace tomlin
