#include "framework/model/plugin_code.hpp"

#include <deque>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "framework/core/numbers/quad.hpp"
#include "framework/core/records/neighbour_count.hpp"

namespace tomlin {

PluginError::PluginError(std::string component, std::string library, std::string said)
    : std::runtime_error(
          fmt::format("the plugin {} has thrown an exception: {}: {}", library, component, said)),
      component_(std::move(component)),
      library_(std::move(library)),
      said_(std::move(said)) {}

namespace {

/// Whose code it is.
struct Owner {
  std::string component;
  std::string library;
  OwnArithmetic::Mode mode = OwnArithmetic::mode();  ///< when the scene is bound

  template <class Action>
  auto guard(Action action) const {
    return in_plugin(component, library, action, mode);
  }
};

/// One kernel call of a plugin, in place of which ours is called.
template <class Real>
struct GuardedPass {
  const Owner* owner = nullptr;
  Kernel<Real> set = nullptr;
  Kernel<Real> add = nullptr;
  const void* arguments = nullptr;
};

template <class Real, Kernel<Real> GuardedPass<Real>::*kernel>
void call(const void* guarded_pass, const Stage<Real>& stage) {
  const auto& pass = *static_cast<const GuardedPass<Real>*>(guarded_pass);
  pass.owner->guard([&] { (pass.*kernel)(pass.arguments, stage); });
}

template <class Real>
struct GuardedPoint {
  const Owner* owner = nullptr;
  PointKernel<Real> run = nullptr;
  const void* parameters = nullptr;
};

template <class Real>
PointResult<Real> call_point(const void* guarded_point, Real position, Real velocity, Real start,
                             Real elapsed) {
  const auto& point = *static_cast<const GuardedPoint<Real>*>(guarded_point);
  return point.owner->guard(
      [&] { return point.run(point.parameters, position, velocity, start, elapsed); });
}

template <class Real>
struct GuardedFlow {
  const Owner* owner = nullptr;
  Flow<Real> flow;
};

template <class Real>
Real call_flow(const void* guarded_flow, const FlowStage<Real>& stage, Real h) {
  const auto& own = *static_cast<const GuardedFlow<Real>*>(guarded_flow);
  return own.owner->guard([&] { return own.flow.run(own.flow.arguments, stage, h); });
}

template <class Real>
Real call_drag(const void* guarded_flow, const Stage<Real>& stage) {
  const auto& own = *static_cast<const GuardedFlow<Real>*>(guarded_flow);
  return own.owner->guard([&] { return own.flow.drag(own.flow.arguments, stage); });
}

/// Every function of BoundForce is passed on.
template <class Real>
class GuardedForce : public BoundForce<Real> {
 public:
  GuardedForce(std::unique_ptr<BoundForce<Real>> force, Owner owner)
      : force_(std::move(force)), owner_(std::move(owner)) {}
  GuardedForce(const GuardedForce&) = delete;
  GuardedForce& operator=(const GuardedForce&) = delete;

  std::vector<Pass<Real>> passes() override {
    std::vector<Pass<Real>> all = guard([&] { return force_->passes(); });
    for (Pass<Real>& pass : all) {
      const GuardedPass<Real>& own = guarded_pass({&owner_, pass.set, pass.add, pass.arguments});
      if (pass.set != nullptr) pass.set = &call<Real, &GuardedPass<Real>::set>;
      if (pass.add != nullptr) pass.add = &call<Real, &GuardedPass<Real>::add>;
      pass.arguments = &own;
      pass.lanes = {};  // guards are of single runs
    }
    return all;
  }
  bool point(PointForce<Real>& point) const override {
    if (!guard([&] { return force_->point(point); })) return false;
    point_ = {&owner_, point.run, point.parameters};
    point.run = &call_point<Real>;
    point.parameters = &point_;
    return true;
  }
  bool heat(std::ptrdiff_t rate, Operation<Real>& operation) override {
    if (!guard([&] { return force_->heat(rate, operation); })) return false;
    const auto& own = guarded_pass({&owner_, operation.run, nullptr, operation.arguments});
    operation = {&call<Real, &GuardedPass<Real>::set>, &own};
    return true;
  }

  std::size_t rate_count() const override {
    return guard([&] { return force_->rate_count(); });
  }
  void place_rates(std::ptrdiff_t first) override {
    guard([&] { force_->place_rates(first); });
  }
  bool depends_on_time() const override {
    return guard([&] { return force_->depends_on_time(); });
  }
  void begin_step(const DoubleDouble& time) override {
    guard([&] { force_->begin_step(time); });
  }
  void rebase(const Origin& origin) override {
    guard([&] { force_->rebase(origin); });
  }
  Real energy(const Stage<Real>& stage) const override {
    return guard([&] { return force_->energy(stage); });
  }
  void hessian(const Stage<Real>& stage, HessianSink& sink) const override {
    guard([&] { force_->hessian(stage, sink); });
  }
  double curvature_bound() const override {
    return guard([&] { return force_->curvature_bound(); });
  }
  double curvature_bound_along(int axis) const override {
    return guard([&] { return force_->curvature_bound_along(axis); });
  }
  const Drive* drive() const override {
    return guard([&] { return force_->drive(); });
  }
  double shortest_bond() const override {
    return guard([&] { return force_->shortest_bond(); });
  }
  std::string bond_beyond_half_box(const Stage<Real>& stage) const override {
    return guard([&] { return force_->bond_beyond_half_box(stage); });
  }
  std::string why_not_finite(const Stage<Real>& stage) const override {
    return guard([&] { return force_->why_not_finite(stage); });
  }
  std::string note() const override {
    return guard([&] { return force_->note(); });
  }
  bool flow(Flow<Real>& flow) override {
    if (!guard([&] { return force_->flow(flow); })) return false;
    flow_ = {&owner_, flow};
    flow = {&call_flow<Real>, flow.drag == nullptr ? nullptr : &call_drag<Real>, &flow_, {}};
    return true;
  }
  bool is_friction() const override {
    return guard([&] { return force_->is_friction(); });
  }
  void friction(FrictionSink& sink) const override {
    guard([&] { force_->friction(sink); });
  }
  double friction_bound() const override {
    return guard([&] { return force_->friction_bound(); });
  }
  std::size_t own_count() const override {
    return guard([&] { return force_->own_count(); });
  }
  void place_own(std::size_t first) override {
    guard([&] { force_->place_own(first); });
  }
  void start_own(Real* own) const override {
    guard([&] { force_->start_own(own); });
  }
  const Passing* waits_for() const override {
    return guard([&] { return force_->waits_for(); });
  }
  std::size_t control_count() const override {
    return guard([&] { return force_->control_count(); });
  }
  void attach_control(double* control) override {
    guard([&] { force_->attach_control(control); });
  }
  void start_control() override {
    guard([&] { force_->start_control(); });
  }
  bool waits() const override {
    return guard([&] { return force_->waits(); });
  }
  void passed(const DoubleDouble& time) override {
    guard([&] { force_->passed(time); });
  }

 protected:
  template <class Action>
  auto guard(Action action) const {
    return owner_.guard(action);
  }

 private:
  /// The same one whenever it is asked for: passes are identified by their arguments.
  const GuardedPass<Real>& guarded_pass(const GuardedPass<Real>& wanted) {
    for (const GuardedPass<Real>& known : passes_) {
      if (known.set == wanted.set && known.add == wanted.add &&
          known.arguments == wanted.arguments) {
        return known;
      }
    }
    return passes_.emplace_back(wanted);
  }

  std::unique_ptr<BoundForce<Real>> force_;
  Owner owner_;
  std::deque<GuardedPass<Real>> passes_;  // kernels hold pointers into it
  mutable GuardedPoint<Real> point_;
  GuardedFlow<Real> flow_;
};

/// One that keeps neighbour lists, too.
template <class Real>
class GuardedForceWithLists final : public GuardedForce<Real>, public CountsNeighbours {
 public:
  GuardedForceWithLists(std::unique_ptr<BoundForce<Real>> force, const CountsNeighbours& lists,
                        Owner owner)
      : GuardedForce<Real>(std::move(force), std::move(owner)), lists_(lists) {}

  NeighbourCount count_neighbours() const override {
    return this->guard([&] { return lists_.count_neighbours(); });
  }

 private:
  const CountsNeighbours& lists_;
};

/// Every function of EquilibriumPath is passed on.
class GuardedPath final : public EquilibriumPath {
 public:
  GuardedPath(EquilibriumPath& path, const Owner& owner) : path_(path), owner_(owner) {}

  StepFault settle(double ahead) override {
    return owner_.guard([&] { return path_.settle(ahead); });
  }
  bool ends() const override {
    return owner_.guard([&] { return path_.ends(); });
  }
  StepFault slip(double since, double ahead) override {
    return owner_.guard([&] { return path_.slip(since, ahead); });
  }
  bool jumped() const override {
    return owner_.guard([&] { return path_.jumped(); });
  }
  std::optional<std::size_t> tied() const override {
    return owner_.guard([&] { return path_.tied(); });
  }
  void disturb(double size, std::uint64_t seed, std::uint64_t stream) override {
    owner_.guard([&] { path_.disturb(size, seed, stream); });
  }
  double moment(std::size_t k, double* position, double* velocity, double* rates) const override {
    return owner_.guard([&] { return path_.moment(k, position, velocity, rates); });
  }
  EquilibriumState state(double since) override {
    return owner_.guard([&] { return path_.state(since); });
  }

 private:
  EquilibriumPath& path_;
  const Owner& owner_;
};

/// Every function of Integrator is passed on.
class GuardedIntegrator final : public Integrator<double> {
 public:
  GuardedIntegrator(std::unique_ptr<Integrator<double>> integrator, System<double>& system,
                    Owner owner)
      : Integrator<double>(system), integrator_(std::move(integrator)), owner_(std::move(owner)) {}
  GuardedIntegrator(const GuardedIntegrator&) = delete;
  GuardedIntegrator& operator=(const GuardedIntegrator&) = delete;

  void declare(StateLayout& layout) override {
    owner_.guard([&] { integrator_->declare(layout); });
  }
  void attach(RunState& state) override {
    owner_.guard([&] { integrator_->attach(state); });
  }
  StepReport step_from(double since, double h, bool dense) override {
    return owner_.guard([&] { return integrator_->step_from(since, h, dense); });
  }
  bool has_point_block() const override {
    return owner_.guard([&] { return integrator_->has_point_block(); });
  }
  std::size_t point_block(std::size_t first, double h, std::size_t most,
                          const PointStarts<double>& starts) override {
    return owner_.guard([&] { return integrator_->point_block(first, h, most, starts); });
  }
  const double* first_rates() const override {
    return owner_.guard([&] { return integrator_->first_rates(); });
  }
  void finish_dense_from(double since) override {
    owner_.guard([&] { integrator_->finish_dense_from(since); });
  }
  void interpolate(double theta, double* position, double* velocity,
                   double* integrals) const override {
    owner_.guard([&] { integrator_->interpolate(theta, position, velocity, integrals); });
  }
  bool between(double theta, double* velocity, double* rates) const override {
    return owner_.guard([&] { return integrator_->between(theta, velocity, rates); });
  }
  void rebased() override {
    owner_.guard([&] { integrator_->rebased(); });
  }
  void forces_changed() override {
    owner_.guard([&] { integrator_->forces_changed(); });
  }
  std::uint64_t evaluations_ahead() const override {
    return owner_.guard([&] { return integrator_->evaluations_ahead(); });
  }
  void put_lane(const LaneLayout& layout, std::size_t lane, RunState& run) override {
    owner_.guard([&] { integrator_->put_lane(layout, lane, run); });
  }
  void get_lane(const LaneLayout& layout, std::size_t lane, RunState& run) const override {
    owner_.guard([&] { integrator_->get_lane(layout, lane, run); });
  }
  bool is_started() const override {
    return owner_.guard([&] { return integrator_->is_started(); });
  }
  void watch(const std::vector<WatchedIntegral>& integrals,
             const std::vector<double>& along) override {
    owner_.guard([&] { integrator_->watch(integrals, along); });
  }
  double rounding_of_works() const override {
    return owner_.guard([&] { return integrator_->rounding_of_works(); });
  }
  EquilibriumPath* path() override {
    EquilibriumPath* const path = owner_.guard([&] { return integrator_->path(); });
    if (path == nullptr) return nullptr;
    return &path_.emplace(*path, owner_);
  }
  std::uint64_t refused_steps() const override {
    return owner_.guard([&] { return integrator_->refused_steps(); });
  }

 private:
  std::unique_ptr<Integrator<double>> integrator_;
  Owner owner_;
  std::optional<GuardedPath> path_;
};

}  // namespace

std::unique_ptr<Integrator<double>> guarded(std::unique_ptr<Integrator<double>> integrator,
                                            System<double>& system, std::string component,
                                            std::string library) {
  return std::make_unique<GuardedIntegrator>(std::move(integrator), system,
                                             Owner{std::move(component), std::move(library)});
}

template <class Real>
std::unique_ptr<BoundForce<Real>> guarded(std::unique_ptr<BoundForce<Real>> force,
                                          std::string component, std::string library) {
  Owner owner{std::move(component), std::move(library)};
  if (const auto* lists = dynamic_cast<const CountsNeighbours*>(force.get())) {
    return std::make_unique<GuardedForceWithLists<Real>>(std::move(force), *lists,
                                                         std::move(owner));
  }
  return std::make_unique<GuardedForce<Real>>(std::move(force), std::move(owner));
}

template <class Real>
PointForce<Real> without_guard(PointForce<Real> point) {
  if (point.run != &call_point<Real>) return point;
  const auto& own = *static_cast<const GuardedPoint<Real>*>(point.parameters);
  point.run = own.run;
  point.parameters = own.parameters;
  return point;
}

template PointForce<double> without_guard(PointForce<double>);
template PointForce<Quad> without_guard(PointForce<Quad>);

template std::unique_ptr<BoundForce<double>> guarded(std::unique_ptr<BoundForce<double>>,
                                                     std::string, std::string);
template std::unique_ptr<BoundForce<Quad>> guarded(std::unique_ptr<BoundForce<Quad>>, std::string,
                                                   std::string);

}  // namespace tomlin
