#pragma once

#include <functional>
#include <stdexcept>
#include <string>

#include "framework/core/text/fault.hpp"
#include "framework/plot/stored_run.hpp"
#include "tests/framework/output/temporary_folder.hpp"

namespace tomlin::test {

/// The folder of a finished run, made of texts.
class RunFolderOfTexts {
 public:
  explicit RunFolderOfTexts(const std::string& table,
                            const std::string& summary = R"({"status": "finished"})") {
    write(folder_ / "summary.json", summary);
    write(folder_ / "observables.csv", table);
  }

  void add(const std::string& name, const std::string& text) { write(folder_ / name, text); }
  StoredRun run() const { return read_stored_run(folder_.path().string()); }

 private:
  TemporaryFolder folder_;
};

/// The first fault of what is refused.
inline Fault refusal_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.faults().front();
  }
  throw std::logic_error("it is not refused");
}

}  // namespace tomlin::test
