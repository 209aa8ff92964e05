#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "framework/core/elements/kernel_tables.hpp"
#include "framework/core/elements/nearest_image.hpp"
#include "framework/core/elements/pairs.hpp"
#include "framework/core/formula/formula.hpp"
#include "framework/core/formula/formula_arguments.hpp"
#include "framework/core/numbers/dual.hpp"
#include "framework/core/numbers/inverse_trigonometry.hpp"
#include "framework/core/numbers/number_types.hpp"
#include "framework/core/numbers/sum.hpp"
#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/force.hpp"
#include "framework/core/text/fault_code.hpp"

TOMLIN_DECLARE_TABLES(FormulaKernels, FormulaKernelTable)

/// Bound forces made from formulas: one class per kind of element. The hot loops stand in
/// formula_kernels.hpp; what runs rarely is written here.
namespace tomlin {

/// Code with its numbers in one number type, and the memory that its kernels write.
template <class Real>
class FormulaProgram {
 public:
  explicit FormulaProgram(FormulaCode code) : code_(std::move(code)) {
    uniforms_.assign(code_.uniforms * kGroup, Real(0.0));
    registers_.assign(code_.registers * kFormulaRegister, Real(0.0));
    for (std::size_t k = 0; k < code_.constants.size(); ++k) set(k, Real(code_.constants[k]));
    for (const FormulaInstruction& instruction : code_.prologue) {
      prologue_.push_back(step_of(instruction));
    }
    for (const FormulaInstruction& instruction : code_.body) body_.push_back(step_of(instruction));
    list_patches();
    for (const FormulaSlot& slot : code_.outputs) outputs_.push_back(output_of(slot));
  }
  FormulaProgram(const FormulaProgram&) = delete;
  FormulaProgram& operator=(const FormulaProgram&) = delete;

  bool empty() const { return outputs_.empty(); }
  std::size_t outputs() const { return outputs_.size(); }

  /// Kernels write the registers, what follows from the time and where inputs and outputs are: one
  /// at a time.
  FormulaView<Real> view(const Real& start_of_time, bool in_time) const {
    FormulaView<Real> view;
    view.prologue = prologue_.data();
    view.prologue_length = prologue_.size();
    view.body = body_.data();
    view.body_length = body_.size();
    view.outputs = outputs_.data();
    view.output_count = outputs_.size();
    view.patches = patches_.data();
    view.patch_count = patches_.size();
    if (in_time) view.time = uniforms_.data() + kGroup * code_.index_of_uniform(kTimeUniform);
    view.start_of_time = &start_of_time;
    return view;
  }

  void set_origin(int axis, Real value) {
    set(code_.index_of_uniform(kOriginUniform + static_cast<std::size_t>(axis)), value);
  }

 private:
  Real* at(FormulaSlot slot) const {
    if (slot.area == FormulaSlot::Area::inputs) return nullptr;
    if (slot.area == FormulaSlot::Area::uniforms) return uniforms_.data() + kGroup * slot.index;
    return registers_.data() + slot.index * kFormulaRegister;
  }
  static std::size_t step(FormulaSlot slot) {
    return slot.area == FormulaSlot::Area::uniforms ? 0 : kGroup;
  }
  FormulaStep<Real> step_of(const FormulaInstruction& from) const {
    const auto operand = [&](FormulaSlot slot) {
      return FormulaOperand<Real>{at(slot), step(slot)};
    };
    FormulaStep<Real> made;
    made.op = from.op;
    made.a = operand(from.a);
    if (from.operands > 1) made.b = operand(from.b);
    if (from.operands > 2) made.c = operand(from.c);
    made.to = at(from.to);
    if (from.op == FormulaOp::sine_and_cosine) made.also = at(from.also);
    return made;
  }
  void list_patches() {
    for (std::size_t k = 0; k < body_.size(); ++k) {
      const FormulaInstruction& from = code_.body[k];
      const std::array<FormulaSlot, 3> slots = {from.a, from.b, from.c};
      const std::array<const Real**, 3> at = {&body_[k].a.at, &body_[k].b.at, &body_[k].c.at};
      for (std::size_t operand = 0; operand < from.operands; ++operand) {
        if (slots[operand].area != FormulaSlot::Area::inputs) continue;
        patches_.push_back({at[operand], slots[operand].index});
      }
    }
  }
  /// An output's register may be another one altogether when nothing reads it after the last
  /// instruction that writes it, which makes the output.
  FormulaOutput<Real> output_of(FormulaSlot slot) {
    FormulaOutput<Real> made;
    made.home = at(slot);
    made.operand = {made.home, step(slot)};
    if (slot.area == FormulaSlot::Area::inputs) made.input = slot.index;
    if (slot.area != FormulaSlot::Area::registers) return made;
    if (std::count(code_.outputs.begin(), code_.outputs.end(), slot) > 1) return made;
    for (std::size_t k = code_.body.size(); k-- > 0;) {
      const FormulaInstruction& from = code_.body[k];
      const bool paired = from.op == FormulaOp::sine_and_cosine;
      if (from.to == slot && !paired) made.writes_to = &body_[k].to;
      if (from.to == slot || (paired && from.also == slot)) return made;
      if (from.a == slot || (from.operands > 1 && from.b == slot) ||
          (from.operands > 2 && from.c == slot)) {
        return made;
      }
    }
    return made;
  }
  void set(std::size_t uniform, Real value) {
    for (std::size_t k = 0; k < kGroup; ++k) uniforms_[kGroup * uniform + k] = value;
  }

  FormulaCode code_;
  mutable AlignedVector<Real> uniforms_;
  mutable AlignedVector<Real> registers_;
  std::vector<FormulaStep<Real>> prologue_;
  std::vector<FormulaStep<Real>> body_;
  std::vector<FormulaPatch<Real>> patches_;
  std::vector<FormulaOutput<Real>> outputs_;
};

/// Complaint about a number of a particle.
inline Complaint complaint_about(const FormulaLaw& law, const FormulaLaw::Trouble& trouble) {
  Complaint complaint;
  complaint.code = FaultCode::expression_not_finite;
  complaint.key = law.has_energy() ? "energy" : "force";
  complaint.index = trouble.component;
  complaint.column = trouble.column;
  complaint.why = trouble.why;
  return complaint;
}

/// Common parts of all kinds: the programs, the time, the origin, and why a value is not finite.
template <class Real>
class FormulaForce : public BoundForce<Real>, public Curvature<Real>, public Diagnosis<Real> {
 public:
  static constexpr std::size_t kMostOutputs = 8;
  static constexpr int kThorough = 64;
  /// Periods to either side over which a declared one is tried: about the first element, and
  /// others.
  static constexpr int kManyPeriods = 100;
  static constexpr int kFewPeriods = 2;
  using Outputs = std::array<Real, kMostOutputs>;
  using Inputs = std::array<Real, kMostFormulaInputs>;
  static_assert(kMostFormulaAxes + FormulaLaw::kMostParticleNumbers <= kMostFormulaInputs);

  /// `period` of each axis, 0 where none is declared.
  FormulaForce(const FormulaLaw& law, const Binding<Real>& binding,
               const std::array<double, 3>& period)
      : law_(law),
        count_(binding.bodies.front()->slot.count),
        codes_(law.compiled(binding.dimension, moving_axes(binding), count_)),
        kernels_(kernels::FormulaKernels.on<Real>(binding.set)),
        dimension_(binding.dimension),
        period_(period),
        force_(codes_.force),
        energy_(codes_.energy),
        curvature_(codes_.curvature),
        power_(codes_.power) {
    FormulaForce::rebase(binding.origin);
    number_particles(binding.bodies.front()->slot.stride);
  }
  FormulaForce(const FormulaForce&) = delete;

  bool depends_on_time() const override { return law_.depends_on_time(); }
  void begin_step(const DoubleDouble& time) override {
    start_of_time_ = from_double_double<Real>(time);
  }

  /// With a period, positions are counted from a position where the formula is as at the scene's
  /// zero: exact however far away the origin is.
  void rebase(const Origin& origin) override {
    for (int axis = 0; axis < dimension_; ++axis) {
      if (!(origin.unit[axis] > 0.0)) continue;
      const DoubleDouble position =
          DoubleDouble(static_cast<double>(origin.cells[axis])) * DoubleDouble(origin.unit[axis]);
      std::int64_t periods = 0;
      base_[axis] = period_[axis] > 0.0 ? Real(remainder_of(position, period_[axis], periods))
                                        : from_double_double<Real>(position);
      for (FormulaProgram<Real>* program : {&force_, &energy_, &curvature_, &power_}) {
        if (!program->empty()) program->set_origin(axis, base_[axis]);
      }
    }
  }

  std::string why_not_finite(const Stage<Real>& stage) const override {
    const auto complaint = first_trouble(&stage);
    return complaint ? complaint->why : std::string();
  }

  /// At the start of the run; throws BindError where the formula is not defined there.
  void check_start() {
    begin_step(DoubleDouble(0.0));
    thorough_ = kThorough;
    const auto complaint = first_trouble(nullptr);
    thorough_ = 0;
    if (complaint) throw BindError(*complaint);
  }

 protected:
  /// The first element that has no finite force or energy, at a stage or (null) at the start.
  virtual std::optional<Complaint> first_trouble(const Stage<Real>* stage) const = 0;

  /// Whether the formula is finite for these inputs; else what to say about it. `of` names the
  /// element, `particle` is its index where the formula is one of particles.
  std::optional<Complaint> trouble(const Inputs& inputs, Real elapsed, const std::string& of,
                                   std::size_t particle = 0) const {
    const bool numbers =
        finite(force_, inputs, elapsed) && (energy_.empty() || finite(energy_, inputs, elapsed));
    if (numbers && thorough_ == 0) return std::nullopt;
    FormulaLaw::Values at{};
    at[formula_variable::index] = static_cast<double>(particle);
    at[formula_variable::count] = static_cast<double>(count_);
    std::string positions;
    for (std::size_t k = 0; k < coordinates(); ++k) {
      const std::uint32_t index = codes_.inputs[k];
      double value = static_cast<double>(inputs[k]);
      const bool is_position =
          index < formula_variable::velocity ||
          (index >= formula_variable::centre && index < formula_variable::distance);
      if (is_position) value += static_cast<double>(base_[index % 3]);
      at[index] = value;
      positions += fmt::format("{}{} = {:.6g}", positions.empty() ? "" : ", ",
                               formula_variable_name(index), value);
    }
    at[formula_variable::time] = static_cast<double>(start_of_time_ + elapsed);
    if (law_.depends_on_time()) {
      positions +=
          fmt::format("{}t = {:.6g}", positions.empty() ? "" : ", ", at[formula_variable::time]);
    }
    if (numbers) {
      // Parts that were simplified away, 0/0 say, are evaluated as they are written.
      --thorough_;
      bool all = true;
      for (std::size_t k = 0; k < law_.components(); ++k) {
        all = all && law_.evaluate(k, at).index() == 0;
      }
      if (all) {
        const bool first = thorough_ + 1 == kThorough;
        return no_period(at, first ? kManyPeriods : kFewPeriods);
      }
    }
    const auto found = law_.trouble_at(at);
    Complaint complaint;
    complaint.code = FaultCode::expression_not_finite;
    complaint.key = law_.has_energy() ? "energy" : "force";
    complaint.index = found ? found->component : 0;
    if (found) complaint.column = found->column;
    complaint.why =
        fmt::format("\"{}\"{} has no finite value for {}, where {}: {}", law_.text(complaint.index),
                    found ? fmt::format(", column {},", found->column + 1) : std::string(), of,
                    positions, found ? found->why : std::string("its numbers overflow"));
    return complaint;
  }

  /// Complaint about a declared period that is none about this position.
  std::optional<Complaint> no_period(const FormulaLaw::Values& about, int periods) const {
    for (const std::uint32_t index : codes_.inputs) {
      const bool is_position =
          index < formula_variable::velocity || index >= formula_variable::centre;
      if (!is_position || index >= formula_variable::distance || !(period_[index % 3] > 0.0))
        continue;
      Complaint complaint;
      complaint.key = "period";
      complaint.why = law_.why_no_period(about, index, period_[index % 3], periods);
      complaint.admissible = "the period of the formula, or no period";
      if (!complaint.why.empty()) return complaint;
    }
    return std::nullopt;
  }

  /// The sum of an energy over all elements. A kernel of heats adds up what the only output of its
  /// code takes out, whatever the code computes.
  template <class Arguments>
  Real energy_by(Kernel<Real> kernel, Arguments arguments, const Stage<Real>& stage) const {
    Real taken(0.0);
    Stage<Real> here = stage;
    here.rates = &taken;
    arguments.rate = 0;
    kernel(&arguments, here);
    return Real(0.0) - taken;
  }

  FormulaView<Real> view(const FormulaProgram<Real>& program) const {
    return program.view(start_of_time_, law_.depends_on_time());
  }

  /// The position of a particle along an axis, at a stage or (null) at the start.
  static Real coordinate(const Stage<Real>* stage, const BoundBody<Real>& body,
                         std::size_t particle, std::size_t axis) {
    if (stage == nullptr) return Real(body.start[particle][axis]);
    const BodySlot<Real>& slot = body.slot;
    return (slot.mapped ? stage->mapped_position
                        : stage->position)[slot.offset + axis * slot.stride + particle];
  }

  /// Complaint about elements for which the formula's force is not defined.
  static Complaint undefined(std::string why) {
    return {.key = "energy", .why = std::move(why), .code = FaultCode::component_unsuitable};
  }

  /// The first inputs: positions, velocities, distances or angles. Numbers of particles follow.
  std::size_t coordinates() const { return codes_.inputs.size() - law_.particle_numbers(); }

  Outputs evaluate(const FormulaProgram<Real>& program, const Inputs& inputs, Real elapsed) const {
    Outputs outputs{};
    kernels_.evaluate(view(program), inputs.data(), codes_.inputs.size(), elapsed, outputs.data());
    return outputs;
  }

  const FormulaLaw law_;
  const std::size_t count_;  ///< of particles
  const FormulaCodes codes_;
  const FormulaKernelTable<Real>& kernels_;
  const int dimension_;
  const std::array<double, 3> period_;
  FormulaProgram<Real> force_;
  FormulaProgram<Real> energy_;
  FormulaProgram<Real> curvature_;
  FormulaProgram<Real> power_;
  Real start_of_time_{};
  std::array<Real, 3> base_{};
  AlignedVector<Real> number_;  ///< [number * stride + particle]; the last one's in the padding
  mutable int thorough_ = 0;  ///< elements that are still to be looked at as the formula is written

 private:
  void number_particles(std::size_t stride) {
    const auto found = law_.numbers_of_particles(count_);
    if (const auto* trouble = std::get_if<FormulaLaw::Trouble>(&found)) {
      throw BindError(complaint_about(law_, *trouble));
    }
    const auto& numbers = std::get<FormulaLaw::ParticleNumbers>(found);
    number_.reserve(numbers.size() * stride);
    for (const std::vector<double>& number : numbers) {
      for (std::size_t i = 0; i < stride; ++i) {
        number_.push_back(Real(number[std::min(i, count_ - 1)]));
      }
    }
  }

  static std::array<bool, 3> moving_axes(const Binding<Real>& binding) {
    std::array<bool, 3> moves{};
    for (std::size_t axis = 0; axis < 3; ++axis) moves[axis] = binding.origin.unit[axis] > 0.0;
    return moves;
  }

  bool finite(const FormulaProgram<Real>& program, const Inputs& inputs, Real elapsed) const {
    const Outputs outputs = evaluate(program, inputs, elapsed);
    for (std::size_t k = 0; k < program.outputs(); ++k) {
      if (!(outputs[k] - outputs[k] == Real(0.0))) return false;
    }
    return true;
  }
};

/// The upper triangle of a matrix of second derivatives, by rows, to a sink.
template <class Real, class Use>
void for_upper_triangle(const typename FormulaForce<Real>::Outputs& entries, int dimension,
                        Use&& use) {
  std::size_t k = 0;
  for (int a = 0; a < dimension; ++a) {
    for (int b = a; b < dimension; ++b, ++k) {
      use(a, b, static_cast<double>(entries[k]));
      if (a != b) use(b, a, static_cast<double>(entries[k]));
    }
  }
}

/// On every particle of a body: an energy over x, y, z and t, or a force over vx, vy, vz too.
template <class Real>
class ParticleFormula final : public FormulaForce<Real> {
  using Base = FormulaForce<Real>;
  using Inputs = typename Base::Inputs;

 public:
  ParticleFormula(const FormulaLaw& law, const Binding<Real>& binding,
                  const std::array<double, 3>& period)
      : Base(law, binding, period), body_(*binding.bodies.front()) {
    arguments_ = arguments_for(this->force_);
    heat_ = arguments_for(law.has_energy() ? this->power_ : this->force_);
    heat_.heat_is_power = !law.has_energy();
    sample_curvature();
  }

  std::vector<Pass<Real>> passes() override {
    Pass<Real> pass = {this->kernels_.site.set[0],
                       this->kernels_.site.add[0],
                       &arguments_,
                       {{body_.index, false}},
                       kRankTranscendental};
    if (this->dimension_ == 1 && body_.slot.count == 1) {
      pass.point = {this->kernels_.point, &arguments_};
    }
    return {pass};
  }

  Real energy(const Stage<Real>& stage) const override {
    if (this->energy_.empty()) return Real(0.0);
    return this->energy_by(this->kernels_.site_heat, arguments_for(this->energy_), stage);
  }

  void hessian(const Stage<Real>& stage, HessianSink& sink) const override {
    if (this->curvature_.empty()) return;
    for (std::size_t i = 0; i < body_.slot.count; ++i) {
      const auto entries = this->evaluate(this->curvature_, inputs_at(&stage, i), stage.elapsed);
      for_upper_triangle<Real>(entries, this->dimension_, [&](int a, int b, double value) {
        sink.site(body_.index, i, a, b, value);
      });
    }
  }

  double curvature_bound() const override {
    sample_curvature();
    return largest_curvature_;
  }
  double curvature_bound_along(int axis) const override {
    return curvature_bound() < 0.0 ? -1.0 : curvature_along_[static_cast<std::size_t>(axis)];
  }

  bool heat(std::ptrdiff_t rate, Operation<Real>& operation) override {
    if (this->law_.has_energy() && this->power_.empty()) return false;
    heat_.rate = rate;
    operation = {this->kernels_.site_heat, &heat_};
    return true;
  }

 protected:
  std::optional<Complaint> first_trouble(const Stage<Real>* stage) const override {
    const Real elapsed = stage ? stage->elapsed : Real(0.0);
    for (std::size_t i = 0; i < body_.slot.count; ++i) {
      auto complaint = this->trouble(inputs_at(stage, i), elapsed,
                                     fmt::format("particle {} of \"{}\"", i, body_.name), i);
      if (complaint) return complaint;
    }
    return std::nullopt;
  }

 private:
  /// Positions along each period at which the curvature is looked at first, and steps of the search
  /// about the largest.
  static constexpr int kSamples = 64;
  static constexpr int kSearch = 40;
  /// Heights beside those of the start, in periods, for a formula that depends on more than x.
  static constexpr std::size_t kHeights = 5;
  static constexpr double kHeight[kHeights] = {0.0, -0.25, 0.25, -0.5, 0.5};
  /// Margins for positions that lie between, and for rounding alone.
  static constexpr double kElsewhere = 1.02;
  static constexpr double kRounding = 1.0 + 1e-12;
  /// If particles differ, only those near the largest curvature are searched: kSamples positions
  /// along a wave miss its largest curvature by 0.1 % n^2 for the n-th harmonic.
  static constexpr double kWorthwhile = 0.8;

  FormulaSiteArguments<Real> arguments_for(const FormulaProgram<Real>& program) const {
    FormulaSiteArguments<Real> arguments;
    if (!program.empty()) arguments.code = this->view(program);
    arguments.body = body_.slot;
    arguments.dimension = this->dimension_;
    arguments.axes = this->coordinates();
    for (std::size_t k = 0; k < arguments.axes; ++k) {
      arguments.axis[k] = static_cast<int>(this->codes_.inputs[k]);
    }
    arguments.numbers = this->law_.particle_numbers();
    arguments.number = this->number_.data();
    return arguments;
  }

  Inputs inputs_at(const Stage<Real>* stage, std::size_t i) const {
    Inputs inputs{};
    const BodySlot<Real>& slot = body_.slot;
    for (std::size_t k = 0; k < this->law_.particle_numbers(); ++k) {
      inputs[this->coordinates() + k] = this->number_[k * slot.stride + i];
    }
    for (std::size_t k = 0; k < this->coordinates(); ++k) {
      const std::uint32_t index = this->codes_.inputs[k];
      const std::size_t axis = index % 3;
      if (stage == nullptr) {
        inputs[k] = Real(index < formula_variable::velocity ? body_.start[i][axis] : 0.0);
        continue;
      }
      const std::size_t at = slot.offset + axis * slot.stride + i;
      if (index < formula_variable::velocity) {
        inputs[k] = (slot.mapped ? stage->mapped_position : stage->position)[at];
      } else {
        inputs[k] = (slot.mapped ? stage->mapped_velocity : stage->velocity)[at];
      }
    }
    return inputs;
  }

  /// Samples the largest curvature over a declared period along x, at the heights of the
  /// start. That of a formula in time is the one at the start of the present step.
  void sample_curvature() const {
    // Who asks is the model, which looks on in double whatever a run computes in.
    if (!std::is_same_v<Real, double>) return;
    if (this->curvature_.empty() || !(this->period_[0] > 0.0)) return;
    if (largest_curvature_ >= 0.0 && sampled_at_ == this->start_of_time_) return;
    sampled_at_ = this->start_of_time_;
    largest_curvature_ = -1.0;
    curvature_along_ = {};
    const bool elsewhere = this->coordinates() > 1;
    const bool differs = this->law_.depends_on_particle();
    const std::size_t most_rows = differs ? body_.slot.count : kSamples;
    const std::size_t rows = elsewhere || differs ? std::min(body_.slot.count, most_rows) : 1;
    const double apart = this->period_[0] / kSamples;
    margin_ = elsewhere ? kElsewhere : kRounding;
    for (std::size_t row = 0; row < rows * (elsewhere ? kHeights : 1); ++row) {
      const std::size_t i = row % rows;
      aside_ = apart * kSamples * kHeight[row / rows];
      double most = -1.0;
      double peak = 0.0;
      for (int k = 0; k < kSamples; ++k) {
        const double here = curvature_at(i, k * apart);
        if (here <= most) continue;
        most = here;
        peak = k * apart;
      }
      if (differs && most < kWorthwhile * largest_curvature_) continue;
      // By thirds: between the neighbours of the largest there is one hill.
      double low = peak - apart;
      double high = peak + apart;
      for (int k = 0; k < kSearch; ++k) {
        const double third = (high - low) / 3.0;
        if (curvature_at(i, low + third) < curvature_at(i, high - third)) {
          low += third;
        } else {
          high -= third;
        }
      }
    }
  }

  /// Curvature of particle i, moved along x to a position; notes the largest so far.
  double curvature_at(std::size_t i, double x) const {
    Inputs inputs = inputs_at(nullptr, i);
    for (std::size_t input = 0; input < this->coordinates(); ++input) {
      if (this->codes_.inputs[input] == formula_variable::position) {
        inputs[input] = Real(x);
      } else {
        inputs[input] = inputs[input] + Real(aside_);
      }
    }
    return note_curvature(this->evaluate(this->curvature_, inputs, Real(0.0)));
  }

  /// The largest sum of a row: no eigenvalue is beyond it.
  double note_curvature(const typename Base::Outputs& entries) const {
    std::array<double, 3> row{};
    std::array<double, 3> diagonal{};
    for_upper_triangle<Real>(entries, this->dimension_, [&](int a, int b, double value) {
      row[static_cast<std::size_t>(a)] += std::abs(value);
      if (a == b) diagonal[static_cast<std::size_t>(a)] = std::abs(value);
    });
    double most = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      if (!std::isfinite(row[a])) continue;
      most = std::max(most, row[a]);
      largest_curvature_ = std::max(largest_curvature_, margin_ * row[a]);
      curvature_along_[a] = std::max(curvature_along_[a], margin_ * diagonal[a]);
    }
    return most;
  }

  BoundBody<Real> body_;
  FormulaSiteArguments<Real> arguments_;
  FormulaSiteArguments<Real> heat_;
  mutable Real sampled_at_{};
  mutable double margin_ = kRounding;
  mutable double aside_ = 0.0;
  mutable double largest_curvature_ = -1.0;
  mutable std::array<double, 3> curvature_along_{};
};

/// On the centre of mass of a body: an energy over xc, yc, zc and t.
template <class Real>
class CentreFormula final : public FormulaForce<Real> {
  using Base = FormulaForce<Real>;
  using Inputs = typename Base::Inputs;

 public:
  CentreFormula(const FormulaLaw& law, const Binding<Real>& binding,
                const std::array<double, 3>& period)
      : Base(law, binding, period), body_(*binding.bodies.front()) {
    const BodySlot<Real>& slot = body_.slot;
    weight_.assign(padded(slot.count), Real(0.0));
    for (std::size_t i = 0; i < weight_.size(); ++i) {
      weight_[i] = slot.share[i];
      weight_in_double_.push_back(static_cast<double>(slot.share[i]));
    }
    arguments_.centre.body = slot;
    arguments_.centre.on_coordinates = slot.rigid;
    arguments_.centre.single = slot.count == 1;
    arguments_.centre.last = weight_.size();
    arguments_.centre.weight = weight_.data();
    arguments_.dimension = this->dimension_;
    arguments_.inputs = this->codes_.inputs.size();
    for (std::size_t k = 0; k < arguments_.inputs; ++k) {
      arguments_.axis[k] = static_cast<int>(this->codes_.inputs[k] - formula_variable::centre);
    }
    heat_ = arguments_;
    arguments_.code = this->view(this->force_);
    if (!this->power_.empty()) heat_.code = this->view(this->power_);
  }

  std::vector<Pass<Real>> passes() override {
    return {{this->kernels_.centre.set[this->dimension_ - 1],
             this->kernels_.centre.add[this->dimension_ - 1],
             &arguments_,
             {{body_.index, arguments_.centre.on_coordinates}},
             kRankTranscendental}};
  }

  Real energy(const Stage<Real>& stage) const override {
    return this->evaluate(this->energy_, inputs_at(&stage), stage.elapsed)[0];
  }

  void hessian(const Stage<Real>& stage, HessianSink& sink) const override {
    const auto entries = this->evaluate(this->curvature_, inputs_at(&stage), stage.elapsed);
    for_upper_triangle<Real>(entries, this->dimension_, [&](int a, int b, double value) {
      sink.centre(body_.index, weight_in_double_.data(), a, b, value);
    });
  }

  bool heat(std::ptrdiff_t rate, Operation<Real>& operation) override {
    if (this->power_.empty()) return false;
    heat_.centre.rate = rate;
    operation = {this->kernels_.centre_heat[this->dimension_ - 1], &heat_};
    return true;
  }

 protected:
  std::optional<Complaint> first_trouble(const Stage<Real>* stage) const override {
    return this->trouble(inputs_at(stage), stage ? stage->elapsed : Real(0.0),
                         fmt::format("the centre of mass of \"{}\"", body_.name));
  }

 private:
  Inputs inputs_at(const Stage<Real>* stage) const {
    Inputs inputs{};
    const BodySlot<Real>& slot = body_.slot;
    for (std::size_t k = 0; k < arguments_.inputs; ++k) {
      const auto axis = static_cast<std::size_t>(arguments_.axis[k]);
      if (stage == nullptr) {
        inputs[k] = Real(body_.start_centre[axis]);
      } else if (slot.rigid) {
        inputs[k] = stage->position[slot.centre + axis];
      } else {
        InterleavedSum<Real> mean;
        const Real* x = (slot.mapped ? stage->mapped_position : stage->position) + slot.offset;
        for (std::size_t i = 0; i < slot.count; ++i) {
          mean.add(i, weight_[i] * x[axis * slot.stride + i]);
        }
        inputs[k] = mean.total();
      }
    }
    return inputs;
  }

  BoundBody<Real> body_;
  AlignedVector<Real> weight_;
  std::vector<double> weight_in_double_;
  FormulaCentreArguments<Real> arguments_;
  FormulaCentreArguments<Real> heat_;
};

/// On pairs within a body or between two: an energy over r and t.
template <class Real>
class PairFormula final : public FormulaForce<Real> {
  using Base = FormulaForce<Real>;
  using Inputs = typename Base::Inputs;

 public:
  PairFormula(const FormulaLaw& law, const Binding<Real>& binding, const PairSelection& selection)
      : Base(law, binding, {}),
        body_(*binding.bodies.front()),
        other_(*binding.bodies.back()),
        box_(binding.box) {
    BoundPairs<Real> bound = pairs_of(selection, binding);
    pairs_ = std::move(bound.pairs);
    if (pairs_.empty()) return;
    build_pairs(bound.topology);
    heat_ = arguments_;
    arguments_.code = this->view(this->force_);
    if (!this->power_.empty()) heat_.code = this->view(this->power_);
    if (other_.index != body_.index) return;
    for (const BoundPair<Real>& pair : pairs_) {
      const auto apart = static_cast<double>(distance_of(separation(nullptr, pair)));
      if (apart > 0.0 && (shortest_ == 0.0 || apart < shortest_)) shortest_ = apart;
    }
  }

  std::vector<Pass<Real>> passes() override {
    if (pairs_.empty()) return {};
    std::vector<Region> writes = {{body_.index, false}};
    if (other_.index != body_.index) writes.push_back({other_.index, false});
    return {{nullptr, this->kernels_.pairs, &arguments_, writes, kRankPairs}};
  }

  Real energy(const Stage<Real>& stage) const override {
    if (pairs_.empty()) return Real(0.0);
    FormulaPairArguments<Real> all = arguments_;
    all.code = this->view(this->energy_);
    return this->energy_by(this->kernels_.pair_heat, all, stage);
  }

  /// V'' along the pair, V'/r across it.
  void hessian(const Stage<Real>& stage, HessianSink& sink) const override {
    for (const BoundPair<Real>& pair : pairs_) {
      const auto way = separation(&stage, pair);
      const Real r = distance_of(way);
      const auto slopes = this->evaluate(this->curvature_, {r}, stage.elapsed);
      const auto along = static_cast<double>(slopes[1]);
      const bool together = r == Real(0.0) && slopes[0] == Real(0.0);
      const double across = together ? along : static_cast<double>(slopes[0] / r);
      for (int a = 0; a < this->dimension_; ++a) {
        for (int b = 0; b < this->dimension_; ++b) {
          const double both = together ? 0.0 : static_cast<double>(way[a] * way[b] / (r * r));
          const double value =
              this->dimension_ == 1 ? along : along * both + across * ((a == b ? 1.0 : 0.0) - both);
          sink.pair(body_.index, pair.i, other_.index, pair.j, a, b, value);
        }
      }
    }
  }

  /// Shortest distance of pairs of one body at the start.
  double shortest_bond() const override { return shortest_; }

  bool heat(std::ptrdiff_t rate, Operation<Real>& operation) override {
    if (this->power_.empty() || pairs_.empty()) return false;
    heat_.rate = rate;
    operation = {this->kernels_.pair_heat, &heat_};
    return true;
  }

 protected:
  std::optional<Complaint> first_trouble(const Stage<Real>* stage) const override {
    const Real elapsed = stage ? stage->elapsed : Real(0.0);
    for (const BoundPair<Real>& pair : pairs_) {
      const Real r = distance_of(separation(stage, pair));
      const std::string of = name_of_pair(body_, pair.i, other_, pair.j);
      auto complaint = this->trouble({r}, elapsed, of);
      if (complaint) return complaint;
      if (r == Real(0.0) && this->evaluate(this->force_, {r}, elapsed)[0] != Real(0.0)) {
        return this->undefined(of + " coincide, and the force between them has no direction");
      }
    }
    return std::nullopt;
  }

 private:
  void build_pairs(PairTopology topology) {
    arguments_.dimension = this->dimension_;
    if (topology != PairTopology::chain) {
      list_.lay(body_, other_, this->dimension_, pairs_, box_);
      arguments_.list = list_.arguments;
      return;
    }
    arguments_.chain = true;
    arguments_.list.first = arguments_.list.second = body_.slot;
    arguments_.list.pairs = pairs_.size();
    arguments_.closed = pairs_.size() == body_.slot.count;
    if (arguments_.closed) {
      for (int d = 0; d < this->dimension_; ++d) {
        arguments_.wrap[d] = Real(pairs_.back().image[static_cast<std::size_t>(d)]);
      }
    }
    arguments_.result_stride = padded(body_.slot.count) + 2 * kGroup;
    result_.assign(static_cast<std::size_t>(this->dimension_) * arguments_.result_stride,
                   Real(0.0));
    arguments_.result = result_.data();
  }

  Vec<Real, 3> separation(const Stage<Real>* stage, const BoundPair<Real>& pair) const {
    Vec<Real, 3> way;
    for (int d = 0; d < 3; ++d) way[d] = Real(0.0);
    for (int d = 0; d < this->dimension_; ++d) {
      const auto axis = static_cast<std::size_t>(d);
      way[d] = this->coordinate(stage, other_, pair.j, axis) -
               this->coordinate(stage, body_, pair.i, axis);
      if (arguments_.chain) {
        way[d] = way[d] + Real(pair.image[axis]);
      } else if (box_[axis] > 0.0) {
        way[d] = nearest_image(way[d], Real(box_[axis]));
      }
    }
    return way;
  }

  Real distance_of(const Vec<Real, 3>& way) const {
    return this->dimension_ == 1 ? abs(way[0]) : sqrt(norm_squared(way));
  }

  BoundBody<Real> body_;
  BoundBody<Real> other_;
  std::array<double, 3> box_;
  std::vector<BoundPair<Real>> pairs_;
  PairList<Real> list_;
  AlignedVector<Real> result_;
  FormulaPairArguments<Real> arguments_;
  FormulaPairArguments<Real> heat_;
  double shortest_ = 0.0;
};

/// On angles between two bonds of a body: an energy over theta and t.
template <class Real>
class AngleFormula final : public FormulaForce<Real> {
  using Base = FormulaForce<Real>;
  using Inputs = typename Base::Inputs;

 public:
  AngleFormula(const FormulaLaw& law, const Binding<Real>& binding, const AngleSelection& selection)
      : Base(law, binding, {}), body_(*binding.bodies.front()), box_(binding.box) {
    build_angles(selection);
    if (angles_.empty()) return;
    build_images();
    assign_rows();
    arguments_.body = body_.slot;
    arguments_.angles = angles_.size();
    arguments_.dimension = this->dimension_;
    heat_ = arguments_;
    arguments_.code = this->view(this->force_);
    if (!this->power_.empty()) heat_.code = this->view(this->power_);
  }

  std::vector<Pass<Real>> passes() override {
    if (angles_.empty()) return {};
    return {{nullptr, this->kernels_.angles, &arguments_, {{body_.index, false}}, kRankPairs}};
  }

  Real energy(const Stage<Real>& stage) const override {
    if (angles_.empty()) return Real(0.0);
    FormulaAngleArguments<Real> all = arguments_;
    all.code = this->view(this->energy_);
    return this->energy_by(this->kernels_.angle_heat, all, stage);
  }

  /// With c = cos(theta): V_c d2c + (V'' - V' cot(theta)) dtheta dtheta, V_c = -V'/sin(theta). The
  /// second part vanishes for straight bonds, where V_c is V'' (theta = pi) or -V'' (0).
  void hessian(const Stage<Real>& stage, HessianSink& sink) const override {
    for (std::size_t k = 0; k < angles_.size(); ++k) {
      const Bonds bond = bonds(&stage, k);
      const auto slopes = this->evaluate(this->curvature_, {angle_of(bond)}, stage.elapsed);
      add_curvature(k, bond, static_cast<double>(slopes[0]), static_cast<double>(slopes[1]), sink);
    }
  }

  bool heat(std::ptrdiff_t rate, Operation<Real>& operation) override {
    if (this->power_.empty() || angles_.empty()) return false;
    heat_.rate = rate;
    operation = {this->kernels_.angle_heat, &heat_};
    return true;
  }

 protected:
  std::optional<Complaint> first_trouble(const Stage<Real>* stage) const override {
    const Real elapsed = stage ? stage->elapsed : Real(0.0);
    for (std::size_t k = 0; k < angles_.size(); ++k) {
      const auto& [first, middle, last] = angles_[k];
      const std::string of =
          fmt::format("particles {}, {} and {} of \"{}\"", first, middle, last, body_.name);
      const Bonds bond = bonds(stage, k);
      auto complaint = this->trouble({angle_of(bond)}, elapsed, of);
      if (complaint) return complaint;
      for (std::size_t side = 0; side < 2; ++side) {
        const auto& way = bond[side];
        if (way[0] * way[0] + way[1] * way[1] + way[2] * way[2] > Real(0.0)) continue;
        return this->undefined(of + " define no angle: two of them coincide");
      }
      const bool straight = cross_of(bond) == Real(0.0);
      if (straight && this->evaluate(this->force_, {angle_of(bond)}, elapsed)[0] != Real(0.0)) {
        return this->undefined(
            of +
            " are collinear, where the derivative of the energy is not zero: the direction "
            "of bending is undefined");
      }
    }
    return std::nullopt;
  }

 private:
  using Bonds = std::array<std::array<Real, 3>, 2>;  ///< from the middle to the first and the last
  static constexpr int kDirections = 6;              ///< three of each bond
  using Slope = Dual<double, kDirections>;
  using Curved = Dual<Slope, kDirections>;

  void build_angles(const AngleSelection& selection) {
    const std::size_t n = body_.slot.count;
    if (!selection.neighbours) {
      for (const auto& [first, middle, last] : selection.list) {
        angles_.push_back({static_cast<std::size_t>(first), static_cast<std::size_t>(middle),
                           static_cast<std::size_t>(last)});
      }
      return;
    }
    if (body_.neighbours) {
      angles_ = angles_between(body_.neighbours(), n);
      return;
    }
    const bool through_box = body_.open_along >= 0 && box_[body_.open_along] > 0.0;
    const bool closed = (body_.closed || through_box) && n > 2;
    for (std::size_t i = 0; i < n; ++i) {
      if (!closed && (i == 0 || i + 1 == n)) continue;
      angles_.push_back({(i + n - 1) % n, i, (i + 1) % n});
    }
  }

  /// Bonds through a periodic box are those of the nearest images at the start.
  void build_images() {
    const std::size_t length = padded(angles_.size());
    const auto axes = static_cast<std::size_t>(this->dimension_);
    image_.assign(2 * axes * length, Real(0.0));
    bool imaged = false;
    for (std::size_t side = 0; side < 2; ++side) {
      for (std::size_t d = 0; d < axes; ++d) {
        if (!(box_[d] > 0.0)) continue;
        for (std::size_t k = 0; k < length; ++k) {
          const IndexTriple& angle = angles_[std::min(k, angles_.size() - 1)];
          const double apart = body_.start[angle[2 * side]][d] - body_.start[angle[1]][d];
          const double image = -box_[d] * __builtin_ceil(apart / box_[d] - 0.5);
          image_[(side * axes + d) * length + k] = Real(image);
          imaged = imaged || image != 0.0;
        }
      }
    }
    if (imaged) arguments_.image = image_.data();
  }

  void assign_rows() {
    const std::size_t length = padded(angles_.size());
    particle_.assign(3 * length, 0);
    std::vector<std::vector<std::size_t>> rows(body_.slot.count);
    for (std::size_t k = 0; k < length; ++k) {
      const IndexTriple& angle = angles_[std::min(k, angles_.size() - 1)];
      for (std::size_t index = 0; index < 3; ++index) {
        particle_[index * length + k] = angle[index];
        if (k < angles_.size()) rows[angle[index]].push_back(3 * k + index);
      }
    }
    row_start_.push_back(0);
    for (const auto& row : rows) {
      row_.insert(row_.end(), row.begin(), row.end());
      row_start_.push_back(row_.size());
    }
    result_.assign(3 * static_cast<std::size_t>(this->dimension_) * length, Real(0.0));
    arguments_.particle = particle_.data();
    arguments_.row_start = row_start_.data();
    arguments_.row = row_.data();
    arguments_.result = result_.data();
  }

  Bonds bonds(const Stage<Real>* stage, std::size_t k) const {
    const std::size_t length = padded(angles_.size());
    const auto axes = static_cast<std::size_t>(this->dimension_);
    Bonds bond{};
    for (std::size_t side = 0; side < 2; ++side) {
      for (std::size_t d = 0; d < axes; ++d) {
        bond[side][d] = this->coordinate(stage, body_, angles_[k][2 * side], d) -
                        this->coordinate(stage, body_, angles_[k][1], d) +
                        image_[(side * axes + d) * length + k];
      }
    }
    return bond;
  }

  static Real dot_of(const Bonds& bond) {
    return bond[0][0] * bond[1][0] + bond[0][1] * bond[1][1] + bond[0][2] * bond[1][2];
  }
  Real cross_of(const Bonds& bond) const {
    const auto minor = [&](std::size_t one, std::size_t other) {
      return fma(bond[0][one], bond[1][other], -(bond[0][other] * bond[1][one]));
    };
    const Real z = minor(0, 1);
    if (this->dimension_ == 2) return abs(z);
    const Real u = minor(1, 2);
    const Real v = minor(2, 0);
    return sqrt(z * z + u * u + v * v);
  }
  Real angle_of(const Bonds& bond) const { return atan2(cross_of(bond), dot_of(bond)); }

  void add_curvature(std::size_t k, const Bonds& bond, double slope, double curvature,
                     HessianSink& sink) const {
    const Curved cosine = cosine_of(bond);
    const double c = cosine.value.value;
    const double sine = static_cast<double>(
        cross_of(bond) / sqrt(dot_of(bond) * dot_of(bond) + cross_of(bond) * cross_of(bond)));
    const bool straight = sine == 0.0;
    const double by_cosine = straight ? (c < 0.0 ? curvature : -curvature) : -slope / sine;
    const double by_angle = straight ? 0.0 : curvature - slope * c / sine;
    const auto second = [&](std::size_t p, std::size_t q) {
      const double bend = by_cosine * cosine.derivative[p].derivative[q];
      if (straight) return bend;
      const double turn = cosine.value.derivative[p] * cosine.value.derivative[q] / (sine * sine);
      return bend + by_angle * turn;
    };
    // Derivatives give the blocks of the bonds' ends; those of the middle make all sum to zero.
    const auto axes = static_cast<std::size_t>(this->dimension_);
    for (std::size_t a = 0; a < axes; ++a) {
      for (std::size_t b = 0; b < axes; ++b) {
        const double ends[2][2] = {{second(a, b), second(a, 3 + b)},
                                   {second(3 + a, b), second(3 + a, 3 + b)}};
        double row[3][3] = {};
        for (std::size_t p = 0; p < 2; ++p) {
          for (std::size_t q = 0; q < 2; ++q) {
            row[2 * p][2 * q] = ends[p][q];
            row[2 * p][1] -= ends[p][q];
            row[1][2 * q] -= ends[p][q];
            row[1][1] += ends[p][q];
          }
        }
        put_block(k, static_cast<int>(a), static_cast<int>(b), row, sink);
      }
    }
  }

  void put_block(std::size_t k, int a, int b, const double (&row)[3][3], HessianSink& sink) const {
    for (std::size_t p = 0; p < 3; ++p) {
      for (std::size_t q = 0; q < 3; ++q) {
        if (p == q) {
          sink.site(body_.index, angles_[k][p], a, b, row[p][q]);
        } else {
          sink.block(body_.index, angles_[k][p], a, body_.index, angles_[k][q], b, row[p][q]);
        }
      }
    }
  }

  /// With its first and second derivatives by the components of both bonds.
  static Curved cosine_of(const Bonds& bond) {
    Curved way[2][3];
    for (int side = 0; side < 2; ++side) {
      for (int d = 0; d < 3; ++d) {
        const int direction = 3 * side + d;
        const auto x = static_cast<double>(bond[side][d]);
        way[side][d] = Curved::variable(Slope::variable(x, direction), direction);
      }
    }
    const auto product = [&](int one, int other) {
      return way[one][0] * way[other][0] + way[one][1] * way[other][1] +
             way[one][2] * way[other][2];
    };
    return product(0, 1) / (sqrt(product(0, 0)) * sqrt(product(1, 1)));
  }

  BoundBody<Real> body_;
  std::array<double, 3> box_;
  std::vector<IndexTriple> angles_;
  FormulaAngleArguments<Real> arguments_;
  FormulaAngleArguments<Real> heat_;
  AlignedVector<Real> image_;
  AlignedVector<Real> result_;
  std::vector<std::size_t> particle_;
  std::vector<std::size_t> row_start_;
  std::vector<std::size_t> row_;
};

}  // namespace tomlin
