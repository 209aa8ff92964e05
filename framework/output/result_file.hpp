#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "framework/output/run_folder.hpp"
#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"

namespace tomlin {

/// A file of results that is made when a run ends: it gets begin(), then every sample and every
/// event of the run from the journal, then finish(). Until then it has an unfinished name. Throws
/// OutputError.
class ResultFile : public RunSink {
 public:
  /// Everything has come: the file gets its name.
  virtual void finish() = 0;
};

/// The files that a scene's runs leave beside the summary.
std::vector<std::unique_ptr<ResultFile>> result_files(const Scene& scene, const RunFolder& folder,
                                                      const std::string& program_version);

}  // namespace tomlin
