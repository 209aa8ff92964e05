#include "framework/run/events/event_log.hpp"

#include <algorithm>
#include <limits>

namespace tomlin {

void EventLog::declare(StateLayout& layout) const {
  layout.add_integers("events.counts", kEventKinds);
  layout.add_integers("events.within", kEventKinds);
}

void EventLog::attach(RunState& state) {
  counts_ = state.integers("events.counts");
  within_ = state.integers("events.within");
}

bool EventLog::expects_any() const {
  return std::find(expected_.begin(), expected_.end(), true) != expected_.end();
}

void EventLog::record(Event event, std::string_view name) {
  event.name = name;
  const auto kind = static_cast<std::size_t>(event.kind);
  ++counts_[kind];
  if (window_.contains(event.time)) ++within_[kind];
  if (sink_ != nullptr) sink_->event(event);
}

Event event_of_kind(EventKind kind) {
  Event event;
  event.kind = kind;
  event.time = event.duration = event.size = event.energy_lost = event.peak_force =
      std::numeric_limits<double>::quiet_NaN();
  return event;
}

}  // namespace tomlin
