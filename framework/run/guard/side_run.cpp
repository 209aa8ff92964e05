#include "framework/run/guard/side_run.hpp"

#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

#include "framework/run/engine.hpp"

namespace tomlin {
namespace {

/// Takes checkpoints and nothing else.
class Checkpoints : public RunSink {
 public:
  Checkpoints(RunStore& store, const std::string& name) : store_(store), name_(name) {}
  void begin(const RunLayout& layout) override { (void)layout; }
  void sample(const std::vector<double>& row) override { (void)row; }
  void checkpoint(const RunState& state) override { store_.keep(name_, state.to_bytes()); }
  bool wants_samples() const override { return false; }

 private:
  RunStore& store_;
  const std::string& name_;
};

}  // namespace

SideRun::SideRun(const std::shared_ptr<const Scene>& scene, RunOptions options, std::string name)
    : name_(std::move(name)) {
  options.sink = nullptr;
  options.resume_from = nullptr;
  options.final_state = nullptr;
  options.watches_energy = false;
  if (options.store != nullptr) {
    checkpoints_ = std::make_unique<Checkpoints>(*options.store, name_);
    options.sink = checkpoints_.get();
    kept_ = options.store->kept(name_);
  }
  if (!kept_.empty()) {
    options.resume_from = &kept_;
    try {
      engine_ = std::make_unique<Engine>(scene, options);
      return;
    } catch (const std::invalid_argument&) {
      options.resume_from = nullptr;  // of a program with other numbers in its state
    }
  }
  engine_ = std::make_unique<Engine>(scene, options);
}

SideRun::~SideRun() = default;

RunResult side_run(const std::shared_ptr<const Scene>& scene, RunOptions options,
                   const std::string& name) {
  return SideRun(scene, std::move(options), name).engine().run();
}

}  // namespace tomlin
