#include "framework/output/extended_xyz.hpp"

#include <iterator>

#include <fmt/format.h>

#include "framework/output/number_text.hpp"

namespace tomlin {
namespace {

constexpr std::size_t kBuffer = std::size_t{1} << 18;  // bytes that are written at once

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

}  // namespace

ExtendedXyzWriter::ExtendedXyzWriter(const std::filesystem::path& file, const RunLayout& layout,
                                     const TrajectoryFacts& facts)
    : TrajectoryWriter(file, layout), output_(file) {
  std::string bodies;
  for (const TrajectoryBody& body : layout_.bodies) {
    bodies += (bodies.empty() ? "" : " ") + body.name;
  }
  head_ = fmt::format("{}\nProperties=species:S:1:pos:R:3:body:I:1 {} bodies={} units={} ",
                      layout_.particles(), lattice_of(TrajectoryBox(layout_)), in_quotes(bodies),
                      facts.units);
  if (!facts.name.empty()) head_ += "scene=" + in_quotes(facts.name) + " ";
}

void ExtendedXyzWriter::write(double time, std::span<const double> positions) {
  buffer_ += head_;
  buffer_ += "time=";
  append_number(buffer_, time);
  buffer_ += '\n';
  const double* place = positions.data();
  for (std::size_t b = 0; b < layout_.bodies.size(); ++b) {
    const std::string body = fmt::format(" {}\n", b);
    for (std::size_t i = 0; i < layout_.bodies[b].mass.size(); ++i) {
      buffer_ += 'X';
      for (std::size_t d = 0; d < kTrajectoryAxes; ++d) {
        buffer_ += ' ';
        append_number(buffer_, d < static_cast<std::size_t>(layout_.dimension) ? *place++ : 0.0);
      }
      buffer_ += body;
      if (buffer_.size() >= kBuffer) flush();
    }
  }
}

void ExtendedXyzWriter::flush() {
  output_.append(buffer_);
  buffer_.clear();
}

void ExtendedXyzWriter::finish() {
  flush();
  output_.publish();
}

}  // namespace tomlin
