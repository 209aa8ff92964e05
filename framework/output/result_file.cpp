#include "framework/output/result_file.hpp"

#include "framework/output/event_table.hpp"
#include "framework/output/table.hpp"

namespace tomlin {

std::vector<std::unique_ptr<ResultFile>> result_files(const Scene& scene, const RunFolder& folder) {
  (void)scene;
  std::vector<std::unique_ptr<ResultFile>> files;
  files.push_back(std::make_unique<TableWriter>(folder.file(kTableFile)));
  files.push_back(std::make_unique<EventTable>(folder.file(kEventsFile)));
  return files;
}

}  // namespace tomlin
