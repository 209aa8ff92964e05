#include <iterator>

#include "framework/run/observers/kinds.hpp"

/// How many events of each kind there have been; null where a scene has none to look for.
namespace tomlin::observers {
namespace {

ResultQuantity events(const char* key, const char* meaning) {
  return {key, dimension::none, Shape::count, Scope::run, meaning};
}

/// By EventKind; those that observers of the scene tell of are theirs to count.
const ResultQuantity kCounts[] = {
    events("slips", "slips of what drivers of steady velocity pull"),
    events("hops", "hops of bodies with a closed outline, in the plane"),
    events("turns", "whole revolutions of bodies in the plane"),
    events("reversals", "motions of pulled points against their drivers"),
    events("driver_reversals", "times that a driver has turned back"),
    events("ties", "unstable symmetric equilibria of quasistatic dynamics"),
};

class EventCounts : public RunObserver {
 public:
  explicit EventCounts(const ObserverParts& parts) : events_(parts.events) {}

  void results(ResultTable& table, const double*) const override {
    ResultGroup& group = table.group("events");
    for (std::size_t k = 0; k < std::size(kCounts); ++k) {
      const auto kind = static_cast<EventKind>(k);
      std::optional<double> count;
      if (events_.expects(kind)) count = static_cast<double>(events_.count(kind));
      group.add(kCounts[k], count);
    }
  }

 private:
  const EventLog& events_;
};

}  // namespace

ObserverKind event_counts() {
  ObserverRows rows{"events", {}};
  for (const ResultQuantity& count : kCounts) rows.quantities.push_back(&count);
  return kind_of<EventCounts>({rows});
}

}  // namespace tomlin::observers
