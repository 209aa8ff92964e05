#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "framework/output/result_file.hpp"
#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"

namespace tomlin {

/// Data of a trajectory on the run that it comes from.
struct TrajectoryFacts {
  std::string name;    ///< of the scene; may be empty
  std::string source;  ///< the same
  UnitSystem units = UnitSystem::reduced;
  std::string scene;    ///< the effective scene, TOML
  std::string version;  ///< of the program
};

TrajectoryFacts trajectory_facts(const Scene& scene, std::string version);

/// Writes the particles' positions of a run, frame by frame. The file is FILE.part until finish()
/// gives it its name: one that is not complete never has it. Everything throws OutputError.
class TrajectoryWriter {
 public:
  virtual ~TrajectoryWriter() = default;
  /// One row as a sink gets it: see RunLayout::row(). Positions that are not finite are refused.
  void frame(std::span<const double> row);
  /// The trajectory is complete.
  virtual void finish() = 0;

  std::size_t frames() const { return frames_; }

 protected:
  TrajectoryWriter(std::filesystem::path file, RunLayout layout);
  /// Positions are [particle][axis].
  virtual void write(double time, std::span<const double> positions) = 0;

  const std::filesystem::path file_;
  const RunLayout layout_;

 private:
  std::size_t frames_ = 0;
};

/// Name of the file in the folder of a run.
const char* trajectory_file_name(TrajectoryFormat format);

/// The layout has bodies.
std::unique_ptr<TrajectoryWriter> trajectory_writer(TrajectoryFormat format,
                                                    const std::filesystem::path& file,
                                                    const RunLayout& layout,
                                                    const TrajectoryFacts& facts);

/// The trajectory among the results of a run. Nothing is opened before the run begins, and nothing
/// ever where no positions are to come.
class TrajectoryFile : public ResultFile {
 public:
  TrajectoryFile(std::filesystem::path file, TrajectoryFormat format, TrajectoryFacts facts);

  void begin(const RunLayout& layout) override;
  void sample(const std::vector<double>& row) override;
  void finish() override;

 private:
  std::filesystem::path file_;
  TrajectoryFormat format_;
  TrajectoryFacts facts_;
  std::unique_ptr<TrajectoryWriter> writer_;
};

/// The species of particles that have none, for programs of the field: "not an element".
inline constexpr const char* kNoSpecies = "X";

/// Species of a particle of a body, by its name.
inline const std::string& species_name(const RunLayout& layout, const TrajectoryBody& body,
                                       std::size_t particle) {
  static const std::string none = kNoSpecies;
  return body.species.empty() ? none
                              : layout.species[static_cast<std::size_t>(body.species[particle])];
}

/// The axes that the field's programs expect, whatever a scene has.
inline constexpr std::size_t kTrajectoryAxes = 3;

/// A box as trajectories tell it: the length along periodic axes, 0 along all others, which repeat
/// nothing. Programs that overlook what is periodic then still measure no distance through a wall.
struct TrajectoryBox {
  bool periodic[kTrajectoryAxes] = {};
  double length[kTrajectoryAxes] = {};

  explicit TrajectoryBox(const RunLayout& layout);
  bool any() const { return periodic[0] || periodic[1] || periodic[2]; }
};

}  // namespace tomlin
