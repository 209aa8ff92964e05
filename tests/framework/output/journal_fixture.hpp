#pragma once

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "framework/output/journal.hpp"

/// A small journal with everything in it, and what was read of one.
namespace tomlin::test {

inline RunLayout small_layout() {
  RunLayout layout;
  layout.columns = {{"time", "time"}, {"driver.force.x", "force"}};
  layout.bodies = {{"tip", {1.0}}, {"chain", {0.5, 0.25}}};
  layout.species = {"C", "H"};
  layout.bodies.back().species = {1, 0};
  layout.dimension = 1;
  layout.box = {8.0};
  layout.periodic = {true};
  layout.events = true;
  layout.state = "position 3, clock 2";
  return layout;
}

/// Row number k.
inline std::vector<double> small_row(std::uint64_t k) {
  const auto x = static_cast<double>(k);
  return {x, -x / 3.0, 1e300 * x, -0.0, std::numeric_limits<double>::denorm_min()};
}

/// Event number k.
inline Event small_event(std::uint64_t k) {
  Event event;
  event.kind = static_cast<EventKind>(k % kEventKinds);
  event.name = k % 2 == 0 ? "driver" : "a \"name\", with a comma";
  event.time = 0.1 * static_cast<double>(k);
  event.duration = std::nan("");
  event.size = -1.0 / static_cast<double>(k + 1);
  return event;
}

inline bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

inline bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

inline bool same(const Event& a, const Event& b) {
  return a.kind == b.kind && a.name == b.name && same_bits(a.time, b.time) &&
         same_bits(a.duration, b.duration) && same_bits(a.size, b.size) &&
         same_bits(a.energy_lost, b.energy_lost) && same_bits(a.peak_force, b.peak_force);
}

/// Takes nothing but what was written: counts it, and anything else.
class Compared : public RunSink {
 public:
  void begin(const RunLayout&) override { ++begun; }
  void sample(const std::vector<double>& row) override {
    if (!same(row, small_row(rows))) ++wrong;
    ++rows;
  }
  void event(const Event& event) override {
    if (!same(event, small_event(events))) ++wrong;
    ++events;
  }

  int begun = 0;
  std::uint64_t rows = 0;
  std::uint64_t events = 0;
  int wrong = 0;
};

inline JournalHeader small_header() { return {"1.2.3", "a scene\nof two lines\n", small_layout()}; }

/// Rows and events [from, to), in a record for every three of each.
inline JournalMark write_on(JournalWriter& journal, std::uint64_t from, std::uint64_t to) {
  for (std::uint64_t k = from; k < to; ++k) {
    journal.row(small_row(k));
    journal.event(small_event(k));
    if (k % 3 == 2) journal.flush();
  }
  return journal.flush();
}

inline JournalMark write_small_journal(const std::filesystem::path& file, std::uint64_t count) {
  JournalWriter journal(file, own_journal(file, Absent::make_it), small_header());
  return write_on(journal, 0, count);
}

}  // namespace tomlin::test
