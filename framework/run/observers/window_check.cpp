#include "framework/run/guard/window_warnings.hpp"
#include "framework/run/observers/kinds.hpp"
#include "framework/run/steps/run_plan.hpp"

/// Warns of a window in which what springs pull has not followed them, or too few slips were seen.
namespace tomlin::observers {
namespace {

class WindowCheck : public RunObserver {
 public:
  explicit WindowCheck(const ObserverParts& parts) : parts_(parts) {
    for (const Model::Driver& driver : parts.signals.drivers()) {
      springs_ += pulls(*driver.drive) ? 1 : 0;
    }
  }

  void finish(const RunMoment&) override {
    if (parts_.run.plan.period > 0.0 || !parts_.window.is_over()) return;
    for (std::size_t k = 0; k < parts_.signals.drivers().size(); ++k) {
      if (pulls(*parts_.signals.drivers()[k].drive)) look_at(k);
    }
  }

 private:
  void look_at(std::size_t driver) {
    RunContext& run = parts_.run;
    const MeasureWindow& window = parts_.window;
    const DriverWindow seen =
        driver_window(run.model, driver, window.from().time, window.to().time);
    const auto body = body_pulled_by(run.model, parts_.signals.drivers()[driver]);
    if (!seen.steady || !body) return;
    const auto axis = static_cast<std::size_t>(seen.axis);
    const auto way = static_cast<double>(window.moved(*body, axis));
    const double moved = parts_.signals.start_velocity(driver, axis) < 0.0 ? -way : way;
    const EventLog& events = parts_.events;
    std::optional<std::uint64_t> slips;
    // With several drivers it is not known here whose slips they were.
    if (events.expects(EventKind::slip) && springs_ == 1) {
      slips = static_cast<std::uint64_t>(events.count_within(EventKind::slip));
    }
    const auto all = static_cast<std::uint64_t>(events.count(EventKind::slip));
    const bool at_end = window.to().time >= run.plan.duration;
    run.outcome.warn(doubt_after(seen, moved, slips, all, at_end));
  }

  ObserverParts parts_;
  int springs_ = 0;
};

}  // namespace

ObserverKind window_check() { return kind_of<WindowCheck>({}); }

}  // namespace tomlin::observers
