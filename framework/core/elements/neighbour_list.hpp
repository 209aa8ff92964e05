#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "framework/core/elements/cutoff_arguments.hpp"
#include "framework/core/elements/neighbour_search.hpp"
#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/force.hpp"
#include "framework/core/system/aligned.hpp"

/// Neighbour lists of forces with a cutoff. A list holds all pairs within the cutoff and a skin
/// around it, and is made again when particles have moved by so much that a pair which is not in it
/// may have come within the cutoff. What a force makes of a list depends on the pairs within the
/// cutoff alone, so that no list is part of a run's state, and any position can be evaluated.
namespace tomlin {

/// The skin, in parts of the cutoff.
inline constexpr double kSkin = 0.15;
/// This part of the reach is kept for the rounding of distances.
inline constexpr double kReachMargin = 1e-4;

/// Skins of a dual list, in parts of the cutoff: the outer and the inner one. An outer list lasts
/// until a particle has moved by half of their difference. The inner one leaves the second
/// neighbours out, also where they vibrate: in graphene they are 0.19 cutoffs of 2.1 Angstrom
/// beyond it. In other materials they are just beyond the cutoff, as in silicon carbide by 0.03 of
/// it: there the inner list has the tight skin, and is made again every few steps.
inline constexpr double kOuterSkin = 0.5;
inline constexpr double kInnerSkin = 0.08;
inline constexpr double kTightSkin = 0.02;
/// The tight skin is taken where it saves this part of the work, which is as the square of the
/// number of neighbours.
inline constexpr double kTightSaves = 0.3;

/// How far a list reaches, and when it is made again.
struct ListReach {
  double reach = 0.0;
  double slack = 0.0;  ///< what two particles may approach each other by until then
};

/// Reach of a list that is searched by cells.
constexpr ListReach single_list(double cutoff) {
  return {cutoff * (1.0 + kSkin + kReachMargin), kSkin * cutoff};
}
/// Reach of a dual list's outer one.
constexpr ListReach outer_list(double cutoff) {
  return {cutoff * (1.0 + kOuterSkin + kReachMargin), (kOuterSkin - kInnerSkin) * cutoff};
}

/// A complaint about a cutoff for which a periodic box is too short: of a pair there might be two
/// images within reach.
std::vector<Complaint> cutoff_complaints(const char* key, double cutoff, const SceneOutline& scene,
                                         ListReach (*list)(double cutoff) = &single_list);

template <class Vector>
std::size_t bytes_of(const Vector& vector) {
  return vector.size() * sizeof(typename Vector::value_type);
}

/// The particles of a body where a run starts.
struct StartingParticles {
  std::size_t body = 0;
  std::string name;
  const std::vector<std::array<double, 3>>& positions;  ///< [particle][axis]
  const std::vector<std::int32_t>& species;             ///< indices of names; empty: it has none
  std::span<const std::string> species_names;
};

template <class Real>
StartingParticles starting(const BoundBody<Real>& body) {
  return {body.index, body.name, body.start, body.species, body.species_names};
}

/// For messages: `particle 3 of "tube" (C)`.
std::string name_of(const StartingParticles& body, std::size_t particle);

/// The species of a body's particles, each once, and which of them each particle is.
struct ListedSpecies {
  std::vector<std::string> names;
  std::vector<std::uint32_t> kind;  ///< [particle]

  template <class Real>
  explicit ListedSpecies(const BoundBody<Real>& body) : kind(body.slot.count, 0) {
    for (std::size_t i = 0; i < body.species.size(); ++i) {
      const std::string& name = body.species_names[static_cast<std::size_t>(body.species[i])];
      const auto known = std::find(names.begin(), names.end(), name);
      kind[i] = static_cast<std::uint32_t>(known - names.begin());
      if (known == names.end()) names.push_back(name);
    }
  }
};

/// Refuses a start at which two particles are nearer to each other than `least`, which is shorter
/// than any cutoff: the energy would be as large as in no experiment. The nearest pair is named,
/// and whether one body passes through the plane in which the other lies. Throws a BindError;
/// `why` says what `least` is.
void check_distances(const StartingParticles& one, const StartingParticles& other, int dimension,
                     const std::array<double, 3>& box, double least, const std::string& why);

/// Positions of a body's particles at which a list was made.
///
/// Two particles of a body that never moves show whether it is where it was: a stage has it where
/// the model puts it, which changes with the origin, or where whoever asks at positions of its own
/// has put it. It is compared as a whole, as others always are, where one of the two is elsewhere.
template <class Real>
class ListedPositions {
 public:
  ListedPositions(const BoundBody<Real>& body, int dimension)
      : body_(body.slot), fixed_(body.coordinates == Coordinates::fixed), dimension_(dimension) {}

  /// Returns the positions of all particles at a stage.
  void take(const Stage<Real>& stage) {
    const Real* x = first_of(stage);
    positions_.resize(static_cast<std::size_t>(dimension_) * body_.count);
    for (int d = 0; d < dimension_; ++d) {
      const Real* from = x + d * body_.stride;
      double* to = positions_.data() + d * body_.count;
      for (std::size_t i = 0; i < body_.count; ++i) to[i] = static_cast<double>(from[i]);
    }
  }

  /// How far a particle has moved since then, at most; infinite where one is, or was, at a position
  /// that is no finite number, as trial steps may have it: what is listed there lacks its pairs.
  double largest_move(const Stage<Real>& stage) const {
    const Real* x = first_of(stage);
    if (fixed_ && is_at(x, 0) && is_at(x, body_.count - 1)) return 0.0;
    // Eight at a time, which a compiler makes vectors of.
    double largest[kGroup] = {};
    double total[kGroup] = {};  // not finite if one of them is not
    const auto look = [&](std::size_t first, std::size_t particles) {
      double squared[kGroup] = {};
      for (int d = 0; d < dimension_; ++d) {
        const Real* now = x + d * body_.stride + first;
        const double* then = positions_.data() + d * body_.count + first;
        for (std::size_t l = 0; l < particles; ++l) {
          const double move = static_cast<double>(now[l]) - then[l];
          squared[l] += move * move;
        }
      }
      for (std::size_t l = 0; l < kGroup; ++l) {
        largest[l] = squared[l] > largest[l] ? squared[l] : largest[l];
        total[l] += squared[l];
      }
    };
    const std::size_t whole = body_.count / kGroup * kGroup;
    for (std::size_t i = 0; i < whole; i += kGroup) look(i, kGroup);
    if (whole < body_.count) look(whole, body_.count - whole);
    const bool finite =
        std::all_of(total, total + kGroup, [](double sum) { return std::isfinite(sum); });
    return finite ? std::sqrt(*std::max_element(largest, largest + kGroup))
                  : std::numeric_limits<double>::infinity();
  }

  std::size_t count() const { return body_.count; }
  /// [axis][particle]
  const std::vector<double>& all() const { return positions_; }
  std::size_t bytes() const { return bytes_of(positions_); }
  std::array<double, 3> of(std::size_t particle) const {
    std::array<double, 3> position{};
    for (int d = 0; d < dimension_; ++d) position[d] = positions_[d * body_.count + particle];
    return position;
  }

 private:
  const Real* first_of(const Stage<Real>& stage) const {
    return (body_.mapped ? stage.mapped_position : stage.position) + body_.offset;
  }
  bool is_at(const Real* x, std::size_t particle) const {
    bool same = true;
    for (int d = 0; d < dimension_; ++d) {
      same = same && static_cast<double>(x[d * body_.stride + particle]) ==
                         positions_[d * body_.count + particle];
    }
    return same;
  }

  BodySlot<Real> body_;
  bool fixed_;
  int dimension_;
  std::vector<double> positions_;
};

/// When the list of neighbours that particles of one body have in another, or in the same, has to
/// be made again, and the search for them.
template <class Real>
class NeighbourFinder {
 public:
  NeighbourFinder(const BoundBody<Real>& one, const BoundBody<Real>& other, int dimension,
                  const ListReach& list, const std::array<double, 3>& box)
      : same_(one.index == other.index),
        slack_(list.slack),
        positions_(one, dimension),
        others_(other, dimension),
        search_(dimension, list.reach, box) {}

  /// True where a list that was made before may lack a pair; then the search is ready.
  bool begin(const Stage<Real>& stage) {
    double others_moved = 0.0;
    if (valid_) {
      const double moved = positions_.largest_move(stage);
      others_moved = same_ ? moved : others_.largest_move(stage);
      if (moved + others_moved < slack_) return false;
    }
    positions_.take(stage);
    if (same_) {
      search_.sort(positions_.all(), positions_.count());
    } else if (!valid_ || others_moved > 0.0) {
      others_.take(stage);
      search_.sort(others_.all(), others_.count());
    }
    valid_ = true;
    return true;
  }

  /// The neighbours of a particle, itself left out, in ascending order.
  const std::vector<Neighbour>& of(std::size_t particle) {
    search_.find(positions_.of(particle), found_);
    if (!same_) return found_;
    const auto itself = std::find_if(found_.begin(), found_.end(), [&](const Neighbour& near) {
      return near.particle == particle;
    });
    if (itself != found_.end()) found_.erase(itself);
    return found_;
  }

  std::size_t count() const { return positions_.count(); }
  std::size_t bytes() const { return positions_.bytes() + others_.bytes() + search_.bytes(); }

 private:
  bool same_;
  double slack_;
  bool valid_ = false;
  ListedPositions<Real> positions_;
  ListedPositions<Real> others_;
  NeighbourSearch search_;
  std::vector<Neighbour> found_;
};

/// Shifts to the images of neighbours, of which there are few: each once, with a number.
class ImageShifts {
 public:
  std::uint32_t number_of(const std::array<double, 3>& shift) {
    const auto known = std::find(all_.begin(), all_.end(), shift);
    const auto number = static_cast<std::uint32_t>(known - all_.begin());
    if (known == all_.end()) all_.push_back(shift);
    return number;
  }
  const std::array<double, 3>& operator[](std::uint32_t number) const { return all_[number]; }
  std::size_t size() const { return all_.size(); }
  void clear() { all_.clear(); }
  std::size_t bytes() const { return bytes_of(all_); }

 private:
  std::vector<std::array<double, 3>> all_;
};

/// Cutoffs by the kinds of two particles.
struct PairCutoffs {
  std::span<const std::int64_t> kind;  ///< [particle]
  std::size_t kinds = 1;
  std::vector<double> all;  ///< [kind * kinds + kind], symmetric

  double longest() const { return *std::max_element(all.begin(), all.end()); }
  double shortest() const { return *std::min_element(all.begin(), all.end()); }
};

/// The neighbours that a body's particles have in it, by a dual list: outer ones, further away than
/// is needed, which are seldom searched for, and inner ones, found among them.
template <class Real>
class DualList {
 public:
  /// A neighbour of a particle, and the number of its image's shift.
  struct Entry {
    std::uint32_t particle = 0;
    std::uint32_t shift = 0;
  };

  DualList(const BoundBody<Real>& body, int dimension, const PairCutoffs& cutoffs,
           const std::array<double, 3>& box)
      : kind_(cutoffs.kind),
        kinds_(cutoffs.kinds),
        wide_(cutoffs, kInnerSkin),
        tight_(cutoffs, kTightSkin),
        positions_(body, dimension),
        finder_(body, body, dimension, outer_list(cutoffs.longest()), box),
        near_start_(body.slot.count + 1, 0) {}

  /// True where a neighbour is new or gone.
  bool update(const Stage<Real>& stage) {
    const double slack = is_tight_ ? tight_.slack : wide_.slack;
    if (valid_ && 2.0 * positions_.largest_move(stage) < slack) return false;
    valid_ = true;
    positions_.take(stage);
    const bool searched = finder_.begin(stage);
    if (searched) search();
    const bool changed = choose() || searched;
    if (changed) list();
    return changed;
  }

  std::size_t count() const { return positions_.count(); }
  /// In ascending order.
  std::span<const Entry> of(std::size_t particle) const {
    return {near_.data() + near_start_[particle],
            near_start_[particle + 1] - near_start_[particle]};
  }
  const std::array<double, 3>& shift_of(const Entry& near) const { return shifts_[near.shift]; }
  std::size_t bytes() const {
    return positions_.bytes() + finder_.bytes() + bytes_of(outer_start_) + bytes_of(outer_) +
           bytes_of(within_) + bytes_of(is_near_) + bytes_of(near_start_) + bytes_of(near_) +
           shifts_.bytes();
  }

 private:
  /// The cutoffs with a skin around them: a part of the shortest of them.
  struct Skin {
    Skin(const PairCutoffs& cutoffs, double part) : slack(part * cutoffs.shortest()) {
      for (const double cutoff : cutoffs.all) {
        const double reach = cutoff * (1.0 + kReachMargin) + slack;
        squared.push_back(reach * reach);
      }
    }
    double slack;
    std::vector<double> squared;  ///< of the reach, [kind * kinds + kind]
  };
  /// How near an outer neighbour is.
  enum Within : std::uint8_t { kNone, kWide, kTight };

  void search() {
    outer_.clear();
    outer_start_.assign(1, 0);
    shifts_.clear();
    for (std::size_t i = 0; i < count(); ++i) {
      for (const Neighbour& found : finder_.of(i)) {
        outer_.push_back({found.particle, shifts_.number_of(found.shift)});
      }
      outer_start_.push_back(static_cast<std::uint32_t>(outer_.size()));
    }
    within_.assign(outer_.size(), kNone);
    is_near_.assign(outer_.size(), 0);
  }

  /// Chooses the inner ones among the outer neighbours; returns true if they differ from before.
  bool choose() {
    double wide_work = 0.0;
    double tight_work = 0.0;
    for (std::size_t i = 0; i < count(); ++i) {
      const std::array<double, 3> here = positions_.of(i);
      const std::size_t kinds_of_i = static_cast<std::size_t>(kind_[i]) * kinds_;
      double wide = 0.0;
      double tight = 0.0;
      for (std::size_t k = outer_start_[i]; k < outer_start_[i + 1]; ++k) {
        const std::array<double, 3> there = positions_.of(outer_[k].particle);
        const std::array<double, 3>& shift = shifts_[outer_[k].shift];
        double squared = 0.0;
        for (std::size_t d = 0; d < 3; ++d) {
          const double apart = (there[d] - here[d]) + shift[d];
          squared += apart * apart;
        }
        const std::size_t kinds = kinds_of_i + static_cast<std::size_t>(kind_[outer_[k].particle]);
        const bool is_wide = squared <= wide_.squared[kinds];
        const bool is_tight = squared <= tight_.squared[kinds];
        within_[k] = is_tight ? kTight : is_wide ? kWide : kNone;
        wide += is_wide ? 1.0 : 0.0;
        tight += is_tight ? 1.0 : 0.0;
      }
      wide_work += wide * wide;
      tight_work += tight * tight;
    }
    is_tight_ = wide_work - tight_work > kTightSaves * wide_work;
    const Within least = is_tight_ ? kTight : kWide;
    unsigned changed = 0;
    for (std::size_t k = 0; k < within_.size(); ++k) {
      const auto near = static_cast<std::uint8_t>(within_[k] >= least);
      changed |= static_cast<unsigned>(near ^ is_near_[k]);
      is_near_[k] = near;
    }
    return changed != 0;
  }

  void list() {
    near_.clear();
    near_start_.assign(1, 0);
    for (std::size_t i = 0; i < count(); ++i) {
      for (std::size_t k = outer_start_[i]; k < outer_start_[i + 1]; ++k) {
        if (is_near_[k] != 0) near_.push_back(outer_[k]);
      }
      near_start_.push_back(static_cast<std::uint32_t>(near_.size()));
    }
  }

  std::span<const std::int64_t> kind_;
  std::size_t kinds_;
  Skin wide_;
  Skin tight_;
  bool is_tight_ = false;
  bool valid_ = false;
  ListedPositions<Real> positions_;
  NeighbourFinder<Real> finder_;
  ImageShifts shifts_;
  std::vector<std::uint32_t> outer_start_;  ///< [particle + 1]
  std::vector<Entry> outer_;
  std::vector<Within> within_;             ///< [outer]
  std::vector<std::uint8_t> is_near_;      ///< [outer]
  std::vector<std::uint32_t> near_start_;  ///< [particle + 1]
  std::vector<Entry> near_;
};

}  // namespace tomlin
