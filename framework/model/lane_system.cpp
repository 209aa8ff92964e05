#include "framework/model/lane_system.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "framework/core/elements/kernel_tables.hpp"
#include "framework/core/elements/site_force.hpp"
#include "framework/model/friction_tables.hpp"

TOMLIN_DECLARE_DOUBLE_TABLES(TravelKernels, TravelTable)

namespace tomlin {
namespace {

/// Between arrays, to keep them off powers of two.
constexpr std::size_t kGap = 3 * kGroup;

/// Coordinates and positions of a replica. The kernels of one run take eight particles at a time as
/// well, and the numbers of eight large replicas are in no cache: a chain is as fast in lanes as by
/// itself at about 100 particles (rk4, AVX-512).
constexpr std::size_t kMostNumbers = 96;

/// The kernels of one run anchor their forces, those of a batch do not.
void anchor_nothing(void*, double, double) {}

void add_to(LaneMap& map, std::size_t first, std::size_t count) {
  for (std::size_t k = first; k < first + count; ++k) map.from.push_back(k);
}

/// For each of so many numbers, and the end: how many of the map stand before it.
std::vector<std::size_t> counted(LaneMap& map, std::size_t size) {
  std::sort(map.from.begin(), map.from.end());
  std::vector<std::size_t> before(size + 1, 0);
  std::size_t count = 0;
  for (std::size_t k = 0; k <= size; ++k) {
    before[k] = count;
    if (count < map.from.size() && map.from[count] == k) ++count;
  }
  return before;
}

const FrictionTable<double>& friction_table(const Model& model) {
  return kernels::FrictionKernels.on<double>(model.system().set);
}

/// The kernel over lanes of one of a model's flows; null: it has none.
auto flow_in_lanes(const Model& model, std::size_t k) -> decltype(Flow<double>::run) {
  const FrictionTable<double>& table = friction_table(model);
  const Flow<double>& flow = model.system().view.flows[k];
  if (flow.run == table.flow_of_particles) return table.particles_in_lanes;
  if (flow.run == table.flow_of_body) return table.body_in_lanes;
  return nullptr;
}

std::size_t numbers_of(const LaneForm& form) {
  std::size_t total = 0;
  for (const auto& some : form.numbers) total += some.size();
  return total;
}

}  // namespace

std::string LaneSystem::why_not(const Model& model) {
  const SystemView<double>& view = model.system().view;
  if (view.own_count > 0) return "forces have internal variables";
  for (std::size_t k = 0; k < view.flow_count; ++k) {
    if (flow_in_lanes(model, k) == nullptr) return "an operator has no kernel over lanes";
  }
  if (view.friction_rate != kNoRate) return "the ledger integrates heats";
  if (model.system().tangent != nullptr || model.system().elastic != nullptr) {
    return "the integrator needs derivatives of forces";
  }
  const std::size_t numbers = view.dofs + model.assembly().mapped_size();
  if (numbers > kMostNumbers) {
    return fmt::format("more than {} coordinates and positions fill vectors by themselves",
                       kMostNumbers);
  }
  if (!model.assembly().lane_calls().empty()) return "";
  if (model.has_rotors()) return "a rigid body rotates in space";
  for (const Model::Force& force : model.forces()) {
    if (force.driver) return "the force \"" + force.name + "\" is a declared driver";
    for (const Pass<double>& pass : force.passes()) {
      if (pass.lanes.kernel == nullptr)
        return "the force \"" + force.name + "\" has no kernel over lanes";
    }
  }
  const bool none_prescribed =
      std::none_of(model.bodies().begin(), model.bodies().end(),
                   [](const Model::Body& body) { return body.prescribed(); });
  if (none_prescribed && view.inertial) return "heats of a force have no kernel over lanes";
  return "bodies are prescribed, or rigid ones move without inertia";
}

LaneSystem::LaneSystem(const Model& first, std::size_t width)
    : first_(first), travel_kernels_(kernels::TravelKernels.on(first.system().set)) {
  layout_.width = width;
  map_numbers(first);
  const std::size_t w = width;
  const std::size_t coordinates = layout_.coordinates.from.size();
  const std::size_t rates = layout_.rates.from.size();
  const std::size_t mapped = mapped_.from.size();
  const SystemView<double>& one = first.system().view;
  std::size_t numbers = 0;
  std::size_t scratch = 0;
  for (const LaneCall& call : first.assembly().lane_calls()) {
    numbers += numbers_of(call.form);
    scratch += call.form.scratch + kGap;
  }
  const std::size_t total = 7 * coordinates + rates + 3 * mapped + numbers + scratch;
  memory_.assign(total * w + 14 * kGap, 0.0);
  SystemView<double>& view = system_.view;
  view.dofs = coordinates * w;
  view.rates = view.used_rates = rates * w;
  view.position = take(coordinates);
  view.velocity = take(coordinates);
  view.force = take(coordinates);
  view.integrals = take(rates);
  view.inverse_mass = inverse_mass_ = take(coordinates);
  view.largest_move = largest_move_ = take(coordinates);
  view.mapped_position = take(mapped);
  view.mapped_velocity = take(mapped);
  view.mapped_force = take(mapped);
  view.coordinates = one.coordinates * w;
  view.inertial = one.inertial;
  view.noise_scale = noise_scale_ = take(coordinates);
  view.friction = friction_of_noise_ = take(coordinates);
  numbers_ = take(numbers);
  lay_calls();
  lay_friction();
  view.operations = operations_.data();
  view.operation_count = operations_.size();
  system_.set = first.system().set;
  system_.begin_step = &anchor_nothing;
}

double* LaneSystem::take(std::size_t numbers) {
  return memory_.data() + std::exchange(taken_, taken_ + numbers * layout_.width + kGap);
}

void LaneSystem::map_numbers(const Model& model) {
  const auto dimension = static_cast<std::size_t>(model.dimension());
  for (const Model::Body& body : model.bodies()) {
    const BodySlot<double>& slot = body.bound.slot;
    if (slot.rigid) add_to(layout_.coordinates, slot.centre, dimension == 1 ? 1 : 3);
    for (std::size_t d = 0; d < dimension; ++d) {
      add_to(slot.mapped ? mapped_ : layout_.coordinates, slot.offset + d * slot.stride,
             slot.count);
    }
  }
  const SystemView<double>& view = model.system().view;
  add_to(layout_.rates, view.own, view.used_rates - view.own);
  coordinates_before_ = counted(layout_.coordinates, view.dofs);
  mapped_before_ = counted(mapped_, model.assembly().mapped_size());
  rates_before_ = counted(layout_.rates, view.rates);
  for (int d = 0; d < model.dimension(); ++d) {
    // One that never moves keeps the origin where it is.
    const bool fixed = std::any_of(model.bodies().begin(), model.bodies().end(), [](const auto& b) {
      return b.bound.slot.mapped && !b.moves_as_one();
    });
    if (fixed || model.origin().unit[d] == 0.0) continue;
    const BodySlot<double>& slot = model.bodies().front().bound.slot;
    const auto axis = static_cast<std::size_t>(d);
    const std::size_t at = slot.rigid ? slot.centre + axis : slot.offset + axis * slot.stride;
    followed_.push_back({coordinates_before_[at], d, 0});
  }
  for (const Model::Body& body : model.bodies()) {
    const BodySlot<double>& slot = body.bound.slot;
    if (!slot.rigid || dimension != 2) continue;
    followed_.push_back({coordinates_before_[slot.centre + kRotation], -1, body.bound.index});
  }
  for (Followed& one : followed_) {
    one.start.assign(width(), 0.0);
    one.unit.assign(width(), 1.0);
  }
}

void LaneSystem::lay_calls() {
  const std::size_t w = width();
  std::size_t numbers = 0;
  std::vector<double*> arms;
  for (const LaneCall& call : first_.assembly().lane_calls()) {
    Call& own = calls_.emplace_back();
    own.numbers = numbers;
    own.follows_time = call.form.follows_time;
    LaneArguments& arguments = own.arguments;
    arguments.single = call.single;
    arguments.numbers = numbers_ + numbers * w;
    for (const LaneTravel& travel : call.form.travels) {
      travels_.to.push_back(numbers_ + (numbers + travel.number) * w);
    }
    by_kernel_ = by_kernel_ && call.form.follows_time == !call.form.travels.empty();
    numbers += numbers_of(call.form);
    if (call.arms >= 0) {
      const auto k = static_cast<std::size_t>(call.arms);
      if (k >= arms.size()) arms.resize(k + 1, nullptr);
      if (arms[k] == nullptr) arms[k] = take(call.form.scratch);
      arguments.scratch = arms[k];
    } else if (call.form.scratch > 0) {
      arguments.scratch = take(call.form.scratch);
    }
    arguments.width = w;
    arguments.set = call.set;
    arguments.coordinate = coordinates_before_.data();
    arguments.mapped = mapped_before_.data();
    arguments.rate = rates_before_.data();
  }
  for (auto* const times : {&travels_.time_high, &travels_.time_low}) times->assign(w, 0.0);
  for (auto* const some : {&travels_.velocity, &travels_.shift_high, &travels_.shift_low}) {
    some->assign(travels_.to.size() * w, 0.0);
  }
  const std::vector<LaneCall>& from = first_.assembly().lane_calls();
  for (std::size_t k = 0; k < calls_.size(); ++k) {
    operations_.push_back({from[k].form.kernel, &calls_[k].arguments});
  }
}

/// Flows, noises and kinetic energies of the system: those of one model, over all lanes.
void LaneSystem::lay_friction() {
  const std::size_t w = width();
  const SystemView<double>& one = first_.system().view;
  const auto rows = [this](std::size_t from, std::size_t length) {
    return coordinates_before_[from + length] - coordinates_before_[from];
  };
  const auto add = [&](const void* of_one) -> const FrictionLanes* {
    const auto& like = *static_cast<const FrictionArguments<double>*>(of_one);
    const std::size_t from = like.body.rigid ? like.body.centre : like.body.offset;
    const std::size_t length = like.body.rigid ? kGroup : like.length;
    return &friction_.emplace_back(like, w, coordinates_before_[from], rows(from, length)).lanes;
  };
  for (std::size_t k = 0; k < one.flow_count; ++k) {
    Flow<double>& flow = flows_.emplace_back();
    flow.run = flow_in_lanes(first_, k);
    flow.arguments = add(one.flows[k].arguments);
  }
  for (std::size_t k = 0; k < one.noise_count; ++k) {
    Noise<double>& noise = noises_.emplace_back();
    noise.fill = friction_table(first_).fill_in_lanes;
    noise.arguments = add(one.noises[k].arguments);
  }
  for (std::size_t k = 0; k < one.kinetic_count; ++k) {
    const KineticIntegral& body = one.kinetic[k];
    kinetic_.push_back({coordinates_before_[body.first] * w, rows(body.first, body.length) * w,
                        static_cast<std::ptrdiff_t>(rates_before_[body.rate] * w)});
  }
  SystemView<double>& view = system_.view;
  view.flows = flows_.data();
  view.flow_count = flows_.size();
  view.noises = noises_.data();
  view.noise_count = noises_.size();
  view.kinetic = kinetic_.data();
  view.kinetic_count = kinetic_.size();
}

LaneSystem::Friction::Friction(const FrictionArguments<double>& like, std::size_t width,
                               std::size_t first, std::size_t rows)
    : run(width, &like),
      is_new(width, 1),
      ahead(width, 0),
      keep(rows * width, 0.0),
      loss(rows * width, 0.0),
      spread(rows * width, 0.0),
      next(kNoiseParts * width, 0) {
  lanes.width = width;
  lanes.first = first;
  lanes.rows = rows;
  lanes.noisy = like.temperature != nullptr;
  lanes.together = like.together;
  lanes.run = run.data();
  lanes.any_new = &any_new;
  lanes.is_new = is_new.data();
  lanes.ahead = ahead.data();
  lanes.keep = keep.data();
  lanes.loss = loss.data();
  lanes.spread = spread.data();
  if (lanes.noisy) normals.assign(kNoiseParts * (like.together + 1) * rows * width, 0.0);
  lanes.normals = normals.data();
  lanes.next = next.data();
}

void LaneSystem::Friction::put(std::size_t lane, const void* arguments, std::uint64_t steps) {
  ahead[lane] = steps;
  run[lane] = static_cast<const FrictionArguments<double>*>(arguments);
  is_new[lane] = 1;
  any_new = true;
}

bool LaneSystem::fits(const Model& model) const {
  const std::vector<LaneCall>& one = first_.assembly().lane_calls();
  const std::vector<LaneCall>& other = model.assembly().lane_calls();
  const SystemView<double>& a = first_.system().view;
  const SystemView<double>& b = model.system().view;
  const auto same_slot = [](const Model::Body& x, const Model::Body& y) {
    return structure_of(x.bound.slot, kNoRate) == structure_of(y.bound.slot, kNoRate);
  };
  const auto same = [](const LaneCall& x, const LaneCall& y) {
    const auto length = [](const auto& numbers) { return numbers.size(); };
    return x.form.kernel == y.form.kernel && x.form.structure == y.form.structure &&
           x.set == y.set && x.arms == y.arms && x.form.travels.size() == y.form.travels.size() &&
           x.form.scratch == y.form.scratch &&
           std::equal(x.form.numbers.begin(), x.form.numbers.end(), y.form.numbers.begin(),
                      y.form.numbers.end(), [&](const auto& some, const auto& others) {
                        return length(some) == length(others);
                      });
  };
  const auto same_friction = [](const void* x, const void* y) {
    const auto& of_one = *static_cast<const FrictionArguments<double>*>(x);
    const auto& of_other = *static_cast<const FrictionArguments<double>*>(y);
    return structure_of(of_one.body, kNoRate) == structure_of(of_other.body, kNoRate) &&
           (of_one.temperature == nullptr) == (of_other.temperature == nullptr);
  };
  bool alike = a.flow_count == b.flow_count && a.noise_count == b.noise_count &&
               a.kinetic_count == b.kinetic_count;
  for (std::size_t k = 0; alike && k < a.flow_count; ++k) {
    alike = same_friction(a.flows[k].arguments, b.flows[k].arguments);
  }
  for (std::size_t k = 0; alike && k < a.noise_count; ++k) {
    alike = same_friction(a.noises[k].arguments, b.noises[k].arguments);
  }
  return alike && a.dofs == b.dofs && a.used_rates == b.used_rates && a.own == b.own &&
         a.inertial == b.inertial && first_.system().set == model.system().set &&
         first_.assembly().mapped_size() == model.assembly().mapped_size() &&
         std::equal(first_.bodies().begin(), first_.bodies().end(), model.bodies().begin(),
                    model.bodies().end(), same_slot) &&
         std::equal(first_.origin().unit.begin(), first_.origin().unit.end(),
                    model.origin().unit.begin(),
                    [](double x, double y) { return (x > 0.0) == (y > 0.0); }) &&
         std::equal(one.begin(), one.end(), other.begin(), other.end(), same);
}

void LaneSystem::put(std::size_t lane, const Model& model, std::uint64_t steps) {
  const SystemView<double>& from = model.system().view;
  SystemView<double>& view = system_.view;
  layout_.coordinates.put(from.position, lane, width(), view.position);
  layout_.coordinates.put(from.velocity, lane, width(), view.velocity);
  layout_.coordinates.put(from.inverse_mass, lane, width(), inverse_mass_);
  layout_.coordinates.put(from.largest_move, lane, width(), largest_move_);
  layout_.rates.put(from.integrals, lane, width(), view.integrals);
  mapped_.put(from.mapped_position, lane, width(), view.mapped_position);
  mapped_.put(from.mapped_velocity, lane, width(), view.mapped_velocity);
  // Friction is that of flows or, without inertia, of noises.
  for (std::size_t k = 0; k < friction_.size(); ++k) {
    friction_[k].put(lane, from.flow_count > 0 ? from.flows[k].arguments : from.noises[k].arguments,
                     steps);
  }
  if (from.noise_count > 0) {
    layout_.coordinates.put(from.noise_scale, lane, width(), noise_scale_);
    layout_.coordinates.put(from.friction, lane, width(), friction_of_noise_);
  }
  const std::size_t w = width();
  double* to = numbers_ + lane;
  std::size_t index = lane;  // among travels
  for (const LaneCall& call : model.assembly().lane_calls()) {
    for (const LaneTravel& travel : call.form.travels) {
      travels_.velocity[index] = *travel.velocity;
      travels_.shift_high[index] = travel.shift->hi;
      travels_.shift_low[index] = travel.shift->lo;
      index += w;
    }
    for (const auto& numbers : call.form.numbers) {
      for (const double number : numbers) {
        *to = number;
        to += w;
      }
    }
  }
  for (Followed& one : followed_) {
    if (one.axis < 0) continue;
    const auto& bound = model.bodies()[one.body].bound;
    const auto axis = static_cast<std::size_t>(one.axis);
    one.start[lane] = bound.slot.rigid ? bound.start_centre[axis] : bound.start[0][axis];
    one.unit[lane] = model.origin().unit[axis];
  }
}

void LaneSystem::set_time(std::size_t lane, const DoubleDouble& time) {
  travels_.time_high[lane] = time.hi;
  travels_.time_low[lane] = time.lo;
}

void LaneSystem::set_times(const double* count, double unit) {
  travel_kernels_.products(count, unit, width(), travels_.time_high.data(),
                           travels_.time_low.data());
}

void LaneSystem::follow_time() {
  travel_kernels_.travel({.width = width(),
                          .count = travels_.to.size(),
                          .time_high = travels_.time_high.data(),
                          .time_low = travels_.time_low.data(),
                          .velocity = travels_.velocity.data(),
                          .shift_high = travels_.shift_high.data(),
                          .shift_low = travels_.shift_low.data(),
                          .travel = travels_.to.data()});
}

void LaneSystem::put_timed(std::size_t lane, const Model& model) {
  const std::size_t w = width();
  const std::vector<LaneCall>& from = model.assembly().lane_calls();
  for (std::size_t k = 0; k < calls_.size(); ++k) {
    if (!calls_[k].follows_time) continue;
    double* to = numbers_ + calls_[k].numbers * w + lane;
    // The parameters come first; all else stays.
    for (const double number : from[k].form.numbers.front()) {
      *to = number;
      to += w;
    }
  }
}

void LaneSystem::get(std::size_t lane, Model& model) const {
  const SystemView<double>& to = model.system().view;
  const std::size_t w = width();
  layout_.coordinates.get(system_.view.position, lane, w, to.position);
  layout_.coordinates.get(system_.view.velocity, lane, w, to.velocity);
  layout_.rates.get(system_.view.integrals, lane, w, to.integrals);
}

bool LaneSystem::may_rebase(std::size_t lane) const {
  return std::any_of(followed_.begin(), followed_.end(), [&](const Followed& one) {
    const double at = system_.view.position[one.coordinate * width() + lane];
    return !(std::abs(at - one.start[lane]) < one.unit[lane]);
  });
}

}  // namespace tomlin
