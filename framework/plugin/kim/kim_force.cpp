#include "framework/plugin/kim/kim_force.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/core/records/facets.hpp"
#include "framework/plugin/kim/kim_surroundings.hpp"

namespace tomlin::kim {
namespace {

/// Atoms that start nearer than this are a mistake: no bond is as short.
constexpr double kNearest = 0.5;  // Angstrom
/// Second derivatives are differences over this to either side: some 1e-10 off in parts of the
/// largest, by rounding and by what is left out alike. Longer ones would pass over the knots of
/// tables, which are as near as 5e-4 Angstrom and where second derivatives jump.
constexpr double kDifference = 5e-6;  // Angstrom
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

using Bodies = std::vector<BoundBody<double>>;

std::vector<int> codes_of(const PortableModel& model, const Bodies& bodies) {
  std::vector<int> codes;
  for (const BoundBody<double>& body : bodies) {
    std::vector<int> of_name(body.species_names.size(), -1);
    for (std::size_t i = 0; i < body.slot.count; ++i) {
      const auto name = static_cast<std::size_t>(body.species[i]);
      if (of_name[name] < 0) of_name[name] = model.code_of(body.species_names[name]);
      codes.push_back(of_name[name]);
    }
  }
  return codes;
}

Bodies copies(const std::vector<const BoundBody<double>*>& bodies) {
  Bodies all;
  for (const BoundBody<double>* body : bodies) all.push_back(*body);
  return all;
}

/// How far the nearest of all atoms are from each other at the start, or `most`.
double nearest_distance(const Bodies& bodies, const std::array<double, 3>& box, double most) {
  std::vector<std::array<double, 3>> all;
  for (const BoundBody<double>& body : bodies) {
    all.insert(all.end(), body.start.begin(), body.start.end());
  }
  std::vector<double> positions;
  for (std::size_t d = 0; d < 3; ++d) {
    for (const auto& at : all) positions.push_back(at[d]);
  }
  NeighbourSearch search(3, most, box);
  search.sort(positions, all.size());
  double nearest = most * most;
  std::vector<Neighbour> found;
  for (std::size_t i = 0; i < all.size(); ++i) {
    search.find(all[i], found);
    for (const Neighbour& near : found) {
      if (near.particle == i) continue;
      double squared = 0.0;
      for (std::size_t d = 0; d < 3; ++d) {
        const double apart = (all[near.particle][d] - all[i][d]) + near.shift[d];
        squared += apart * apart;
      }
      nearest = std::min(nearest, squared);
    }
  }
  return std::sqrt(nearest);
}

/// A model and what it needs to compute.
class ModelAtWork {
 public:
  ModelAtWork(const std::string& name, const Binding<double>& binding)
      : model(name),
        bodies(copies(binding.bodies)),
        around(binding.bodies, model.facts().reach(), binding.box),
        whole(model, codes_of(model, bodies)),
        part(model, codes_of(model, bodies)) {}

  /// The energy and the force on each atom at a stage. False where there are none.
  bool evaluate(const Stage<double>& stage) {
    failed = false;
    if (!around.update(stage)) return false;
    whole.assemble(around);
    if (!model.compute(whole.seen(), energy, seen_force_)) {
      failed = true;
      return false;
    }
    collect(whole, force);
    return true;
  }

  /// Adds the forces on images to their atoms.
  void collect(const Configuration& seen, std::vector<double>& on_atoms) {
    on_atoms.assign(3 * around.count(), 0.0);
    for (std::size_t k = 0; k < seen.seen().count(); ++k) {
      const std::size_t atom = seen.atom_of(k);
      for (std::size_t d = 0; d < 3; ++d) on_atoms[3 * atom + d] += seen_force_[3 * k + d];
    }
  }

  /// The forces that the energies near an atom make on all, when it has moved along an axis; what
  /// is not in these energies does not depend on the atom. `part` holds them. `move` becomes how
  /// far it has gone, rounded.
  bool evaluate_part(std::uint32_t atom, std::size_t axis, double& move,
                     std::vector<double>& on_atoms) {
    SeenParticles& seen = part.seen();
    unmoved_ = seen.positions;
    for (std::size_t k = 0; k < seen.count(); ++k) {
      if (part.atom_of(k) == atom) seen.positions[3 * k + axis] += move;
    }
    const auto itself = static_cast<std::size_t>(part.number_of(atom, {}));
    move = seen.positions[3 * itself + axis] - unmoved_[3 * itself + axis];
    double unused = 0.0;
    const bool done = model.compute(seen, unused, seen_force_);
    seen.positions.swap(unmoved_);
    if (done) collect(part, on_atoms);
    return done;
  }

  PortableModel model;
  Bodies bodies;
  Surroundings around;
  Configuration whole;
  Configuration part;
  bool failed = false;  ///< the model has returned an error
  double energy = 0.0;
  std::vector<double> force;  ///< [atom][axis]

 private:
  std::vector<double> seen_force_;
  std::vector<double> unmoved_;
};

class KimForce : public BoundForce<double>,
                 public Curvature<double>,
                 public Diagnosis<double>,
                 public CountsNeighbours {
 public:
  KimForce(const KimModelDescription& description, const Binding<double>& binding)
      : work_(std::make_unique<ModelAtWork>(description.model, binding)) {
    const Bodies& bodies = work_->bodies;
    for (std::size_t one = 0; one < bodies.size(); ++one) {
      for (std::size_t other = one; other < bodies.size(); ++other) {
        check_distances(starting(bodies[one]), starting(bodies[other]), 3, binding.box, kNearest,
                        "half an Angstrom");
      }
    }
    shortest_ = nearest_distance(bodies, binding.box, work_->model.facts().reach());
  }

  std::vector<Pass<double>> passes() override {
    Pass<double> pass;
    pass.add = &add;
    pass.arguments = work_.get();
    pass.rank = kRankTranscendental;
    for (const BoundBody<double>& body : work_->bodies) {
      if (body.coordinates != Coordinates::fixed) pass.writes.push_back({body.index, false});
    }
    return {pass};
  }

  double energy(const Stage<double>& stage) const override {
    return work_->evaluate(stage) ? work_->energy : kNoNumber;
  }

  /// By differences of forces, column by column. What the column of an atom holds are the energies
  /// that it is part of, so that the time grows linearly with the number of atoms.
  void hessian(const Stage<double>& stage, HessianSink& sink) const override {
    if (!work_->around.update(stage)) return;
    for (std::uint32_t atom = 0; atom < work_->around.count(); ++atom) {
      if (body_of(atom).coordinates == Coordinates::fixed) continue;
      work_->part.assemble_about(work_->around, atom);
      for (std::size_t axis = 0; axis < 3; ++axis) add_column(atom, axis, sink);
    }
  }

  double shortest_bond() const override { return shortest_; }

  std::string why_not_finite(const Stage<double>& stage) const override {
    const std::string the_model = fmt::format("the model \"{}\"", work_->model.name());
    if (!work_->evaluate(stage)) {
      if (!work_->failed) return {};
      const std::string& said = work_->model.error();
      return the_model + " has returned an error" + (said.empty() ? "" : ": " + said);
    }
    for (std::size_t atom = 0; atom < work_->around.count(); ++atom) {
      for (std::size_t d = 0; d < 3; ++d) {
        if (std::isfinite(work_->force[3 * atom + d])) continue;
        const BoundBody<double>& body = body_of(atom);
        return fmt::format("{} gives no finite force on {}", the_model,
                           name_of(starting(body), within_body(atom)));
      }
    }
    return {};
  }

  NeighbourCount count_neighbours() const override {
    NeighbourCount count = work_->around.neighbours();
    count.bytes += work_->whole.bytes() + work_->part.bytes();
    return count;
  }

 private:
  static void add(const void* arguments, const Stage<double>& stage) {
    ModelAtWork& work = *static_cast<ModelAtWork*>(const_cast<void*>(arguments));
    const bool done = work.evaluate(stage);
    for (std::size_t b = 0; b < work.bodies.size(); ++b) {
      if (work.bodies[b].coordinates == Coordinates::fixed) continue;
      const BodySlot<double>& slot = work.bodies[b].slot;
      double* f = (slot.mapped ? stage.mapped_force : stage.force) + slot.offset;
      for (std::size_t i = 0; i < slot.count; ++i) {
        for (std::size_t d = 0; d < 3; ++d) {
          const std::size_t from = 3 * (work.around.first_of(b) + i) + d;
          f[d * slot.stride + i] += done ? work.force[from] : kNoNumber;
        }
      }
    }
  }

  const BoundBody<double>& body_of(std::size_t atom) const {
    return work_->bodies[work_->around.body_of(atom)];
  }
  std::size_t within_body(std::size_t atom) const {
    return atom - work_->around.first_of(work_->around.body_of(atom));
  }

  void add_column(std::uint32_t atom, std::size_t axis, HessianSink& sink) const {
    double back = -kDifference;
    double ahead = kDifference;
    const bool done = work_->evaluate_part(atom, axis, back, behind_) &&
                      work_->evaluate_part(atom, axis, ahead, before_);
    // Each atom that is seen, once. What a model cannot compute has no second derivative.
    seen_.clear();
    for (std::size_t k = 0; k < work_->part.seen().count(); ++k) {
      seen_.push_back(work_->part.atom_of(k));
    }
    std::sort(seen_.begin(), seen_.end());
    seen_.erase(std::unique(seen_.begin(), seen_.end()), seen_.end());
    const std::size_t body = body_of(atom).index;
    for (const std::uint32_t other : seen_) {
      for (std::size_t d = 0; d < 3; ++d) {
        const std::size_t n = 3 * std::size_t{other} + d;
        const double value = done ? (behind_[n] - before_[n]) / (ahead - back) : kNoNumber;
        if (value == 0.0) continue;
        if (other == atom) {
          sink.site(body, within_body(atom), static_cast<int>(d), static_cast<int>(axis), value);
        } else {
          sink.block(body_of(other).index, within_body(other), static_cast<int>(d), body,
                     within_body(atom), static_cast<int>(axis), value);
        }
      }
    }
  }

  std::unique_ptr<ModelAtWork> work_;
  double shortest_ = 0.0;
  // Scratch for a column of second derivatives.
  mutable std::vector<double> behind_;
  mutable std::vector<double> before_;
  mutable std::vector<std::uint32_t> seen_;
};

}  // namespace

std::unique_ptr<BoundForce<double>> bind_model(const KimModelDescription& description,
                                               const Binding<double>& binding) {
  return std::make_unique<KimForce>(description, binding);
}

}  // namespace tomlin::kim
