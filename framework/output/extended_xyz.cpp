#include "framework/output/extended_xyz.hpp"

#include <iterator>

#include <fmt/format.h>

#include "framework/output/number_text.hpp"

namespace tomlin {
namespace {

/// Between quotation marks, on one line.
std::string in_quotes(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c == '\n' || c == '\r' ? ' ' : c;
  }
  return result + '"';
}

std::string lattice_of(const TrajectoryBox& box) {
  std::string cells;
  std::string periodic;
  for (std::size_t row = 0; row < kTrajectoryAxes; ++row) {
    for (std::size_t d = 0; d < kTrajectoryAxes; ++d) {
      if (!cells.empty()) cells += ' ';
      append_number(cells, row == d ? box.length[d] : 0.0);
    }
    periodic += periodic.empty() ? "" : " ";
    periodic += box.periodic[row] ? 'T' : 'F';
  }
  return (box.any() ? "Lattice=\"" + cells + "\" " : "") + "pbc=\"" + periodic + "\"";
}

/// Head of each frame, as far as it is always the same.
std::string head_of(const RunLayout& layout, const TrajectoryFacts& facts) {
  std::string bodies;
  for (const TrajectoryBody& body : layout.bodies) {
    bodies += (bodies.empty() ? "" : " ") + body.name;
  }
  std::string head = fmt::format(
      "{}\nProperties=species:S:1:pos:R:3:body:I:1 {} bodies={} units={} ", layout.particles(),
      lattice_of(TrajectoryBox(layout)), in_quotes(bodies), to_string(facts.units));
  if (layout.dimension < static_cast<int>(kTrajectoryAxes)) {
    head += fmt::format("dimension={} ", layout.dimension);
  }
  if (!facts.name.empty()) head += "scene=" + in_quotes(facts.name) + " ";
  return head + "time=";
}

/// The text behind the positions of a particle.
std::string end_of_line(std::size_t body) { return fmt::format(" {}\n", body); }

}  // namespace

std::size_t xyz_bytes_per_frame(const RunLayout& layout, const TrajectoryFacts& facts) {
  const auto axes = static_cast<std::size_t>(layout.dimension);
  // A blank and a number for each axis, a blank and a zero for each that is missing.
  const std::size_t of_positions = axes * (1 + kLongestNumber) + (kTrajectoryAxes - axes) * 2;
  std::size_t bytes = head_of(layout, facts).size() + kLongestNumber + 1;
  for (std::size_t b = 0; b < layout.bodies.size(); ++b) {
    const TrajectoryBody& body = layout.bodies[b];
    bytes += body.mass.size() * (of_positions + end_of_line(b).size());
    for (std::size_t i = 0; i < body.mass.size(); ++i) {
      bytes += species_name(layout, body, i).size();
    }
  }
  return bytes;
}

ExtendedXyzWriter::ExtendedXyzWriter(const std::filesystem::path& file, const RunLayout& layout,
                                     const TrajectoryFacts& facts)
    : TrajectoryWriter(file, layout), output_(file), head_(head_of(layout, facts)) {}

void ExtendedXyzWriter::write(double time, std::span<const double> positions) {
  buffer_ += head_;
  append_number(buffer_, time);
  buffer_ += '\n';
  const double* next = positions.data();
  for (std::size_t b = 0; b < layout_.bodies.size(); ++b) {
    const std::string body = end_of_line(b);
    for (std::size_t i = 0; i < layout_.bodies[b].mass.size(); ++i) {
      buffer_ += species_name(layout_, layout_.bodies[b], i);
      for (std::size_t d = 0; d < kTrajectoryAxes; ++d) {
        buffer_ += ' ';
        append_number(buffer_, d < static_cast<std::size_t>(layout_.dimension) ? *next++ : 0.0);
      }
      buffer_ += body;
      output_.append_if_long(buffer_);
    }
  }
}

void ExtendedXyzWriter::finish() {
  output_.append(buffer_);
  output_.publish();
}

}  // namespace tomlin
