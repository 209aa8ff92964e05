// Time per rk4 step of the engine, with everything that a run does along the way: running means,
// extremes, checks of every step. The scenes are those of the plain loops.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "benchmarks/counters.hpp"
#include "benchmarks/plain_loops.hpp"
#include "framework/model/friction_tables.hpp"
#include "framework/model/single_force.hpp"
#include "framework/run/engine.hpp"
#include "framework/run/steps/lane_batch.hpp"
#include "framework/scene/scene.hpp"
#include "framework/scene/scene_document.hpp"
#include "framework/standard_registry.hpp"
#include "framework/study/accuracy/accuracy.hpp"
#include "framework/study/sweep/point_run.hpp"
#include "framework/study/sweep/runner.hpp"
#include "framework/study/sweep/sweep_plan.hpp"
#include "framework/study/sweep/worker.hpp"

namespace {

using namespace tomlin;

const Registry& registry() {
  static const Registry all = standard_registry();
  return all;
}

/// Every force of this registry is a plugin's: its exceptions are caught, its arithmetic is
/// checked.
const Registry& registry_of_plugins() {
  static const Registry all = [] {
    const Registry& ours = registry();
    Registry plugins;
    for (const auto& record : ours.bodies()) plugins.add(*record);
    for (const auto& record : ours.integrators()) plugins.add(*record);
    for (const auto& record : ours.forces()) {
      ForceRecord theirs = *record;
      theirs.library = "libforces.so";
      plugins.add(std::move(theirs));
    }
    return plugins;
  }();
  return all;
}

/// The scene with another scheme and its own step.
std::vector<Setting> scheme(const std::string& name) {
  return {{"run.integrator.type", "\"" + name + "\""}};
}

std::vector<Setting> adaptive(const std::string& name) {
  return {{"run.integrator", "{ type = \"" + name + "\" }"}};
}

/// The phases of particles at this spacing fill the period of the substrate.
const std::string kGolden = "1.618033988749895";

const std::string kPt = R"--(
[[body]]
type = "point"
position = [0.0]
particle_mass = 1.0
[[force]]
type = "driving_spring"
stiffness = 2.0
velocity = [1e-3]
[[force]]
type = "viscous_damping"
coefficient = "2 * sqrt(2)"
[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0
[run]
duration = 1e9
integrator = { type = "rk4", dt = 1e-2 }
)--";

std::string ring(const std::string& coordinates, const std::string& dt) {
  return R"--(
[parameters]
N = 8
[[body]]
type = "ring"
count = "N"
radius = 1.0
particle_mass = "1 / N"
centre = [0.0, 1.0]
coordinates = ")--" +
         coordinates + R"--("
[[force]]
type = "harmonic_bonds"
pairs = "all"
stiffness = 1e6
[[force]]
type = "driving_spring"
stiffness = 2.0
velocity = [1e-3, 0.0]
[[force]]
type = "viscous_damping"
coefficient = "2 * sqrt(2) / N"
[[force]]
type = "sinusoidal_substrate"
amplitude = "0.1 / N"
period = 1.0
decay = 1.0
[run]
duration = 1e9
integrator = { type = "rk4", dt = )--" +
         dt + " }\n";
}

std::string chain(const std::string& count, const std::string& spacing) {
  return R"--(
[[body]]
type = "chain"
count = )--" +
         count + R"--(
spacing = )--" +
         spacing + R"--(
particle_mass = 1.0
[[force]]
type = "harmonic_bonds"
pairs = "neighbours"
stiffness = 1.0
[[force]]
type = "driving_spring"
stiffness = 1.0
velocity = [1e-3]
[[force]]
type = "viscous_damping"
coefficient = 0.1
[[force]]
type = "sinusoidal_substrate"
amplitude = 0.05
period = 1.0
[run]
duration = 1e9
integrator = { type = "rk4", dt = 1e-2 }
)--";
}

/// Particles without bonds on a hexagonal surface.
std::string flake(int columns, int rows, double spacing) {
  std::string positions;
  for (int i = 0; i < columns * rows; ++i) {
    positions += "[" + std::to_string(i % columns * spacing) + ", " +
                 std::to_string(i / columns * spacing) + "], ";
  }
  return "[[body]]\ntype = \"particles\"\nparticle_mass = 1.0\npositions = [" + positions + "]\n" +
         R"--(
[[force]]
type = "driving_spring"
stiffness = 1.0
velocity = [1e-3, 5e-4]
[[force]]
type = "viscous_damping"
coefficient = 0.1
[[force]]
type = "lattice_substrate"
lattice = "hexagonal"
period = 1.0
amplitude = 0.05
[run]
duration = 1e9
integrator = { type = "rk4", dt = 1e-2 }
)--";
}

/// Takes samples as a journal does: copies them into blocks, and forgets those.
class Blocks : public RunSink {
 public:
  void begin(const RunLayout& layout) override { block_.reserve(kBlock + layout.row()); }
  void sample(const std::vector<double>& row) override {
    if (block_.size() >= kBlock) block_.clear();
    block_.insert(block_.end(), row.begin(), row.end());
    benchmark::DoNotOptimize(block_.data());
  }

 private:
  static constexpr std::size_t kBlock = 8192;  // numbers
  std::vector<double> block_;
};

Engine& engine_for(const std::string& scene, const std::vector<Setting>& settings = {},
                   const Registry& components = registry()) {
  RunOptions options;
  options.sink = new Blocks;
  // Leaked on purpose: repetitions go on along the trajectory, and the benchmark ends the process.
  return *new Engine(parse_scene(scene, "benchmark.toml", components, settings), options);
}

void run(benchmark::State& state, Engine& engine, std::uint64_t batch) {
  for (auto _ : state) {
    engine.advance(batch);
    benchmark::ClobberMemory();
  }
  if (engine.done()) state.SkipWithError("the run ended");
  const double steps = static_cast<double>(state.iterations()) * static_cast<double>(batch);
  state.SetItemsProcessed(static_cast<std::int64_t>(steps));
  count_steps(state, steps);
}

/// Rigid in space, as plain::RigidBox.
std::string rigid_box() {
  std::string positions;
  for (const auto& position : plain::RigidBox<plain::StdMath>::positions()) {
    positions += fmt::format("[{}, {}, {}], ", position[0], position[1], position[2]);
  }
  return "[[body]]\ntype = \"particles\"\npositions = [" + positions +
         "]\nparticle_mass = 0.125\ncoordinates = \"rigid\"\n" + R"--(
[[force]]
name = "driver"
type = "driving_spring"
stiffness = 2.0
velocity = [1e-3, 0.0, 0.0]
[[force]]
type = "viscous_damping"
coefficient = 0.05
[[force]]
type = "sinusoidal_substrate"
amplitude = 0.05
period = 1.0
decay = 1.0
[run]
duration = 1e9
integrator = { type = "rk4", dt = 1e-2 }
)--";
}

/// The twin is where the engine is, but for the errors of their steps.
bool as_its_twin(Engine& engine) {
  constexpr double kSteps = 1e-7;
  plain::RigidBox<plain::StdMath> twin;
  twin.advance(2000, 1e-2);
  engine.advance(2000);
  const std::size_t centre = engine.model().bodies().front().bound.slot.centre;
  for (std::size_t d = 0; d < 3; ++d) {
    const double at = engine.model().system().view.position[centre + d];
    if (!(std::abs(at - twin.centre()[d]) < kSteps)) return false;
  }
  return true;
}

void BM_rigid_box(benchmark::State& state) {
  static Engine& engine = engine_for(rigid_box());
  static const bool same = as_its_twin(engine);
  if (!same) state.SkipWithError("the twin is elsewhere");
  run(state, engine, 16);
}
BENCHMARK(BM_rigid_box)->Name("rigid_box_24/tomlin");

/// The energy of bonds and substrate, as at both ends of what the balance of a run looks at.
void BM_chain_energy_1000(benchmark::State& state) {
  static Engine& engine = engine_for(chain("1000", kGolden));
  const SystemView<double>& view = engine.model().system().view;
  const Stage<double> here = stage_of(view, view.position, view.velocity, view.integrals,
                                      static_cast<double*>(nullptr), 0.0);
  for (auto _ : state) {
    double total = 0.0;
    for (const Model::Force& force : engine.model().forces()) total += force.energy(here);
    benchmark::DoNotOptimize(total);
  }
  count_steps(state);
}
BENCHMARK(BM_chain_energy_1000)->Name("chain_energy_1000/tomlin");

// ---- what it costs to watch the energy balance: whole runs, from the text of the scene to the
// result, with it and without by turns. The ratio of the medians is the figure.

double seconds_of_run(const std::string& scene, const std::vector<Setting>& settings,
                      bool watches_energy) {
  RunOptions options;
  options.watches_energy = watches_energy;
  const auto begin = std::chrono::steady_clock::now();
  benchmark::DoNotOptimize(
      run_as_bound(parse_scene(scene, "benchmark", registry(), settings), options));
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double median_of(std::vector<double> all) {
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  return *middle;
}

void BM_watched(benchmark::State& state, const std::string& scene,
                const std::vector<Setting>& settings) {
  std::vector<double> watched;
  std::vector<double> blind;
  for (auto _ : state) {
    blind.push_back(seconds_of_run(scene, settings, false));
    watched.push_back(seconds_of_run(scene, settings, true));
  }
  state.counters["watched_over_blind"] = median_of(watched) / median_of(blind);
}

void register_watched() {
  struct Watched {
    std::string model;
    std::string scene;
    std::string dt;
    std::vector<Setting> settings = {};
  };
  const std::vector<Setting> overdamped = {{"run.dynamics", "overdamped"}};
  for (const Watched& one :
       {Watched{"pt", kPt, "1e-2"}, Watched{"rigid_ring_8", ring("rigid", "1e-2"), "1e-2"},
        Watched{"flexible_ring_8", ring("particles", "1e-4"), "1e-4"},
        Watched{"chain_1000", chain("1000", "1.0"), "1e-2"},
        Watched{"pt baoab", kPt, "1e-2", scheme("baoab")},
        Watched{"pt dopri5", kPt, "0.1", adaptive("dopri5")},
        Watched{"pt overdamped", kPt, "1e-2", overdamped}}) {
    for (const std::string steps : {"100", "1000", "1e4"}) {
      benchmark::RegisterBenchmark((one.model + " " + steps + " steps/watched").c_str(),
                                   [one, steps](benchmark::State& state) {
                                     std::vector<Setting> settings = one.settings;
                                     settings.push_back({"run.duration", steps + " * " + one.dt});
                                     BM_watched(state, one.scene, settings);
                                   })
          ->Unit(benchmark::kMicrosecond);
    }
  }
}

// ---- what an accuracy costs: a whole run with the integrator that is picked for 1e-4, the same
// with its companion, and with the pilot before it

constexpr const char* kAccuracy = "1e-4";

std::shared_ptr<const Scene> asked_scene() {
  return parse_scene(ring("rigid", "1e-2"), "benchmark", registry(),
                     {{"run.duration", "1e4"}, {"run.accuracy", kAccuracy}});
}

void BM_picked(benchmark::State& state) {
  const ChosenIntegrator chosen = choose_integrator(asked_scene(), registry());
  for (auto _ : state) benchmark::DoNotOptimize(run_as_bound(chosen.scene));
}
BENCHMARK(BM_picked)->Name("rigid_ring_8 to 1e-4/run")->Unit(benchmark::kMicrosecond);

void BM_estimated(benchmark::State& state) {
  const ChosenIntegrator chosen = choose_integrator(asked_scene(), registry());
  for (auto _ : state) {
    RunResult result = run_as_bound(chosen.scene);
    estimate_errors(chosen, {}, result);
    benchmark::DoNotOptimize(result);
  }
}
BENCHMARK(BM_estimated)->Name("rigid_ring_8 to 1e-4/run and errors")->Unit(benchmark::kMicrosecond);

void BM_asked(benchmark::State& state) {
  const auto scene = asked_scene();
  for (auto _ : state) benchmark::DoNotOptimize(tomlin::run(scene));
}
BENCHMARK(BM_asked)
    ->Name("rigid_ring_8 to 1e-4/pilot, run and errors")
    ->Unit(benchmark::kMicrosecond);

// ---- a scene described once more with another value, as a sweep does: from a document that has
// been parsed, and from its text

const std::vector<Setting> kOneValue = {{"force.sinusoidal_substrate.amplitude", "0.2"}};

void BM_read_document(benchmark::State& state) {
  const SceneDocument document(ring("rigid", "1e-2"), "benchmark.toml");
  for (auto _ : state) benchmark::DoNotOptimize(document.read(registry(), kOneValue));
}
BENCHMARK(BM_read_document)->Name("scene/from a document")->Unit(benchmark::kMicrosecond);

void BM_read_text(benchmark::State& state) {
  const std::string text = ring("rigid", "1e-2");
  for (auto _ : state) {
    benchmark::DoNotOptimize(parse_scene(text, "benchmark.toml", registry(), kOneValue));
  }
}
BENCHMARK(BM_read_text)->Name("scene/from its text")->Unit(benchmark::kMicrosecond);

// ---- what features cost: the same scene with one thing changed, over the scene as it is

struct Variant {
  const char* name;
  std::vector<Setting> settings;
  std::uint64_t batch = 16;
};

void register_variants(const std::string& model, const std::string& scene,
                       const std::vector<Variant>& variants,
                       const Registry& components = registry()) {
  for (const Variant& variant : variants) {
    const auto engine = std::make_shared<Engine*>(nullptr);
    benchmark::RegisterBenchmark((model + "/" + variant.name).c_str(),
                                 [engine, scene, variant, &components](benchmark::State& state) {
                                   if (!*engine) {
                                     *engine = &engine_for(scene, variant.settings, components);
                                   }
                                   run(state, **engine, variant.batch);
                                 });
  }
}

const std::vector<Variant>& common_variants() {
  static const std::vector<Variant> variants = {
      {"ledger", {{"run.ledger", "true"}}},
      {"sample every 100 steps", {{"output.every", "100 * 1e-2"}}},
      {"quadruple", {{"run.number_type", "\"quadruple\""}}, 1},
      {"midpoint", scheme("midpoint")},
      {"velocity_verlet", scheme("velocity_verlet")},
      {"overdamped", {{"run.dynamics", "\"overdamped\""}}},
      {"dopri5", adaptive("dopri5"), 1},
      {"radau9", adaptive("radau9"), 1},
      {"dop853", adaptive("dop853"), 1},
  };
  return variants;
}

/// The scene without its friction, for the scheme that takes none.
std::string without_friction(std::string scene) {
  const auto from = scene.find("[[force]]\ntype = \"viscous_damping\"");
  return scene.erase(from, scene.find("[[", from + 2) - from);
}

std::string with_text(std::string scene, const std::string& from, const std::string& until,
                      const std::string& text) {
  const auto first = scene.find(from);
  return scene.replace(first, scene.find(until, first) - first, text);
}

/// The scene with its substrate written out as a formula.
std::string substrate_as_formula(const std::string& scene, const std::string& energy) {
  return with_text(scene, "type = \"sinusoidal_substrate\"", "[run]",
                   "type = \"expression\"\nperiod = 1.0\nenergy = \"" + energy + "\"\n");
}

/// The scene with its bonds written out as a formula; r0 for all of them.
std::string bonds_as_formula(const std::string& scene, const std::string& energy) {
  return with_text(scene, "type = \"harmonic_bonds\"", "[[force]]",
                   "type = \"expression\"\npairs = \"neighbours\"\nenergy = \"" + energy + "\"\n");
}

/// The scene of a tip with its driving spring written out as a formula.
std::string driver_as_formula(const std::string& scene) {
  return with_text(scene, "type = \"driving_spring\"", "[[force]]",
                   "type = \"expression\"\nenergy = \"0.5*2.0*(x - 1e-3*t)^2\"\ndriver = true\n");
}

void register_formulas() {
  const std::string wave = "0.05 * cos(2*pi*x)";
  const std::string corrugation = "0.1/N * exp(-y^2) * cos(2*pi*x)";
  const std::vector<Variant> substrate = {{"substrate as a formula", {}}};
  const std::vector<Variant> bonds = {{"bonds as a formula", {}, 1}};
  const auto remembering = [](const std::string& scene, const std::string& until) {
    return with_text(scene, "type = \"viscous_damping\"", until,
                     "type = \"memory_damping\"\ncoefficient = 0.3\nmemory_time = 0.5\n");
  };
  const std::vector<Variant> memory = {{"drag with a memory", {}}};
  register_variants("pt_memory", remembering(kPt, "[[force]]"), {{"tomlin", {}, 64}});
  register_variants("rigid_ring_8", remembering(ring("rigid", "1e-2"), "[[force]]"), memory);
  register_variants("chain_1000", remembering(chain("1000", "1.0"), "[[force]]"), memory);
  register_variants("pt", substrate_as_formula(kPt, "0.1 * cos(2*pi*x)"), substrate);
  register_variants("rigid_ring_8", substrate_as_formula(ring("rigid", "1e-2"), corrugation),
                    substrate);
  register_variants("flexible_ring_8", substrate_as_formula(ring("particles", "1e-4"), corrugation),
                    substrate);
  register_variants("chain_1000", substrate_as_formula(chain("1000", "1.0"), wave), substrate);
  register_variants("golden_chain_1000", substrate_as_formula(chain("1000", kGolden), wave),
                    substrate);
  register_variants("pt", driver_as_formula(kPt), {{"spring as a formula that drives", {}, 64}});
  register_variants("chain_1000", bonds_as_formula(chain("1000", "1.0"), "0.5*(r - 1)^2"), bonds);
}

// ---- a point of a sweep: what it costs besides its steps, of which it has one

/// Tips of which only a number changes.
SweepPlan sweep_of_tips(const std::string& duration) {
  SweepSettings sweep;
  sweep.over.push_back({"force.driving_spring.stiffness",
                        std::get<SweepValues>(SweepValues::parse("1:3:1000")),
                        {"--over"},
                        "1:3:1000"});
  sweep.observables = {"driving_spring.mean_force.x"};
  return SweepPlan(SceneDocument(kPt, "benchmark.toml"), registry(), {{"run.duration", duration}},
                   sweep, "");
}

void BM_sweep_point(benchmark::State& state) {
  const SweepPlan plan = sweep_of_tips("1e-2");
  std::size_t point = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(PointRun(plan, point++ % plan.points()).run());
  }
  count_steps(state);
}
BENCHMARK(BM_sweep_point)->Name("pt sweep/tomlin");

/// Points one after the other, again and again, as many as are asked for.
class Points : public PointSource {
 public:
  Points(std::size_t points, std::size_t wanted) : points_(points), left_(wanted) {}
  std::vector<std::size_t> take() override {
    if (left_ == 0) return {};
    return {--left_ % points_};
  }
  void keep(std::size_t, const SweepRow& row) override { benchmark::DoNotOptimize(&row); }

 private:
  std::size_t points_;
  std::size_t left_;
};

/// Short runs of a tip in lanes. Time of a point.
void BM_sweep_in_lanes(benchmark::State& state) {
  constexpr std::size_t kPoints = 1024;
  const SweepPlan plan = sweep_of_tips("1000 * 1e-2");
  for (auto _ : state) {
    Points points(plan.points(), kPoints);
    SweepWorker(plan, points, {.most_at_once = kPoints}).work();
  }
  count_steps(state, static_cast<double>(state.iterations()) * kPoints);
}
BENCHMARK(BM_sweep_in_lanes)->Name("pt sweep of 1000 steps/tomlin");

/// The scene in a bath, whose friction is that of the scene.
std::string with_noise(std::string scene) {
  const std::string friction = "type = \"viscous_damping\"";
  return scene.replace(scene.find(friction), friction.size(),
                       "type = \"langevin\"\ntemperature = 0.01");
}

// ---- replicas, with what a sweep watches of them: the mean force, or all of a tip. Time of a step
// of one.

enum class Taken { in_lanes, alone };

/// Replicas whose drivers differ in speed, to their end. What comes before the first step is not
/// timed.
void BM_replicas(benchmark::State& state, const std::string& scene, std::size_t count, Taken taken,
                 const std::vector<Setting>& settings,
                 const std::vector<std::string>& observables) {
  RunOptions options;
  options.observables = observables;
  std::uint64_t steps = 0;
  for (auto _ : state) {
    state.PauseTiming();
    std::vector<std::unique_ptr<Engine>> engines;
    for (std::size_t k = 0; k < count; ++k) {
      std::vector<Setting> own = settings;
      own.push_back(
          {"force.driving_spring.stiffness", std::to_string(2.0 + 0.01 * static_cast<double>(k))});
      own.push_back({"run.stream", std::to_string(k)});
      engines.push_back(
          std::make_unique<Engine>(parse_scene(scene, "benchmark.toml", registry(), own), options));
    }
    state.ResumeTiming();
    if (taken == Taken::alone) {
      for (const auto& engine : engines) benchmark::DoNotOptimize(engine->run());
    } else {
      LaneBatch batch(*engines.front(), engines.size());
      for (const auto& engine : engines) batch.add(*engine);
      while (!batch.is_empty()) batch.advance();
      for (const auto& engine : engines) benchmark::DoNotOptimize(engine->end());
    }
    for (const auto& engine : engines) steps += engine->steps();
  }
  count_steps(state, static_cast<double>(steps));
}

void register_replicas() {
  struct Replicas {
    std::string model;
    std::string scene;
    std::size_t count;
    std::vector<Setting> settings;
    std::vector<std::string> observables = {"driving_spring.mean_force.x"};
    bool alone = true;  ///< one by one, too
  };
  const std::vector<std::string> watched = {
      "driving_spring.mean_force.x", "driving_spring.max_force.x", "driving_spring.min_force.x",
      "driving_spring.static_force", "events.slips"};
  const Setting baoab = scheme("baoab").front();
  const std::vector<Replicas> all = {
      {"pt", kPt, 64, {{"run.duration", "4e3"}}},
      // These keep a ledger of their own in lanes.
      {"pt short", kPt, 64, {{"run.duration", "1e2"}}},
      {"rigid_ring_8 short", ring("rigid", "1e-2"), 16, {{"run.duration", "1e2"}}},
      // Against "one by one": what a batch of one lane costs a run that has its own route.
      {"pt one", kPt, 1, {{"run.duration", "4e4"}}},
      {"pt watched", kPt, 64, {{"run.duration", "4e3"}}, watched},
      {"pt baoab without noise",
       kPt,
       64,
       {{"run.duration", "2e4"}, baoab},
       {"driving_spring.mean_force.x"},
       false},
      {"pt baoab",
       with_noise(kPt),
       64,
       {{"run.duration", "2e4"}, baoab},
       {"driving_spring.mean_force.x"},
       false},
      {"rigid_ring_8 baoab without noise",
       ring("rigid", "1e-2"),
       16,
       {{"run.duration", "1e3"}, baoab}},
      {"rigid_ring_8 baoab",
       with_noise(ring("rigid", "1e-2")),
       16,
       {{"run.duration", "1e3"}, baoab}},
      {"rigid_ring_8", ring("rigid", "1e-2"), 16, {{"run.duration", "1e3"}}},
      {"flexible_ring_8", ring("particles", "1e-4"), 16, {{"run.duration", "10"}}},
      {"rigid_ring_8 dopri5",
       ring("rigid", "1e-2"),
       16,
       {{"run.duration", "5e4"}, adaptive("dopri5").front()}},
  };
  for (const Replicas& one : all) {
    for (const Taken taken : {Taken::in_lanes, Taken::alone}) {
      if (taken == Taken::alone && !one.alone) continue;
      const std::string name =
          one.model + " replicas/" + (taken == Taken::in_lanes ? "tomlin" : "one by one");
      benchmark::RegisterBenchmark(name.c_str(), [one, taken](benchmark::State& state) {
        BM_replicas(state, one.scene, one.count, taken, one.settings, one.observables);
      });
    }
  }
}

// ---- one force alone ----------------------------------------------------------------------------

const std::string kGoldenChain = "type = \"chain\"\ncount = 1000\nspacing = " + kGolden + "\n";
/// In the plane, where it bends: the particles of plain::Bending.
const std::string kRing = "type = \"ring\"\ncount = 1000\nradius = 100.0\ncentre = [0.0, 0.0]\n";

/// Normal numbers for 64 tips, step after step. Time of a number.
void BM_normals(benchmark::State& state) {
  constexpr std::size_t kTips = 64;
  constexpr std::size_t kTogether = 2 * kGroup;
  std::vector<FrictionArguments<double>> tips(kTips);
  std::vector<const FrictionArguments<double>*> run;
  AlignedVector<double> drawn(kTips * kNoiseParts * kMostDrawn, 0.0);
  std::vector<std::uint64_t> drawn_for(kTips * kNoiseParts, ~std::uint64_t{0});
  for (std::size_t k = 0; k < kTips; ++k) {
    FrictionArguments<double>& tip = tips[k];
    tip.body.count = 1;
    tip.length = tip.body.stride = kGroup;
    tip.axes = 1;
    tip.key = {17, k};
    tip.together = kTogether;
    tip.drawn = drawn.data() + k * kNoiseParts * kMostDrawn;
    tip.drawn_for = drawn_for.data() + k * kNoiseParts;
    run.push_back(&tip);
  }
  AlignedVector<double> normals((kTogether + 1) * kTips, 0.0);
  AlignedVector<double> numbers(kTips, 0.0);
  std::vector<std::uint64_t> next(kTips, 0);
  std::vector<std::uint64_t> ahead(kTips, 0);
  bool any_new = false;
  FrictionLanes lanes;
  lanes.width = kTips;
  lanes.rows = 1;
  lanes.noisy = true;
  lanes.together = kTogether;
  lanes.run = run.data();
  lanes.any_new = &any_new;
  lanes.ahead = ahead.data();
  lanes.normals = normals.data();
  lanes.next = next.data();
  const auto& table = kernels::FrictionKernels.on<double>(chosen_instruction_set());
  std::uint64_t step = 0;
  for (auto _ : state) {
    table.fill_in_lanes(&lanes, {}, step++, numbers.data());
    benchmark::ClobberMemory();
  }
  count_steps(state, static_cast<double>(state.iterations() * kTips));
}
BENCHMARK(BM_normals)->Name("normals of replicas/tomlin");

/// The scene at a temperature without noise.
std::string with_links(const std::string& scene) {
  const std::size_t run = scene.find("[run]");
  return scene.substr(0, run) +
         "[[force]]\ntype = \"nose_hoover_chain\"\ntemperature = 0.01\nperiod = 6.0\n" +
         scene.substr(run);
}

/// Each step with its thermostat, and without.
void register_thermostats(const std::string& model, const std::string& scene) {
  register_variants(model, scene, {{"baoab without noise", scheme("baoab"), 64}});
  register_variants(model, with_noise(scene),
                    {{"baoab", scheme("baoab"), 64}, {"gjf", scheme("gjf"), 64}});
  register_variants(model, with_links(scene), {{"baoab with links", scheme("baoab"), 64}});
}

void evaluate(benchmark::State& state, SingleForce& alone) {
  for (auto _ : state) benchmark::DoNotOptimize(alone.forces(0.0));
  count_steps(state);
}

/// All evaluations of a scene's only force, none of the engine's other work.
void register_force(const std::string& model, const char* name, const std::string& force,
                    const std::string& body = kGoldenChain) {
  const std::string scene = "[[body]]\nparticle_mass = 1.0\n" + body + "[[force]]\n" + force +
                            "[run]\nduration = 1.0\nintegrator = { type = \"rk4\", dt = 1e-2 }\n";
  benchmark::RegisterBenchmark((model + "/" + name).c_str(), [scene](benchmark::State& state) {
    SingleForce alone(*parse_scene(scene, "benchmark.toml", registry()), 0);
    evaluate(state, alone);
  });
}

/// Every force there is, alone in the scene of its record's example.
void register_examples() {
  for (const auto& record : registry().forces()) {
    const auto scene = parse_scene(record->example, record->name + ".toml", registry());
    std::size_t index = 0;
    while (scene->forces[index].record != record.get()) ++index;
    benchmark::RegisterBenchmark((record->name + "/alone in its example").c_str(),
                                 [scene, index](benchmark::State& state) {
                                   SingleForce alone(*scene, index);
                                   evaluate(state, alone);
                                 });
  }
}

/// A square cell of 32 x 32 points.
std::string energy_map() {
  std::string rows;
  for (int m = 0; m < 32; ++m) {
    rows += "[";
    for (int n = 0; n < 32; ++n) rows += std::to_string((7 * m + 3 * n) % 11) + ", ";
    rows += "], ";
  }
  return "type = \"lattice_substrate\"\nlattice = \"square\"\nperiod = 1.0\nenergy_scale = "
         "0.01\nenergies = [" +
         rows + "]\n";
}

/// The particles of plain::SplineSurface, and of plain::DryFriction where they move.
const std::string kFlake =
    "type = \"flake\"\nlattice = \"square\"\nlattice_constant = 1.618033988749895\nshape = "
    "\"rectangle\"\nsize = [39, 24]\ncentre = [0.0, 0.0]\n"
    "velocity = [\"0.01 * (i - 5 * floor(i/5))\", 0.01]\n";

void register_forces() {
  register_force("varied_substrate_1000", "tomlin",
                 "type = \"sinusoidal_substrate\"\namplitude = \"0.05 + 0.01 * (i - 7 * "
                 "floor(i/7))\"\nperiod = 1.0\n");
  register_force("energy_map_1000", "tomlin", energy_map(), kFlake);
  register_force("dry_friction_1000", "tomlin",
                 "type = \"coulomb_friction\"\nforce = 0.1\nwidth = 0.01\n", kFlake);
  register_force("substrate_1000", "tomlin",
                 "type = \"sinusoidal_substrate\"\namplitude = 0.05\nperiod = 1.0\n");
  register_force("substrate_1000", "as a formula",
                 "type = \"expression\"\nenergy = \"0.05 * cos(2*pi*x)\"\nperiod = 1.0\n");
  register_force("substrate_1000", "as a formula with disorder",
                 "type = \"expression\"\nenergy = \"0.05 * (1 + 0.1 * normal(7, i)) * "
                 "cos(2*pi*(x + random(3, i)))\"\nperiod = 1.0\n");
  register_force("bonds_1000", "tomlin",
                 "type = \"harmonic_bonds\"\npairs = \"neighbours\"\nstiffness = 1.0\n");
  register_force(
      "bonds_1000", "morse_bonds",
      "type = \"morse_bonds\"\npairs = \"neighbours\"\ndepth = 1.0\ninverse_width = 1.0\n");
  register_force("angles_1000", "as a formula",
                 "type = \"expression\"\nenergy = \"0.5*(theta - pi)^2\"\n", kRing);
  register_force("bonds_1000", "as a formula",
                 "type = \"expression\"\nenergy = \"0.5*(r - 1.6)^2\"\npairs = \"neighbours\"\n");
}

/// Variants that write a table, and a table and a trajectory.
std::vector<Variant> sampled(const std::string& dt) {
  const std::vector<Setting> every = {{"output.every", dt}, {"run.duration", "1e7"}};
  std::vector<Setting> all = every;
  all.push_back({"output.trajectory", "true"});
  return {{"sample every step", every}, {"trajectory every step", all}};
}

/// A variant that measures one quantity, for which nothing is evaluated after steps.
std::vector<Variant> asked_for_one() {
  return {{"mean force only", {{"measure.observables", "[\"driving_spring.mean_force.x\"]"}}}};
}

[[maybe_unused]] const bool registered = [] {
  const std::vector<Variant> blocks_of_64 = {{"tomlin", {}, 64}};
  const std::vector<Variant> blocks_of_16 = {{"tomlin", {}}};
  const std::vector<Variant> single_steps = {{"tomlin", {}, 1}};
  register_variants("pt", kPt, blocks_of_64);
  // The tip slides without slips: the largest force is searched for in every step.
  register_variants("pt", kPt,
                    {{"smooth", {{"force.sinusoidal_substrate.amplitude", "0.02"}}, 64}});
  register_variants("flexible_ring_8", ring("particles", "1e-4"), blocks_of_16);
  register_variants("rigid_ring_8", ring("rigid", "1e-2"), blocks_of_16);
  register_variants("chain_1000", chain("1000", "1.0"), single_steps);
  register_variants("flake_1000", flake(40, 25, 1.618033988749895), single_steps);
  register_variants("golden_chain_1000", chain("1000", kGolden), single_steps);
  register_variants("golden_chain_100000", chain("100000", kGolden), single_steps);
  register_watched();
  register_variants("pt", kPt, asked_for_one());
  register_variants("rigid_ring_8", ring("rigid", "1e-2"), asked_for_one());
  register_variants(
      "rigid_ring_8", ring("rigid", "1e-2"),
      {{"mean force on the ring",
        {{"measure.observables", "[\"sinusoidal_substrate.on.ring.mean_force.x\"]"}}}});
  register_variants("flexible_ring_8", ring("particles", "1e-4"), asked_for_one());
  register_variants("chain_1000", chain("1000", "1.0"), asked_for_one());
  register_variants("pt", kPt, common_variants());
  const std::vector<Variant> symplectic = {{"blanes_moan", scheme("blanes_moan")}};
  register_variants("pt", without_friction(kPt), symplectic);
  register_variants("rigid_ring_8", without_friction(ring("rigid", "1e-2")), symplectic);
  register_variants("chain_1000", without_friction(chain("1000", "1.0")), symplectic);
  register_variants("pt", kPt, sampled("1e-2"));
  register_variants("flexible_ring_8", ring("particles", "1e-4"), sampled("1e-4"));
  register_variants("rigid_ring_8", ring("rigid", "1e-2"), sampled("1e-2"));
  register_variants("chain_1000", chain("1000", "1.0"), sampled("1e-2"));
  register_variants("rigid_ring_8", ring("rigid", "1e-2"), common_variants());
  register_variants(
      "flexible_ring_8", ring("particles", "1e-4"),
      {{"exponential_verlet", scheme("exponential_verlet")}, {"radau9", adaptive("radau9"), 1}});
  register_variants("rigid_ring_8", ring("rigid", "1e-2"),
                    {{"1e9 periods out", {{"body.ring.centre", "[1e9, 1.0]"}}}});
  register_variants("chain_1000", chain("1000", "1.0"), common_variants());
  register_variants(
      "chain_1000", chain("1000", "1.0"),
      {{"closed by a box", {{"box.lengths", "[1000.0]"}, {"box.periodic", "[true]"}}}});
  const std::vector<Variant> plugins = {{"forces of a plugin", {}}};
  register_variants("pt", kPt, plugins, registry_of_plugins());
  register_variants("rigid_ring_8", ring("rigid", "1e-2"), plugins, registry_of_plugins());
  register_variants("chain_1000", chain("1000", "1.0"), plugins, registry_of_plugins());
  register_thermostats("pt", kPt);
  register_thermostats("rigid_ring_8", ring("rigid", "1e-2"));
  register_thermostats("chain_1000", chain("1000", "1.0"));
  register_formulas();
  register_forces();
  register_replicas();
  register_examples();
  return true;
}();

}  // namespace
