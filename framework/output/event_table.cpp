#include "framework/output/event_table.hpp"

#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include <fmt/format.h>

namespace tomlin {
namespace {

constexpr std::size_t kBuffer = std::size_t{1} << 16;  // bytes that are written at once

/// Names with a comma, a quote or a line break stand in quotes.
std::string cell(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + '"';
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
  if (buffer_.size() >= kBuffer) flush();
}

void EventTable::flush() {
  output_->append(buffer_);
  buffer_.clear();
}

void EventTable::finish() {
  if (!output_) return;
  flush();
  output_->publish();
}

}  // namespace tomlin
