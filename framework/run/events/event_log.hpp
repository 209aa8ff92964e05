#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "framework/core/system/state_layout.hpp"
#include "framework/run/run.hpp"
#include "framework/run/window/window.hpp"

namespace tomlin {

/// Counts events and sends them to the run's sink.
class EventLog {
 public:
  EventLog(RunSink* sink, const MeasureWindow& window) : sink_(sink), window_(window) {}
  void declare(StateLayout& layout) const;
  void attach(RunState& state);

  /// The run looks for events of this kind: it has a count of them.
  void expect(EventKind kind, bool expected = true) {
    expected_[static_cast<std::size_t>(kind)] = expected;
  }
  bool expects(EventKind kind) const { return expected_[static_cast<std::size_t>(kind)]; }
  bool expects_any() const;

  void record(Event event, std::string_view name);
  std::int64_t count(EventKind kind) const { return counts_[static_cast<std::size_t>(kind)]; }
  /// That have begun within the window.
  std::int64_t count_within(EventKind kind) const {
    return within_[static_cast<std::size_t>(kind)];
  }

 private:
  RunSink* sink_;
  const MeasureWindow& window_;
  std::array<bool, kEventKinds> expected_{};
  std::int64_t* counts_ = nullptr;
  std::int64_t* within_ = nullptr;
};

/// An event of which nothing is known but its kind.
Event event_of_kind(EventKind kind);

}  // namespace tomlin
