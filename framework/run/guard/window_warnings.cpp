#include "framework/run/guard/window_warnings.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/run/steps/run_plan.hpp"

namespace tomlin {
namespace {

/// Displacement of a driver within the window in periods: less is not sliding.
constexpr double kShortestSlide = 1e-2;
/// A window may miss whole periods by this part of itself: a mean over whole periods and one over
/// this window differ by as much.
constexpr double kPartOfPeriod = 1e-3;
/// Part of the driver's displacement by which the pulled body may be ahead or behind.
constexpr double kLagInDriverWays = 0.1;
/// In periods: a window that begins before a slip and ends after one is no better known.
constexpr double kLagInPeriods = 1.0;
/// Largest lag as a part of the driver's displacement, where no force has a period: between slips
/// of unknown length a body that follows its driver may be behind by much of a window.
constexpr double kLagWithoutPeriod = 0.5;
/// Slips that a mean is taken of.
constexpr std::uint64_t kFewestSlips = 3;

/// Times in messages, to what a reader would type.
std::string digits(double time) { return fmt::format("{:.6g}", time); }

std::string key_of(const DriverWindow& window) { return "drivers." + window.driver; }

}  // namespace

DriverWindow driver_window(const Model& model, std::size_t driver, double from, double to) {
  const std::string& name = model.drivers()[driver].name;
  const Drive& drive = *model.drivers()[driver].drive;
  DriverWindow window;
  window.driver = name;
  window.from = from;
  window.to = to;
  window.steady = drags(drive) && !reverses(model, model.drivers()[driver]);
  for (const SceneForce& force : model.scene().forces) {
    if (force.name != name || !force.active) continue;
    window.from = std::max(from, force.active->from);
    window.to = std::min(to, force.active->until.value_or(to));
    if (!(window.to > window.from)) return window;
  }
  for (int d = 0; d < model.dimension(); ++d) {
    const double speed = std::abs(drive.velocity[d]);
    if (!(speed > window.speed) || !(drive.stiffness_on(d) > 0.0)) continue;
    window.axis = d;
    window.speed = speed;
  }
  for (int d = 0; d < model.dimension(); ++d) {
    if (drive.velocity[d] == 0.0) continue;
    for (const SceneForce& force : model.scene().forces) {
      const double period = force.record->period(force.description.get(), d);
      if (!(period > 0.0)) continue;
      window.one_period = window.one_period && (window.period == 0.0 || window.period == period);
      if (period < window.period) continue;
      window.period = period;
      window.axis = d;
      window.speed = std::abs(drive.velocity[d]);
    }
  }
  return window;
}

bool is_whole(const DriverWindow& w) {
  if (!(w.period > 0.0)) return false;
  const double periods = w.speed * (w.to - w.from) / w.period;
  return w.steady && std::abs(periods - std::nearbyint(periods)) <= kPartOfPeriod * periods;
}

std::optional<Warning> doubt_before(const DriverWindow& w) {
  const double periods = w.speed * (w.to - w.from) / w.period;
  if (!(w.period > 0.0 && periods > 0.0)) return {};
  if (periods < kShortestSlide) {
    return Warning{
        FaultCode::run_window_too_short,
        fmt::format("{} moves by {:.2g} of a period within the window, much less than one: its "
                    "means are those of the start, not of sliding",
                    w.driver, periods),
        key_of(w)};
  }
  if (!w.steady || is_whole(w)) return {};
  const double whole = std::floor(periods * (1.0 + kPartOfPeriod));
  const std::string would_do = whole > 0.0
                                   ? fmt::format("from {} to {} it would be {:g}", digits(w.from),
                                                 digits(w.from + whole * w.period / w.speed), whole)
                                   : fmt::format("a period takes {}", digits(w.period / w.speed));
  return Warning{
      FaultCode::run_window_not_whole,
      fmt::format("the window is {:.4g} periods of {}, no whole number: its means depend on where "
                  "it begins; {} ([measure] from, to; in = \"driver_periods\" counts periods)",
                  periods, w.driver, would_do),
      key_of(w)};
}

std::optional<Warning> doubt_after(const DriverWindow& w, double moved,
                                   std::optional<std::uint64_t> slips, std::uint64_t whole_run,
                                   bool at_end) {
  const double distance = w.speed * (w.to - w.from);
  if (distance < kShortestSlide * w.period) return {};
  const double lag = distance - moved;
  const double part_allowed = w.period > 0.0 ? kLagInDriverWays : kLagWithoutPeriod;
  if (std::abs(lag) > part_allowed * distance && std::abs(lag) > kLagInPeriods * w.period) {
    return Warning{
        FaultCode::run_window_not_steady,
        fmt::format("{} moves by {:.3g} within the window and what it pulls by {:.3g}: its means "
                    "are those of a spring that is still being {}; {}begin the window at {} or "
                    "after",
                    w.driver, distance, moved, lag > 0.0 ? "loaded" : "unloaded",
                    at_end ? "let the run last longer and " : "", digits(w.to)),
        key_of(w)};
  }
  if (w.period > 0.0 && slips && whole_run > 0 && *slips < kFewestSlips) {
    const double each = *slips > 0 ? (w.to - w.from) / static_cast<double>(*slips)
                                   : std::max(w.to - w.from, w.period / w.speed);
    const std::string count = *slips == 0   ? "no slip"
                              : *slips == 1 ? "one slip"
                                            : fmt::format("{} slips", *slips);
    return Warning{
        FaultCode::run_few_slips,
        fmt::format("{} of {} {} within the window, too few for a mean: a window of {} would have "
                    "{}",
                    count, w.driver, *slips < 2 ? "begins" : "begin",
                    digits(static_cast<double>(kFewestSlips) * each), kFewestSlips),
        key_of(w)};
  }
  return {};
}

}  // namespace tomlin
