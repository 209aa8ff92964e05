#include "framework/output/event_table.hpp"

#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "framework/output/number_text.hpp"

namespace tomlin {
namespace {

/// Names with a comma, a quote or a line break stand in quotes.
std::string cell(std::string_view text) {
  const bool is_plain = text.find_first_of(",\"\r\n") == std::string_view::npos;
  return is_plain ? std::string(text) : quoted_cell(text);
}

std::string header(UnitSystem units) {
  const std::string time = unit_in_tables(units, dimension::time);
  return fmt::format("time [{}],event,name,duration [{}],size,energy_lost [{}],peak_force [{}]\n",
                     time, time, unit_in_tables(units, dimension::energy),
                     unit_in_tables(units, dimension::force));
}

}  // namespace

EventTable::EventTable(std::filesystem::path file, UnitSystem units)
    : file_(std::move(file)), units_(units) {}

void EventTable::begin(const RunLayout& layout) {
  if (!layout.events) return;
  output_.emplace(file_);
  buffer_ = header(units_);
}

void EventTable::event(const Event& event) {
  if (!output_) return;
  fmt::format_to(std::back_inserter(buffer_), "{:.17g},{},{}", event.time,
                 event.label.empty() ? to_string(event.kind) : event.label, cell(event.name));
  for (const double x : {event.duration, event.size, event.energy_lost, event.peak_force}) {
    buffer_ += ',';
    if (std::isfinite(x)) fmt::format_to(std::back_inserter(buffer_), "{:.17g}", x);
  }
  buffer_ += '\n';
  output_->append_if_long(buffer_);
}

void EventTable::finish() {
  if (!output_) return;
  output_->append(buffer_);
  output_->publish();
}

}  // namespace tomlin
