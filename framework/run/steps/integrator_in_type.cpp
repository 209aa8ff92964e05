#include "framework/run/steps/integrator_in_type.hpp"

#include <cmath>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/model/plugin_code.hpp"

namespace tomlin {
namespace {

template <class Real>
class MirroredIntegrator : public Integrator<double>, public ModelFollower {
 public:
  MirroredIntegrator(Model& model, const void* description, IntegratorFactory<Real> factory)
      : Integrator<double>(model.system()), model_(model), assembly_(model.plan()) {
    System<Real>& system = assembly_.system();
    system.model = &model;
    system.begin_step = [](void* anchored, double high, double low) {
      static_cast<Model*>(anchored)->anchor(DoubleDouble(high, low));
    };
    scheme_ = something(factory(description, system));
    first_rates_.assign(system.view.rates, 0.0);
    model.follow(this);
  }
  ~MirroredIntegrator() override { model_.follow(nullptr); }

  void declare(StateLayout& layout) override {
    for (const auto& [name, count] : fields()) {
      layout.add_numbers<Real>("stepped." + name, count);
    }
    scheme_->declare(layout);
  }

  void attach(RunState& state) override {
    SystemView<Real>& view = assembly_.system().view;
    view.position = state.numbers<Real>("stepped.position");
    view.velocity = state.numbers<Real>("stepped.velocity");
    view.integrals = state.numbers<Real>("stepped.integrals");
    assembly_.attach_controls(state);
    scheme_->attach(state);
  }

  StepReport step_from(double since, double h, bool dense) override {
    const std::uint64_t before = assembly_.system().evaluations;
    const StepReport report = scheme_->step_from(since, h, dense);
    system_.evaluations += assembly_.system().evaluations - before;
    if (report.fault != StepFault::none) return report;
    show();
    const Real* rates = scheme_->first_rates();
    for (std::size_t k = 0; k < first_rates_.size(); ++k) {
      first_rates_[k] = static_cast<double>(rates[k]);
    }
    return report;
  }

  const double* first_rates() const override { return first_rates_.data(); }

  void finish_dense_from(double since) override {
    const std::uint64_t before = assembly_.system().evaluations;
    scheme_->finish_dense_from(since);
    system_.evaluations += assembly_.system().evaluations - before;
  }

  void interpolate(double theta, double* position, double* velocity,
                   double* integrals) const override {
    scheme_->interpolate(theta, position, velocity, integrals);
  }

  void rebased() override { scheme_->rebased(); }
  void forces_changed() override { scheme_->forces_changed(); }
  std::uint64_t evaluations_ahead() const override { return scheme_->evaluations_ahead(); }
  /// All that has nothing to do with the type of numbers.
  Capabilities<double> capabilities() override {
    const Capabilities<Real> own = scheme_->capabilities();
    return {.error_control = own.error_control, .dense_rates = own.dense_rates};
  }

  void start(const Perturbation* noise, const FinalState* from) override {
    SystemView<Real>& view = assembly_.system().view;
    assembly_.start(view.position, view.velocity, view.integrals, noise, from);
  }

  void write_numbers(FinalState& state) const override { assembly_.write_numbers(state); }

  void begin_step(const DoubleDouble& time) override { assembly_.begin_step(time); }

  void rebase(const Origin& origin) override { assembly_.rebase(origin); }

  void shift_by(const std::array<std::int64_t, 3>& cells) override {
    const std::array<double, 3>& unit = model_.origin().unit;
    SystemView<Real>& view = assembly_.system().view;
    for (const auto& body : assembly_.bodies()) {
      const BodySlot<Real>& slot = body.bound.slot;
      for (int d = 0; d < model_.dimension(); ++d) {
        if (slot.rigid) {
          shift(view.position, slot.centre + d, cells[d], unit[d]);
        } else if (!slot.mapped) {
          for (std::size_t i = 0; i < slot.count; ++i) {
            shift(view.position, slot.offset + d * slot.stride + i, cells[d], unit[d]);
          }
        }
      }
      if (slot.rigid && model_.dimension() == 2) {
        const std::size_t at = slot.centre + kRotation;
        const double ahead =
            static_cast<double>(view.position[at]) - model_.system().view.position[at];
        shift(view.position, at, static_cast<std::int64_t>(std::nearbyint(ahead)), 1.0);
      }
    }
    for (const auto& steered : assembly_.prescribed().steered()) {
      for (int d = 0; d < model_.dimension(); ++d) {
        if (steered.own[d] < 0) continue;
        shift(view.integrals, static_cast<std::size_t>(steered.own[d]), cells[d], unit[d]);
      }
    }
  }

 private:
  struct Field {
    std::string name;
    std::size_t count;
  };
  std::vector<Field> fields() const {
    const SystemView<Real>& view = assembly_.system().view;
    return {{"position", view.dofs}, {"velocity", view.dofs}, {"integrals", view.rates}};
  }

  static void shift(Real* x, std::size_t i, std::int64_t cells, double unit) {
    if (cells == 0) return;
    x[i] = x[i] - Real(static_cast<double>(cells)) * Real(unit);
  }

  /// The model's numbers, from those that are stepped.
  void show() {
    const SystemView<Real>& from = assembly_.system().view;
    const SystemView<double>& to = system_.view;
    show(from.position, from.dofs, to.position);
    show(from.velocity, from.dofs, to.velocity);
    show(from.integrals, from.rates, to.integrals);
  }

  static void show(const Real* x, std::size_t n, double* to) {
    for (std::size_t i = 0; i < n; ++i) to[i] = static_cast<double>(x[i]);
  }

  Model& model_;
  Assembly<Real> assembly_;
  std::unique_ptr<Integrator<Real>> scheme_;
  AlignedVector<double> first_rates_;
};

template <class Real>
std::unique_ptr<Integrator<double>> mirrored(Model& model, const void* description,
                                             const IntegratorRecord& scheme) {
  const auto factory = scheme.bind.in<Real>();
  if (factory == nullptr) {
    const Scene& scene = model.scene();
    throw InputError(
        {Fault(FaultCode::number_type_unsuitable, scene.run.location_of("number_type"),
               "run.number_type", fmt::format("\"{}\"", to_string(scene.run.number_type)),
               "not available with the integrator " + scheme.name, "\"double\"")});
  }
  return std::make_unique<MirroredIntegrator<Real>>(model, description, factory);
}

}  // namespace

std::unique_ptr<Integrator<double>> integrator_in(NumberType number_type, Model& model,
                                                  const void* description,
                                                  const IntegratorRecord& scheme) {
  switch (number_type) {
    case NumberType::double_precision:
      return something(scheme.bind.in_double(description, model.system()));
    case NumberType::quadruple_precision:
      return mirrored<Quad>(model, description, scheme);
  }
  return nullptr;
}

}  // namespace tomlin
