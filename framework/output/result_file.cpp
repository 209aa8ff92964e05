#include "framework/output/result_file.hpp"

#include "framework/output/event_table.hpp"
#include "framework/output/table.hpp"
#include "framework/output/trajectory.hpp"

namespace tomlin {

std::vector<std::unique_ptr<ResultFile>> result_files(const Scene& scene, const RunFolder& folder,
                                                      const std::string& program_version) {
  std::vector<std::unique_ptr<ResultFile>> files;
  files.push_back(std::make_unique<TableWriter>(folder.file(kTableFile)));
  files.push_back(std::make_unique<EventTable>(folder.file(kEventsFile), scene.units));
  if (scene.output.trajectory) {
    const TrajectoryFormat format = scene.output.trajectory_format;
    files.push_back(std::make_unique<TrajectoryFile>(folder.file(trajectory_file_name(format)),
                                                     format,
                                                     trajectory_facts(scene, program_version)));
  }
  return files;
}

}  // namespace tomlin
