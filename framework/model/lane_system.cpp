#include "framework/model/lane_system.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "framework/core/elements/site_force.hpp"

namespace tomlin {
namespace {

/// Between arrays, to keep them off powers of two.
constexpr std::size_t kGap = 3 * kGroup;

/// The kernels of one run anchor their forces, those of a batch do not.
void anchor_nothing(void*, double, double) {}

std::size_t numbers_of(const LaneForm& form) {
  std::size_t total = 0;
  for (const auto& some : form.numbers) total += some.size();
  return total;
}

}  // namespace

std::string LaneSystem::why_not(const Model& model) {
  const SystemView<double>& view = model.system().view;
  if (!view.inertial) return "the integrator keeps slopes without inertia";
  if (view.own_count > 0) return "forces have internal variables";
  if (view.flow_count > 0) return "the integrator takes friction as an operator";
  if (model.system().tangent != nullptr || model.system().elastic != nullptr) {
    return "the integrator needs derivatives of forces";
  }
  if (!model.assembly().lane_calls().empty()) return "";
  for (const Model::Force& force : model.forces()) {
    if (force.driver) return "the force \"" + force.name + "\" is a declared driver";
    for (const Pass<double>& pass : force.passes()) {
      if (pass.lanes.kernel == nullptr)
        return "the force \"" + force.name + "\" has no kernel over lanes";
    }
  }
  if (model.scene().run.ledger) return "the ledger integrates heats";
  return "bodies are prescribed, or rigid ones move without inertia";
}

void LaneSystem::Map::add(std::size_t first, std::size_t count) {
  for (std::size_t k = first; k < first + count; ++k) from.push_back(k);
}

void LaneSystem::Map::close(std::size_t size) {
  std::sort(from.begin(), from.end());
  to.assign(size + 1, 0);
  std::size_t before = 0;
  for (std::size_t k = 0; k <= size; ++k) {
    to[k] = before;
    if (before < from.size() && from[before] == k) ++before;
  }
}

LaneSystem::LaneSystem(const Model& first, std::size_t width) : first_(first), width_(width) {
  map_numbers(first);
  const SystemView<double>& one = first.system().view;
  std::size_t numbers = 0;
  std::size_t scratch = 0;
  for (const LaneCall& call : first.assembly().lane_calls()) {
    numbers += numbers_of(call.form);
    scratch += call.form.scratch + kGap;
  }
  const std::size_t total =
      5 * coordinates_.size() + rates_.size() + 3 * mapped_.size() + numbers + scratch;
  memory_.assign(total * width_ + 12 * kGap, 0.0);
  SystemView<double>& view = system_.view;
  view.dofs = coordinates_.size() * width_;
  view.rates = view.used_rates = rates_.size() * width_;
  view.position = take(coordinates_.size());
  view.velocity = take(coordinates_.size());
  view.force = take(coordinates_.size());
  view.integrals = take(rates_.size());
  view.inverse_mass = inverse_mass_ = take(coordinates_.size());
  view.largest_move = largest_move_ = take(coordinates_.size());
  view.mapped_position = take(mapped_.size());
  view.mapped_velocity = take(mapped_.size());
  view.mapped_force = take(mapped_.size());
  view.coordinates = one.coordinates * width_;
  view.inertial = one.inertial;
  numbers_ = take(numbers);
  lay_calls();
  view.operations = operations_.data();
  view.operation_count = operations_.size();
  system_.set = first.system().set;
  system_.begin_step = &anchor_nothing;
}

double* LaneSystem::take(std::size_t numbers) {
  return memory_.data() + std::exchange(taken_, taken_ + numbers * width_ + kGap);
}

void LaneSystem::map_numbers(const Model& model) {
  const auto dimension = static_cast<std::size_t>(model.dimension());
  for (const Model::Body& body : model.bodies()) {
    const BodySlot<double>& slot = body.bound.slot;
    if (slot.rigid) coordinates_.add(slot.centre, dimension == 1 ? 1 : 3);
    for (std::size_t d = 0; d < dimension; ++d) {
      (slot.mapped ? mapped_ : coordinates_).add(slot.offset + d * slot.stride, slot.count);
    }
  }
  const SystemView<double>& view = model.system().view;
  rates_.add(view.own, view.used_rates - view.own);
  coordinates_.close(view.dofs);
  mapped_.close(model.assembly().mapped_size());
  rates_.close(view.rates);
  for (int d = 0; d < model.dimension(); ++d) {
    // One that never moves keeps the origin where it is.
    const bool fixed = std::any_of(model.bodies().begin(), model.bodies().end(), [](const auto& b) {
      return b.bound.slot.mapped && !b.moves_as_one();
    });
    if (fixed || model.origin().unit[d] == 0.0) continue;
    const BodySlot<double>& slot = model.bodies().front().bound.slot;
    const auto axis = static_cast<std::size_t>(d);
    const std::size_t at = slot.rigid ? slot.centre + axis : slot.offset + axis * slot.stride;
    followed_.push_back({coordinates_.to[at], d, 0});
  }
  for (const Model::Body& body : model.bodies()) {
    const BodySlot<double>& slot = body.bound.slot;
    if (!slot.rigid || dimension != 2) continue;
    followed_.push_back({coordinates_.to[slot.centre + kRotation], -1, body.bound.index});
  }
  for (Followed& one : followed_) {
    one.start.assign(width_, 0.0);
    one.unit.assign(width_, 1.0);
  }
}

void LaneSystem::lay_calls() {
  std::size_t numbers = 0;
  std::vector<double*> arms;
  for (const LaneCall& call : first_.assembly().lane_calls()) {
    Call& own = calls_.emplace_back();
    own.numbers = numbers;
    own.follows_time = call.form.follows_time;
    LaneArguments& arguments = own.arguments;
    arguments.single = call.single;
    arguments.numbers = numbers_ + numbers * width_;
    numbers += numbers_of(call.form);
    if (call.arms >= 0) {
      const auto k = static_cast<std::size_t>(call.arms);
      if (k >= arms.size()) arms.resize(k + 1, nullptr);
      if (arms[k] == nullptr) arms[k] = take(call.form.scratch);
      arguments.scratch = arms[k];
    } else if (call.form.scratch > 0) {
      arguments.scratch = take(call.form.scratch);
    }
    arguments.width = width_;
    arguments.set = call.set;
    arguments.coordinate = coordinates_.to.data();
    arguments.mapped = mapped_.to.data();
    arguments.rate = rates_.to.data();
  }
  const std::vector<LaneCall>& from = first_.assembly().lane_calls();
  for (std::size_t k = 0; k < calls_.size(); ++k) {
    operations_.push_back({from[k].form.kernel, &calls_[k].arguments});
  }
}

bool LaneSystem::fits(const Model& model) const {
  const std::vector<LaneCall>& one = first_.assembly().lane_calls();
  const std::vector<LaneCall>& other = model.assembly().lane_calls();
  const SystemView<double>& a = first_.system().view;
  const SystemView<double>& b = model.system().view;
  const auto same_place = [](const Model::Body& x, const Model::Body& y) {
    return structure_of(x.bound.slot, kNoRate) == structure_of(y.bound.slot, kNoRate);
  };
  const auto same = [](const LaneCall& x, const LaneCall& y) {
    const auto length = [](const auto& numbers) { return numbers.size(); };
    return x.form.kernel == y.form.kernel && x.form.structure == y.form.structure &&
           x.set == y.set && x.arms == y.arms && x.form.scratch == y.form.scratch &&
           std::equal(x.form.numbers.begin(), x.form.numbers.end(), y.form.numbers.begin(),
                      y.form.numbers.end(), [&](const auto& some, const auto& others) {
                        return length(some) == length(others);
                      });
  };
  return a.dofs == b.dofs && a.used_rates == b.used_rates && a.own == b.own &&
         a.inertial == b.inertial && first_.system().set == model.system().set &&
         first_.assembly().mapped_size() == model.assembly().mapped_size() &&
         std::equal(first_.bodies().begin(), first_.bodies().end(), model.bodies().begin(),
                    model.bodies().end(), same_place) &&
         std::equal(first_.origin().unit.begin(), first_.origin().unit.end(),
                    model.origin().unit.begin(),
                    [](double x, double y) { return (x > 0.0) == (y > 0.0); }) &&
         std::equal(one.begin(), one.end(), other.begin(), other.end(), same);
}

void LaneSystem::put_all(std::size_t lane, const Map& map, const double* single,
                         double* lanes) const {
  double* to = lanes + lane;
  for (const std::size_t k : map.from) {
    *to = single[k];
    to += width_;
  }
}

void LaneSystem::put(std::size_t lane, const Model& model) {
  const SystemView<double>& from = model.system().view;
  SystemView<double>& view = system_.view;
  put_all(lane, coordinates_, from.position, view.position);
  put_all(lane, coordinates_, from.velocity, view.velocity);
  put_all(lane, coordinates_, from.inverse_mass, inverse_mass_);
  put_all(lane, coordinates_, from.largest_move, largest_move_);
  put_all(lane, rates_, from.integrals, view.integrals);
  put_all(lane, mapped_, from.mapped_position, view.mapped_position);
  put_all(lane, mapped_, from.mapped_velocity, view.mapped_velocity);
  double* to = numbers_ + lane;
  for (const LaneCall& call : model.assembly().lane_calls()) {
    for (const auto& numbers : call.form.numbers) {
      for (const double number : numbers) {
        *to = number;
        to += width_;
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

void LaneSystem::put_timed(std::size_t lane, const Model& model) {
  const std::vector<LaneCall>& from = model.assembly().lane_calls();
  for (std::size_t k = 0; k < calls_.size(); ++k) {
    if (!calls_[k].follows_time) continue;
    double* to = numbers_ + calls_[k].numbers * width_ + lane;
    // The parameters come first; all else stays.
    for (const double number : from[k].form.numbers.front()) {
      *to = number;
      to += width_;
    }
  }
}

void LaneSystem::get(std::size_t lane, Model& model) const {
  const SystemView<double>& to = model.system().view;
  get_coordinates(lane, system_.view.position, to.position);
  get_coordinates(lane, system_.view.velocity, to.velocity);
  get_rates(lane, system_.view.integrals, to.integrals);
}

void LaneSystem::put_coordinates(std::size_t lane, const double* single, double* lanes) const {
  put_all(lane, coordinates_, single, lanes);
}

void LaneSystem::put_rates(std::size_t lane, const double* single, double* lanes) const {
  put_all(lane, rates_, single, lanes);
}

void LaneSystem::get_coordinates(std::size_t lane, const double* lanes, double* single) const {
  for (std::size_t k = 0; k < coordinates_.size(); ++k) {
    single[coordinates_.from[k]] = lanes[k * width_ + lane];
  }
}

void LaneSystem::get_rates(std::size_t lane, const double* lanes, double* single) const {
  for (std::size_t k = 0; k < rates_.size(); ++k) {
    single[rates_.from[k]] = lanes[k * width_ + lane];
  }
}

bool LaneSystem::may_rebase(std::size_t lane) const {
  return std::any_of(followed_.begin(), followed_.end(), [&](const Followed& one) {
    const double at = system_.view.position[one.coordinate * width_ + lane];
    return !(std::abs(at - one.start[lane]) < one.unit[lane]);
  });
}

}  // namespace tomlin
