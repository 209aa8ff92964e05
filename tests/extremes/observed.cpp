#include "tests/extremes/observed.hpp"

#include <atomic>
#include <cctype>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>

#include "framework/output/resumption.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/output/run_recorder.hpp"
#include "framework/run/results/observables.hpp"
#include "tests/framework/output/temporary_folder.hpp"
#include "tests/support/scenes.hpp"

namespace tomlin::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTextFiles[] = {kSummaryFile, kTableFile, kEventsFile, kXyzFile};

/// Returns the first word "nan" or "inf" of a text, with the text before it; empty: there is none.
std::string not_finite_in(const std::string& name, const std::string& text) {
  constexpr std::size_t kBefore = 40;
  std::string word;
  for (std::size_t i = 0; i <= text.size(); ++i) {
    const auto c = i < text.size() ? static_cast<unsigned char>(text[i]) : ' ';
    if (std::isalnum(c) != 0 || c == '_') {
      word += static_cast<char>(std::tolower(c));
      continue;
    }
    if (word == "nan" || word == "inf" || word == "infinity") {
      const std::size_t from = i < kBefore ? 0 : i - kBefore;
      return name + ": ..." + text.substr(from, i - from);
    }
    word.clear();
  }
  return "";
}

/// Stops a run that takes too long.
class Guard {
 public:
  Guard(RunOptions& options, double seconds) {
    options.stop = &stop_;
    options.on_progress = [this, seconds](const RunProgress& now) {
      if (now.elapsed_seconds > seconds) stop_ = true;
    };
  }
  bool stopped() const { return stop_; }

 private:
  std::atomic<bool> stop_{false};
};

void run_into(const fs::path& path, const std::shared_ptr<const Scene>& scene,
              const ExtremeCase& extreme, Observed& observed) {
  RunFolder folder(path, Occupied::refuse);
  folder.create();
  Resumption start = start_again(folder);
  folder.own(start.journal);
  RunRecorder recorder(folder, *scene, TOMLIN_VERSION, std::move(start), [] {});
  RunOptions options;
  options.sink = &recorder;
  const Guard guard(options, extreme.seconds);
  RunResult result = run(scene, options);
  observed.hung = guard.stopped();
  if (const auto trouble = recorder.finish(result)) throw std::runtime_error(*trouble);
  if (result.status == RunStatus::failed) {
    observed.outcome = Outcome::failed;
    observed.message = to_string(*result.failure);
  }
  observed.warnings = result.warnings;
  for (const Value& value : extreme.values) {
    observed.values.push_back(
        observable(result, value.path).value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  for (const char* name : kTextFiles) {
    if (!observed.not_finite.empty() || !folder.holds(name)) continue;
    observed.not_finite = not_finite_in(name, content(folder.file(name)));
  }
  observed.effective_reads =
      parse_scene(content(folder.file(kSceneFile)), "scene.toml", standard()) != nullptr;
}

}  // namespace

const char* to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::finished:
      return "finished";
    case Outcome::refused:
      return "refused";
    case Outcome::failed:
      return "failed";
  }
  return "";
}

Observed observe(const ExtremeCase& extreme) {
  Observed observed;
  const TemporaryFolder temporary;
  try {
    const auto scene = parse_scene(extreme.text, "scene", standard(), extreme.settings);
    run_into(temporary / "run", scene, extreme, observed);
  } catch (const InputError& error) {
    observed.outcome = Outcome::refused;
    observed.message = error.what();
  }
  return observed;
}

double result_of(const std::string& text, const std::vector<Setting>& settings,
                 const std::string& path) {
  const RunResult result = run(scene_of(text, settings));
  if (result.failure) throw std::runtime_error(to_string(*result.failure));
  return observable(result, path).value();
}

}  // namespace tomlin::test
