#pragma once

#include <cstddef>
#include <type_traits>

#include "framework/core/elements/kernels.hpp"
#include "framework/core/elements/nearest_image.hpp"
#include "framework/core/formula/formula_arguments.hpp"
#include "framework/core/formula/interpreter.hpp"

/// The loops over elements for formulas of a scene: particles, centres of mass, pairs and angles.
/// One set of kernels for all formulas and dimensions; the formula comes with the arguments.
namespace tomlin {
inline namespace TOMLIN_TARGET {

template <class Real>
TOMLIN_INLINE std::size_t packs_from(std::size_t i, std::size_t count) {
  const std::size_t packs = (count - i + kGroup - 1) / kGroup;
  return packs < kFormulaBlock ? packs : kFormulaBlock;
}

/// The numbers of a body that a formula takes, from particle i on.
template <class Real>
TOMLIN_INLINE void point_at_inputs(const FormulaSiteArguments<Real>& a, const Stage<Real>& stage,
                                   std::size_t i, const Real** inputs) {
  const Real* x = (a.body.mapped ? stage.mapped_position : stage.position) + a.body.offset;
  const Real* v = (a.body.mapped ? stage.mapped_velocity : stage.velocity) + a.body.offset;
  for (std::size_t k = 0; k < a.axes; ++k) {
    const int axis = a.axis[k];
    inputs[k] = axis < 3 ? x + static_cast<std::size_t>(axis) * a.body.stride + i
                         : v + static_cast<std::size_t>(axis - 3) * a.body.stride + i;
  }
  for (std::size_t k = 0; k < a.numbers; ++k) {
    inputs[a.axes + k] = a.number + k * a.body.stride + i;
  }
}

/// Returns pack k of output d.
template <class Real>
TOMLIN_INLINE Packed<Real> output(const FormulaView<Real>& code, const Real* const* inputs,
                                  std::size_t d, std::size_t k) {
  const FormulaOutput<Real>& out = code.outputs[d];
  const Real* at = out.input < 0 ? out.operand.at : inputs[out.input];
  return Packed<Real>::load(at + k * out.operand.step);
}

// ---- particles ----------------------------------------------------------------------------------

template <class Real, bool set>
void formula_site_kernel(const void* arguments, const Stage<Real>& stage) {
  using Group = Packed<Real>;
  const auto& a = *static_cast<const FormulaSiteArguments<Real>*>(arguments);
  const std::size_t count = a.body.count;
  const std::size_t stride = a.body.stride;
  const auto axes = static_cast<std::size_t>(a.dimension);
  Real* f = (a.body.mapped ? stage.mapped_force : stage.force) + a.body.offset;
  begin_formula<Group>(a.code, stage.elapsed);
  for (std::size_t i = 0; i < count; i += kFormulaElements) {
    const Real* inputs[kMostFormulaInputs];
    point_at_inputs(a, stage, i, inputs);
    const std::size_t packs = packs_from<Real>(i, count);
    if constexpr (set) {
      for (std::size_t d = 0; d < axes; ++d) {
        if (a.code.outputs[d].writes_to) *a.code.outputs[d].writes_to = f + d * stride + i;
      }
    }
    run_formula<Group>(a.code, inputs, packs);
    for (std::size_t d = 0; d < axes; ++d) {
      Real* to = f + d * stride + i;
      if (set && a.code.outputs[d].writes_to) {
        Real* last = to + (packs - 1) * kGroup;
        without_padding<Real>(Group::load(last), i + (packs - 1) * kGroup, count).store(last);
        continue;
      }
      for (std::size_t k = 0; k < packs; ++k) {
        put<set>(to + k * kGroup,
                 without_padding<Real>(output(a.code, inputs, d, k), i + k * kGroup, count));
      }
    }
  }
  if constexpr (set) {
    for (std::size_t d = 0; d < axes; ++d) {
      if (a.code.outputs[d].writes_to) *a.code.outputs[d].writes_to = a.code.outputs[d].home;
    }
  }
}

/// Writes the power that the formula takes out of the particles: -F.v, or by its change in time.
template <class Real>
void formula_site_heat(const void* arguments, const Stage<Real>& stage) {
  using Group = Packed<Real>;
  const auto& a = *static_cast<const FormulaSiteArguments<Real>*>(arguments);
  const std::size_t count = a.body.count;
  const Real* v = (a.body.mapped ? stage.mapped_velocity : stage.velocity) + a.body.offset;
  begin_formula<Group>(a.code, stage.elapsed);
  Group heat(Real(0.0));
  for (std::size_t i = 0; i < count; i += kFormulaElements) {
    const Real* inputs[kMostFormulaInputs];
    point_at_inputs(a, stage, i, inputs);
    const std::size_t packs = packs_from<Real>(i, count);
    run_formula<Group>(a.code, inputs, packs);
    const int outputs = a.heat_is_power ? a.dimension : 1;
    for (std::size_t k = 0; k < packs; ++k) {
      Group taken(Real(0.0));
      for (int d = 0; d < outputs; ++d) {
        const Group value = output(a.code, inputs, static_cast<std::size_t>(d), k);
        const Real* speed = v + static_cast<std::size_t>(d) * a.body.stride + i + k * kGroup;
        taken = a.heat_is_power ? fnma(value, Group::load(speed), taken) : taken - value;
      }
      heat = heat + without_padding<Real>(taken, i + k * kGroup, count);
    }
  }
  stage.rates[a.rate] = sum(heat);
}

/// A single particle on a line, in registers.
template <class Real>
PointResult<Real> formula_point_kernel(const void* arguments, Real position, Real velocity, Real,
                                       Real elapsed) {
  const auto& a = *static_cast<const FormulaSiteArguments<Real>*>(arguments);
  begin_formula<Real>(a.code, elapsed);
  const Real* inputs[kMostFormulaInputs];
  for (std::size_t k = 0; k < a.axes; ++k) inputs[k] = a.axis[k] < 3 ? &position : &velocity;
  for (std::size_t k = 0; k < a.numbers; ++k) inputs[a.axes + k] = a.number + k * a.body.stride;
  run_formula<Real>(a.code, inputs, 1);
  const FormulaOutput<Real>& out = a.code.outputs[0];
  return {out.input < 0 ? *out.operand.at : *inputs[out.input], Real(0.0)};
}

/// All outputs for one element; energies and second derivatives come this way.
template <class Real>
void formula_evaluate(const FormulaView<Real>& code, const Real* values, std::size_t count,
                      Real elapsed, Real* outputs) {
  begin_formula<Real>(code, elapsed);
  const Real* inputs[kMostFormulaInputs];
  for (std::size_t k = 0; k < count; ++k) inputs[k] = values + k;
  run_formula<Real>(code, inputs, 1);
  for (std::size_t k = 0; k < code.output_count; ++k) {
    const FormulaOutput<Real>& out = code.outputs[k];
    outputs[k] = out.input < 0 ? *out.operand.at : *inputs[out.input];
  }
}

// ---- the centre of mass -------------------------------------------------------------------------

template <class Real, int D>
TOMLIN_INLINE void evaluate_at_centre(const FormulaCentreArguments<Real>& a,
                                      const Stage<Real>& stage, Real* outputs) {
  const auto centre = attached_point<Real, D>(a.centre, stage.position, stage.mapped_position);
  Real values[kMostFormulaAxes] = {};
  for (std::size_t k = 0; k < a.inputs; ++k) values[k] = centre[a.axis[k]];
  formula_evaluate<Real>(a.code, values, a.inputs, stage.elapsed, outputs);
}

template <class Real, int D, bool set>
void formula_centre_kernel(const void* arguments, const Stage<Real>& stage) {
  const auto& a = *static_cast<const FormulaCentreArguments<Real>*>(arguments);
  Vec<Real, D> force;
  evaluate_at_centre<Real, D>(a, stage, force.v);
  share_out_attached<set>(a.centre, stage, force);
}

// ---- pairs --------------------------------------------------------------------------------------

/// A block of pairs: from the first particle to the second, and how far.
template <class Real>
struct PairBlock {
  alignas(64) Real separation[3][kFormulaElements];
  alignas(64) Real distance[kFormulaElements];
};

template <class Real>
TOMLIN_INLINE void gather_pairs(const FormulaPairArguments<Real>& a, const Stage<Real>& stage,
                                std::size_t first, std::size_t packs, PairBlock<Real>& block) {
  using Group = Packed<Real>;
  const PairListArguments<Real>& list = a.list;
  const Real* x1 = (list.first.mapped ? stage.mapped_position : stage.position) + list.first.offset;
  const Real* x2 =
      (list.second.mapped ? stage.mapped_position : stage.position) + list.second.offset;
  for (std::size_t k = 0; k < packs; ++k) {
    const std::size_t pair = first + k * kGroup;
    Group square(Real(0.0));
    for (int d = 0; d < a.dimension; ++d) {
      const Group apart = separation_along(list, x1, x2, d, pair);
      apart.store(block.separation[d] + k * kGroup);
      square = a.dimension == 1 ? abs(apart) : fma(apart, apart, square);
    }
    const Group distance = a.dimension == 1 ? square : sqrt(square);
    distance.store(block.distance + k * kGroup);
  }
}

/// Takes the pairs of neighbours: pair i is of particles i and i + 1.
template <class Real>
TOMLIN_INLINE void take_neighbours(const FormulaPairArguments<Real>& a, const Stage<Real>& stage,
                                   std::size_t first, std::size_t packs, PairBlock<Real>& block) {
  using Group = Packed<Real>;
  const BodySlot<Real>& body = a.list.first;
  const Real* x = (body.mapped ? stage.mapped_position : stage.position) + body.offset;
  for (int d = 0; d < a.dimension; ++d) {
    const Real* along = x + static_cast<std::size_t>(d) * body.stride + first;
    for (std::size_t k = 0; k < packs; ++k) {
      const Real* from = along + k * kGroup;
      (Group::load_unaligned(from + 1) - Group::load(from)).store(block.separation[d] + k * kGroup);
    }
    const std::size_t last = body.count - 1;
    if (a.closed && last >= first && last < first + packs * kGroup) {
      const Real* all = x + static_cast<std::size_t>(d) * body.stride;
      block.separation[d][last - first] = all[0] + a.wrap[d] - all[last];
    }
  }
  for (std::size_t k = 0; k < packs; ++k) {
    const Group along = Group::load(block.separation[0] + k * kGroup);
    Group distance = abs(along);
    if (a.dimension > 1) {
      Group square = along * along;
      for (int d = 1; d < a.dimension; ++d) {
        const Group way = Group::load(block.separation[d] + k * kGroup);
        square = fma(way, way, square);
      }
      distance = sqrt(square);
    }
    distance.store(block.distance + k * kGroup);
  }
}

/// The forces on the first particles of a block of pairs: `to` is [axis][stride].
template <class Real>
TOMLIN_INLINE void pull_pairs(const FormulaPairArguments<Real>& a, const Real* const* inputs,
                              const PairBlock<Real>& block, std::size_t first, std::size_t packs,
                              std::size_t pairs, Real* to, std::size_t stride) {
  using Group = Packed<Real>;
  for (std::size_t k = 0; k < packs; ++k) {
    const Group tension = output(a.code, inputs, 0, k);
    Group scale = tension;
    if (a.dimension > 1) {
      // A coincident pair whose energy is level there does not pull; any other has no direction.
      const Group distance = Group::load(block.distance + k * kGroup);
      const auto level = (distance == Group(Real(0.0))) & (tension == Group(Real(0.0)));
      scale = select(level, Group(Real(0.0)), tension / distance);
    }
    for (int d = 0; d < a.dimension; ++d) {
      const Group apart = Group::load(block.separation[d] + k * kGroup);
      const Group way = a.dimension == 1 ? copysign(Group(Real(1.0)), apart) : apart;
      without_padding<Real>(scale * way, first + k * kGroup, pairs)
          .store(to + static_cast<std::size_t>(d) * stride + first + k * kGroup);
    }
  }
}

template <class Real>
TOMLIN_INLINE void take_pairs(const FormulaPairArguments<Real>& a, const Stage<Real>& stage,
                              std::size_t first, std::size_t packs, PairBlock<Real>& block) {
  if (a.chain) {
    take_neighbours(a, stage, first, packs, block);
  } else {
    gather_pairs(a, stage, first, packs, block);
  }
}

/// Adds the pulls of neighbours: on each particle that of the pair ahead, less that behind.
template <class Real>
TOMLIN_INLINE void share_out_neighbours(const FormulaPairArguments<Real>& a,
                                        const Stage<Real>& stage) {
  using Group = Packed<Real>;
  const BodySlot<Real>& body = a.list.first;
  Real* f = (body.mapped ? stage.mapped_force : stage.force) + body.offset;
  for (std::size_t d = 0; d < static_cast<std::size_t>(a.dimension); ++d) {
    Real* ahead = a.result + d * a.result_stride + kGroup;
    ahead[-1] = a.closed ? ahead[body.count - 1] : Real(0.0);
    for (std::size_t i = 0; i < body.count; i += kGroup) {
      const Group pull = Group::load(ahead + i) - Group::load_unaligned(ahead + i - 1);
      put<false>(f + d * body.stride + i, without_padding<Real>(pull, i, body.count));
    }
  }
}

template <class Real>
void formula_pair_kernel(const void* arguments, const Stage<Real>& stage) {
  using Group = Packed<Real>;
  const auto& a = *static_cast<const FormulaPairArguments<Real>*>(arguments);
  const std::size_t pairs = a.list.pairs;
  const std::size_t row_length = (pairs + kGroup - 1) / kGroup * kGroup;
  Real* result = a.chain ? a.result + kGroup : a.list.result;
  const std::size_t stride = a.chain ? a.result_stride : row_length;
  PairBlock<Real> block;
  const Real* inputs[] = {block.distance};
  begin_formula<Group>(a.code, stage.elapsed);
  for (std::size_t first = 0; first < pairs; first += kFormulaElements) {
    const std::size_t packs = packs_from<Real>(first, pairs);
    take_pairs(a, stage, first, packs, block);
    run_formula<Group>(a.code, inputs, packs);
    pull_pairs(a, inputs, block, first, packs, pairs, result, stride);
  }
  if (a.chain) {
    share_out_neighbours(a, stage);
  } else {
    share_out_pairs(a.list, stage, a.dimension);
  }
}

template <class Real>
void formula_pair_heat(const void* arguments, const Stage<Real>& stage) {
  using Group = Packed<Real>;
  const auto& a = *static_cast<const FormulaPairArguments<Real>*>(arguments);
  PairBlock<Real> block;
  const Real* inputs[] = {block.distance};
  begin_formula<Group>(a.code, stage.elapsed);
  Group heat(Real(0.0));
  for (std::size_t first = 0; first < a.list.pairs; first += kFormulaElements) {
    const std::size_t packs = packs_from<Real>(first, a.list.pairs);
    take_pairs(a, stage, first, packs, block);
    run_formula<Group>(a.code, inputs, packs);
    for (std::size_t k = 0; k < packs; ++k) {
      heat = heat -
             without_padding<Real>(output(a.code, inputs, 0, k), first + k * kGroup, a.list.pairs);
    }
  }
  stage.rates[a.rate] = sum(heat);
}

template <class Real, int D>
void formula_centre_heat(const void* arguments, const Stage<Real>& stage) {
  const auto& a = *static_cast<const FormulaCentreArguments<Real>*>(arguments);
  Real slope[1] = {};
  evaluate_at_centre<Real, D>(a, stage, slope);
  stage.rates[a.centre.rate] = -slope[0];
}

// ---- angles -------------------------------------------------------------------------------------

/// A block of angles: the bonds from the middle particle to the ends, and what follows from them.
template <class Real>
struct AngleBlock {
  alignas(64) Real bond[2][3][kFormulaElements];
  alignas(64) Real dot[kFormulaElements];
  alignas(64) Real cross[kFormulaElements];
  alignas(64) Real angle[kFormulaElements];
};

template <class Real>
TOMLIN_INLINE void gather_angles(const FormulaAngleArguments<Real>& a, const Stage<Real>& stage,
                                 std::size_t first, std::size_t packs, AngleBlock<Real>& block) {
  using Group = Packed<Real>;
  const Real* x = (a.body.mapped ? stage.mapped_position : stage.position) + a.body.offset;
  const std::size_t length = (a.angles + kGroup - 1) / kGroup * kGroup;
  for (std::size_t k = 0; k < packs; ++k) {
    const std::size_t at = first + k * kGroup;
    Group bond[2][3];
    for (std::size_t side = 0; side < 2; ++side) {
      for (std::size_t d = 0; d < 3; ++d) {
        bond[side][d] = Group(Real(0.0));
        if (d >= static_cast<std::size_t>(a.dimension)) continue;
        const Real* along = x + d * a.body.stride;
        bond[side][d] = gather(along, a.particle + 2 * side * length + at) -
                        gather(along, a.particle + length + at);
        if (a.image) {
          const std::size_t row = side * static_cast<std::size_t>(a.dimension) + d;
          bond[side][d] = bond[side][d] + Group::load(a.image + row * length + at);
        }
        bond[side][d].store(block.bond[side][d] + k * kGroup);
      }
    }
    const auto minor = [&](std::size_t one, std::size_t other) TOMLIN_INLINE_LAMBDA {
      return fma(bond[0][one], bond[1][other], -(bond[0][other] * bond[1][one]));
    };
    const Group z = minor(0, 1);
    Group cross = abs(z);
    if (a.dimension == 3) {
      const Group u = minor(1, 2);
      const Group v = minor(2, 0);
      cross = sqrt(fma(z, z, fma(u, u, v * v)));
    }
    const Group dot =
        fma(bond[0][2], bond[1][2], fma(bond[0][1], bond[1][1], bond[0][0] * bond[1][0]));
    dot.store(block.dot + k * kGroup);
    cross.store(block.cross + k * kGroup);
    atan2(cross, dot).store(block.angle + k * kGroup);
  }
}

/// With bonds s, u from the middle particle and T = dV/dtheta, the end of s feels
/// T (u - (s.u/s^2) s)/|s x u|, and the middle the opposite of both ends' forces.
template <class Real>
void formula_angle_kernel(const void* arguments, const Stage<Real>& stage) {
  using Group = Packed<Real>;
  const auto& a = *static_cast<const FormulaAngleArguments<Real>*>(arguments);
  const std::size_t length = (a.angles + kGroup - 1) / kGroup * kGroup;
  const auto axes = static_cast<std::size_t>(a.dimension);
  AngleBlock<Real> block;
  const Real* inputs[] = {block.angle};
  begin_formula<Group>(a.code, stage.elapsed);
  for (std::size_t first = 0; first < a.angles; first += kFormulaElements) {
    const std::size_t packs = packs_from<Real>(first, a.angles);
    gather_angles(a, stage, first, packs, block);
    run_formula<Group>(a.code, inputs, packs);
    for (std::size_t k = 0; k < packs; ++k) {
      const Group torque = output(a.code, inputs, 0, k);
      const Group cross = Group::load(block.cross + k * kGroup);
      const Group dot = Group::load(block.dot + k * kGroup);
      // Straight bonds whose energy is level there do not bend; else they have no way to.
      const auto level = (cross == Group(Real(0.0))) & (torque == Group(Real(0.0)));
      const Group scale = select(level, Group(Real(0.0)), torque / cross);
      Group square[2] = {Group(Real(0.0)), Group(Real(0.0))};
      for (std::size_t side = 0; side < 2; ++side) {
        for (std::size_t d = 0; d < axes; ++d) {
          const Group way = Group::load(block.bond[side][d] + k * kGroup);
          square[side] = fma(way, way, square[side]);
        }
      }
      for (std::size_t d = 0; d < axes; ++d) {
        const Group s = Group::load(block.bond[0][d] + k * kGroup);
        const Group u = Group::load(block.bond[1][d] + k * kGroup);
        const Group on_first = scale * fnma(dot / square[0], s, u);
        const Group on_last = scale * fnma(dot / square[1], u, s);
        Real* to = a.result + d * length + first + k * kGroup;
        on_first.store(to);
        (-(on_first + on_last)).store(to + axes * length);
        on_last.store(to + 2 * axes * length);
      }
    }
  }
  Real* f = (a.body.mapped ? stage.mapped_force : stage.force) + a.body.offset;
  for (std::size_t d = 0; d < axes; ++d) {
    for (std::size_t i = 0; i < a.body.count; ++i) {
      Real total(0.0);
      for (std::size_t k = a.row_start[i]; k < a.row_start[i + 1]; ++k) {
        const std::size_t angle = a.row[k] / 3;
        const std::size_t index = a.row[k] % 3;
        total += a.result[(index * axes + d) * length + angle];
      }
      f[d * a.body.stride + i] += total;
    }
  }
}

template <class Real>
void formula_angle_heat(const void* arguments, const Stage<Real>& stage) {
  using Group = Packed<Real>;
  const auto& a = *static_cast<const FormulaAngleArguments<Real>*>(arguments);
  AngleBlock<Real> block;
  const Real* inputs[] = {block.angle};
  begin_formula<Group>(a.code, stage.elapsed);
  Group heat(Real(0.0));
  for (std::size_t first = 0; first < a.angles; first += kFormulaElements) {
    const std::size_t packs = packs_from<Real>(first, a.angles);
    gather_angles(a, stage, first, packs, block);
    run_formula<Group>(a.code, inputs, packs);
    for (std::size_t k = 0; k < packs; ++k) {
      heat =
          heat - without_padding<Real>(output(a.code, inputs, 0, k), first + k * kGroup, a.angles);
    }
  }
  stage.rates[a.rate] = sum(heat);
}

/// Named where evaluators are named; its table is that of formulas.
struct FormulaKernels {
  template <class Real>
  static constexpr FormulaKernelTable<Real> kernels() {
    FormulaKernelTable<Real> table;
    table.site.set[0] = &formula_site_kernel<Real, true>;
    table.site.add[0] = &formula_site_kernel<Real, false>;
    table.centre = {{&formula_centre_kernel<Real, 1, true>, &formula_centre_kernel<Real, 2, true>,
                     &formula_centre_kernel<Real, 3, true>},
                    {&formula_centre_kernel<Real, 1, false>, &formula_centre_kernel<Real, 2, false>,
                     &formula_centre_kernel<Real, 3, false>}};
    table.pairs = &formula_pair_kernel<Real>;
    table.angles = &formula_angle_kernel<Real>;
    table.angle_heat = &formula_angle_heat<Real>;
    table.site_heat = &formula_site_heat<Real>;
    table.pair_heat = &formula_pair_heat<Real>;
    table.centre_heat[0] = &formula_centre_heat<Real, 1>;
    table.centre_heat[1] = &formula_centre_heat<Real, 2>;
    table.centre_heat[2] = &formula_centre_heat<Real, 3>;
    table.point = &formula_point_kernel<Real>;
    table.evaluate = &formula_evaluate<Real>;
    return table;
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
