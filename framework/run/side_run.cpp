#include "framework/run/side_run.hpp"

#include <cstddef>
#include <stdexcept>
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

RunResult side_run(const std::shared_ptr<const Scene>& scene, RunOptions options,
                   const std::string& name) {
  options.sink = nullptr;
  options.resume_from = nullptr;
  options.final_state = nullptr;
  options.watches_energy = false;
  if (options.store == nullptr) return Engine(scene, options).run();
  Checkpoints checkpoints(*options.store, name);
  options.sink = &checkpoints;
  const std::vector<std::byte> kept = options.store->kept(name);
  if (!kept.empty()) {
    options.resume_from = &kept;
    try {
      return Engine(scene, options).run();
    } catch (const std::invalid_argument&) {
      options.resume_from = nullptr;  // of a program with other numbers in its state
    }
  }
  return Engine(scene, options).run();
}

}  // namespace tomlin
