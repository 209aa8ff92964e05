#include "framework/scene/sweep_refinement.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/core/formula/rounded_functions.hpp"
#include "framework/core/text/nearest_name.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

/// Part of the span of the axis.
constexpr double kWidthByDefault = 1e-4;
/// Part of the larger end of an axis: with far less, doubles would have no middle between them.
constexpr double kLeastWidth = 0x1p-45;
/// A smooth curve loses most of its difference in so many halvings, a jump loses nothing.
constexpr std::size_t kFewestRoundsOfAJump = 4;

/// First and last number of a numeric axis.
double first_number(const SweepAxis& axis) { return axis.values.number(0); }
double last_number(const SweepAxis& axis) { return axis.values.number(axis.values.size() - 1); }

double width_between(double from, double to, bool logarithmic) {
  return logarithmic ? std::abs(rounded_log(to) - rounded_log(from)) : std::abs(to - from);
}

/// Reads what was written; its functions return false where it is wrong.
class RefinementReader {
 public:
  RefinementReader(const SweepSettings& settings, const std::vector<SweepDimension>& dimensions,
                   std::vector<Fault>& faults)
      : settings_(settings), refine_(settings.refine), dimensions_(dimensions), faults_(faults) {}

  std::optional<SweepRefinement> read() {
    if (!refine_.what) {
      for (const auto* other : {&refine_.along, &refine_.to}) {
        if (!*other) continue;
        complain(FaultCode::command_missing_argument, **other, "nothing is refined",
                 "refine = \"OBSERVABLE\" or --refine OBSERVABLE beside it");
      }
      return std::nullopt;
    }
    if (settings_.continues) {
      complain(FaultCode::command_conflict, *refine_.what,
               "points that continue from their neighbour have no others between them",
               "no continue_from_neighbour beside it");
    }
    SweepRefinement refinement;
    const bool is_what_right = read_what(refinement);
    const bool is_width_right = read_width(refinement);
    if (!read_axis(refinement) || !check_width(refinement)) return std::nullopt;
    if (!is_what_right || !is_width_right) return std::nullopt;
    const SweepValues& values = settings_.over[refinement.axis].values;
    for (std::size_t k = 1; k < values.size(); ++k) {
      const std::size_t rounds = refinement.rounds_between(values.number(k - 1), values.number(k));
      refinement.rounds = std::max(refinement.rounds, rounds);
    }
    double most = 1.0 + static_cast<double>(refinement.rounds);
    for (const SweepDimension& dimension : dimensions_) {
      most *= static_cast<double>(dimension.count);
    }
    if (most > static_cast<double>(kMostSweepPoints)) {
      complain(FaultCode::scene_too_large, *refine_.what,
               fmt::format("up to {:g} points are too many", most),
               fmt::format("at most {}; fewer values, or a larger width", kMostSweepPoints));
      return std::nullopt;
    }
    return refinement;
  }

 private:
  void complain(FaultCode code, const SweepText& written, std::string why, std::string admissible,
                std::string nearest = "") {
    const std::string shown = shortened(written.text, kLongestShownValue);
    const bool is_option = written.key.empty();
    faults_.emplace_back(code, written.location, is_option ? shown : written.key,
                         is_option ? "" : shown, std::move(why), std::move(admissible),
                         std::move(nearest));
  }

  bool read_what(SweepRefinement& refinement) {
    const std::string& text = refine_.what->text;
    const std::size_t equals = text.find('=');
    if (refined_observable(refine_).empty()) {
      complain(FaultCode::command_missing_argument, *refine_.what, "no observable",
               "OBSERVABLE, or OBSERVABLE=LEVEL");
      return false;
    }
    if (text.find_first_of("<>") != std::string::npos) {
      complain(FaultCode::command_invalid_value, *refine_.what, "a level follows an equals sign",
               "OBSERVABLE=LEVEL: events.slips=0.5");
      return false;
    }
    if (equals == std::string::npos) return true;
    refinement.level = finite_constant(text.substr(equals + 1));
    if (refinement.level) return true;
    complain(FaultCode::command_invalid_value, *refine_.what, "the level is not a finite number",
             "OBSERVABLE=LEVEL: events.slips=0.5");
    return false;
  }

  bool read_axis(SweepRefinement& refinement) {
    const std::vector<SweepAxis>& over = settings_.over;
    if (over.empty()) return false;
    refinement.axis = over.size() - 1;
    const SweepText& written = refine_.along ? *refine_.along : *refine_.what;
    if (refine_.along) {
      std::vector<std::string> names;
      names.reserve(over.size());
      for (const SweepAxis& axis : over) names.push_back(axis.name);
      const auto found = std::find(names.begin(), names.end(), written.text);
      if (found == names.end()) {
        const auto& unread = settings_.unread;
        if (std::find(unread.begin(), unread.end(), written.text) == unread.end()) {
          complain(FaultCode::scene_unknown_name, written, "there is no such axis", listed(names),
                   nearest_name(written.text, names).value_or(""));
        }
        return false;
      }
      refinement.axis = static_cast<std::size_t>(found - names.begin());
    } else if (!settings_.unread.empty()) {
      return false;  // which one is the last is not known
    }
    const SweepAxis& axis = over[refinement.axis];
    const auto refuse = [&](const std::string& why) {
      complain(FaultCode::scene_conflict, written, fmt::format("{} {}", axis.name, why),
               "an axis of numbers that rise or fall, which refine_along may name");
      return false;
    };
    if (!axis.values.numeric()) return refuse("has values that are not numbers");
    if (axis.values.size() < 2) return refuse("has one value alone");
    const double span = last_number(axis) - first_number(axis);
    if (!std::isfinite(span)) return refuse("is wider than a double holds");
    const bool rises = span > 0.0;
    for (std::size_t k = 1; k < axis.values.size(); ++k) {
      const double step = axis.values.number(k) - axis.values.number(k - 1);
      if (rises ? !(step > 0.0) : !(step < 0.0))
        return refuse("must have values that increase or decrease");
    }
    for (const SweepDimension& dimension : dimensions_) {
      const auto& axes = dimension.axes;
      if (axes.size() > 1 && std::find(axes.begin(), axes.end(), refinement.axis) != axes.end()) {
        return refuse("is zipped");
      }
    }
    refinement.logarithmic = axis.values.spacing() == SweepValues::Spacing::logarithmic;
    return true;
  }

  /// 0 where none was given.
  bool read_width(SweepRefinement& refinement) {
    if (!refine_.to) return true;
    const auto width = finite_constant(refine_.to->text);
    if (width && *width > 0.0) {
      refinement.width = *width;
      return true;
    }
    complain(FaultCode::command_invalid_value, *refine_.to, "not a finite number above 0",
             "a width of the axis, or of its logarithm");
    return false;
  }

  /// Once the axis is known.
  bool check_width(SweepRefinement& refinement) {
    const SweepAxis& axis = settings_.over[refinement.axis];
    const double from = first_number(axis);
    const double to = last_number(axis);
    const double largest = std::max(std::abs(from), std::abs(to));
    const double least = kLeastWidth * (refinement.logarithmic ? 1.0 : largest);
    if (!refine_.to) {
      const double span = width_between(from, to, refinement.logarithmic);
      refinement.width = std::max(kWidthByDefault * span, least);
    }
    if (refinement.width >= least || refinement.width == 0.0) return true;
    complain(FaultCode::command_invalid_value, *refine_.to,
             "so narrow an interval has no numbers inside", fmt::format("from {:.2g}", least));
    return false;
  }

  const SweepSettings& settings_;
  const RefineSettings& refine_;
  const std::vector<SweepDimension>& dimensions_;
  std::vector<Fault>& faults_;
};

}  // namespace

std::string refined_observable(const RefineSettings& refine) {
  return refine.what ? refine.what->text.substr(0, refine.what->text.find('=')) : "";
}

double SweepRefinement::middle(double from, double to) const {
  return logarithmic ? rounded_logarithmic_step(from, to, 1, 2)
                     : rounded_linear_step(from, to, 1, 2);
}

std::size_t SweepRefinement::rounds_between(double from, double to) const {
  std::size_t count = level ? 0 : kFewestRoundsOfAJump;
  const double whole = width_between(from, to, logarithmic);
  while (std::ldexp(whole, -static_cast<int>(count)) > width) ++count;
  return count;
}

std::optional<SweepRefinement> sweep_refinement(const SweepSettings& settings,
                                                const std::vector<SweepDimension>& dimensions,
                                                std::vector<Fault>& faults) {
  return RefinementReader(settings, dimensions, faults).read();
}

}  // namespace tomlin
