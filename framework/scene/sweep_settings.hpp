#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "framework/core/text/fault.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/fault_list.hpp"

/// `[sweep]`: which values a sweep gives to which names, and what it keeps of each run. A run has
/// no use for it, so that it is no part of a Scene; `tomlin sweep` has the same as options.
namespace tomlin {

/// Dimensions of a sweep: an array has one more for the characters of texts, and readers take 32.
inline constexpr std::size_t kMostSweepDimensions = 31;
/// Points of a sweep, all axes together.
inline constexpr std::size_t kMostSweepPoints = 100'000'000;

/// The values that one name takes: a list, or a grid whose ends are given.
class SweepValues {
 public:
  enum class Spacing { list, linear, logarithmic };

  /// "a, b, c" or "from:to:count[:log]"; why it is neither.
  static std::variant<SweepValues, Wrong> parse(std::string_view text);
  /// Each as in `--set`; not empty.
  static SweepValues listed(std::vector<std::string> texts);

  Spacing spacing() const { return spacing_; }
  std::size_t size() const { return count_; }
  /// Value as `--set` takes it: a number with the digits that give back its bits, or as written.
  std::string text(std::size_t k) const;
  /// The value in one form, however it was written: a word without quotes, "0.001" for "1e-3".
  std::string plain_text(std::size_t k) const;
  /// All values are numbers, or expressions that no parameter is needed for.
  bool numeric() const { return numeric_; }
  /// Value of a numeric axis. Those inside of a grid are the doubles nearest to
  ///   linear       ((n - 1 - k) from + k to) / (n - 1)
  ///   logarithmic  exp(((n - 1 - k) log from + k log to) / (n - 1)).
  double number(std::size_t k) const;
  /// "from:to:count[:log]" with the numbers' digits, or the texts of the list in quotes.
  std::string canonical() const;

 private:
  Spacing spacing_ = Spacing::list;
  std::size_t count_ = 0;
  bool numeric_ = true;
  double from_ = 0.0;
  double to_ = 0.0;
  std::vector<std::string> texts_;  ///< of a list
  std::vector<double> numbers_;     ///< of a numeric list
};

/// With the digits that give back its bits, as `--set` takes it.
std::string number_as_setting(double number);

/// A finite number, or an expression without parameters that gives one.
std::optional<double> finite_constant(std::string_view text);

/// One name with its values.
struct SweepAxis {
  std::string name;  ///< as in `--set`: a parameter or a dotted path
  SweepValues values;
  SourceLocation location;  ///< of what was written, for messages,
  std::string shown;        ///< and the values as they were written there
};

/// Names that take their values together.
struct SweepZip {
  std::vector<std::string> names;
  SourceLocation location;
};

/// A text of a table or an option.
struct SweepText {
  std::string text;
  SourceLocation location;
  std::string key;  ///< for messages
};

/// Points to be added to those of the axes, as it was written; sweep_refinement() reads it.
struct RefineSettings {
  std::optional<SweepText> what;   ///< "OBSERVABLE" or "OBSERVABLE=LEVEL"
  std::optional<SweepText> along;  ///< an axis
  std::optional<SweepText> to;     ///< a width
};

struct SweepSettings {
  std::vector<SweepAxis> over;      ///< the first one outermost
  std::vector<std::string> unread;  ///< axes that are left out: their values are wrong
  std::vector<SweepZip> zips;
  bool continues = false;  ///< a point starts where the one before it along the last axis has ended
  RefineSettings refine;
  /// So many runs of each point, with noise of its own each: see add_repeats().
  std::optional<SweepText> repeats;
  std::vector<std::string> observables;
  SourceLocation observables_location;
};

/// The axis `name` with these values, "a, b, c" or "from:to:count[:log]", as written at a position;
/// among `unread`, with a fault, where they are neither.
void add_axis(SweepSettings& settings, const std::string& name, const std::string& values,
              const SourceLocation& location, std::vector<Fault>& faults);

/// Makes of `repeats` the first axis, run.stream = 0, 1, ...; adds a fault where it is no such
/// number.
void add_repeats(SweepSettings& settings, std::vector<Fault>& faults);

/// One dimension of a sweep: an axis, or some that are zipped.
struct SweepDimension {
  std::vector<std::size_t> axes;  ///< indices into SweepSettings::over
  std::size_t count = 0;
};

/// The dimensions, the first one outermost: a zipped one where its first axis stands. Adds a fault
/// for every name that comes twice, every zip without its axes or of different lengths, and for too
/// many points.
std::vector<SweepDimension> sweep_dimensions(const SweepSettings& settings,
                                             std::vector<Fault>& faults);

/// `[sweep]` of a document; nothing where there is none. Adds its faults.
std::optional<SweepSettings> sweep_settings(const Table& document, const Source& source,
                                            std::vector<Fault>& faults);

/// `[sweep] files` of a document: texts by names of files. What is none is left out.
std::map<std::string, std::string> texts_of_files(const Table& document);

/// Reports the faults of `[sweep]` alone, those of names that cannot be set included.
void check_sweep(const Table& document, const Source& source, FaultList& faults);

}  // namespace tomlin
