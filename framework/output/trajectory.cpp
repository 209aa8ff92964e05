#include "framework/output/trajectory.hpp"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "framework/output/extended_xyz.hpp"
#include "framework/output/h5md.hpp"
#include "framework/output/output_file.hpp"

namespace tomlin {

TrajectoryFacts trajectory_facts(const Scene& scene, std::string version) {
  return {scene.name, scene.source, scene.units, scene.effective_toml, std::move(version)};
}

TrajectoryWriter::TrajectoryWriter(std::filesystem::path file, RunLayout layout)
    : file_(std::move(file)), layout_(std::move(layout)) {}

void TrajectoryWriter::frame(std::span<const double> row) {
  if (row.size() != layout_.row()) {
    throw OutputError(fmt::format("{}: a sample of {} numbers where {} are expected",
                                  file_.string(), row.size(), layout_.row()));
  }
  const std::span<const double> positions = row.subspan(layout_.columns.size());
  for (std::size_t k = 0; k < positions.size(); ++k) {
    if (std::isfinite(positions[k])) continue;
    throw OutputError(fmt::format("{}: sample {}: the position of particle {} is not finite",
                                  file_.string(), frames_,
                                  k / static_cast<std::size_t>(layout_.dimension)));
  }
  write(row.front(), positions);
  ++frames_;
}

TrajectoryBox::TrajectoryBox(const RunLayout& layout) {
  for (std::size_t d = 0; d < layout.box.size(); ++d) {
    if (!layout.periodic[d]) continue;
    periodic[d] = true;
    length[d] = layout.box[d];
  }
}

const char* trajectory_file_name(TrajectoryFormat format) {
  switch (format) {
    case TrajectoryFormat::h5md:
      return kH5mdFile;
    case TrajectoryFormat::xyz:
      return kXyzFile;
  }
  return "";
}

std::unique_ptr<TrajectoryWriter> trajectory_writer(TrajectoryFormat format,
                                                    const std::filesystem::path& file,
                                                    const RunLayout& layout,
                                                    const TrajectoryFacts& facts) {
  switch (format) {
    case TrajectoryFormat::h5md:
      return std::make_unique<H5mdWriter>(file, layout, facts);
    case TrajectoryFormat::xyz:
      return std::make_unique<ExtendedXyzWriter>(file, layout, facts);
  }
  return nullptr;
}

TrajectoryFile::TrajectoryFile(std::filesystem::path file, TrajectoryFormat format,
                               TrajectoryFacts facts)
    : file_(std::move(file)), format_(format), facts_(std::move(facts)) {}

void TrajectoryFile::begin(const RunLayout& layout) {
  if (!layout.bodies.empty()) writer_ = trajectory_writer(format_, file_, layout, facts_);
}

void TrajectoryFile::sample(const std::vector<double>& row) {
  if (writer_) writer_->frame(row);
}

void TrajectoryFile::finish() {
  if (writer_) writer_->finish();
}

}  // namespace tomlin
