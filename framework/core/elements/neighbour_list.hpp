#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "framework/core/elements/cutoff_arguments.hpp"
#include "framework/core/elements/neighbour_search.hpp"
#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/force.hpp"
#include "framework/core/records/neighbour_count.hpp"
#include "framework/core/system/aligned.hpp"

/// Neighbour lists of forces with a cutoff. A list holds all pairs within the cutoff and a skin
/// around it, and is made again when particles have moved by so much that a pair which is not in it
/// may have come within the cutoff. What a force makes of a list depends on the pairs within the
/// cutoff alone, so that no list is part of a run's state, and any place can be evaluated.
namespace tomlin {

/// The skin, in parts of the cutoff: between first and second neighbours of graphene there is room
/// for 0.17 beyond a cutoff of 2.1 Angstrom.
inline constexpr double kSkin = 0.15;
/// Of the reach, kept for the rounding of distances in numbers of type float.
inline constexpr double kReachMargin = 1e-4;

/// The skin of candidates: it takes a solid long to move by half of this.
inline constexpr double kCandidateSkin = 0.5;

/// How the neighbours of a list are found.
enum class Search {
  by_cells,   ///< whenever a list is made
  in_stages,  ///< among candidates, of which there are few; those by cells, which is seldom needed
};

/// How far is searched, in parts of the cutoff.
constexpr double reach_of(Search how) {
  return 1.0 + kReachMargin + (how == Search::in_stages ? kCandidateSkin : kSkin);
}

/// A complaint about a cutoff for which a periodic box is too short: of a pair there might be two
/// images within reach.
std::vector<Complaint> cutoff_complaints(const char* key, double cutoff, const SceneOutline& scene,
                                         Search how = Search::by_cells);

template <class Vector>
std::size_t bytes_of(const Vector& vector) {
  return vector.size() * sizeof(typename Vector::value_type);
}

/// The particles of a body where a run starts.
struct StartingParticles {
  std::size_t body = 0;
  std::string name;
  const std::vector<std::vector<double>>& place;  ///< [particle][axis]
  const std::vector<std::int32_t>& species;       ///< indices of names; empty: it has none
  std::span<const std::string> species_names;
};

template <class Real>
StartingParticles starting(const BoundBody<Real>& body) {
  return {body.index, body.name, body.start, body.species, body.species_names};
}

/// For messages: `particle 3 of "tube" (C)`.
std::string name_of(const StartingParticles& body, std::size_t particle);

/// Refuses a start at which two particles are nearer to each other than `least`, which is shorter
/// than any cutoff: the energy would be as large as in no experiment. The nearest pair is named,
/// and whether one body passes through the plane in which the other lies. Throws a BindError;
/// `why` says what `least` is.
void check_distances(const StartingParticles& one, const StartingParticles& other, int dimension,
                     const std::array<double, 3>& box, double least, const std::string& why);

/// Places at which a list was made.
class ListedPlaces {
 public:
  /// Those of all particles of a body at a stage.
  template <class Real>
  void take(const BodySlot<Real>& body, int dimension, const Stage<Real>& stage) {
    const Real* x = (body.mapped ? stage.mapped_position : stage.position) + body.offset;
    places_.resize(static_cast<std::size_t>(dimension) * body.count);
    for (int d = 0; d < dimension; ++d) {
      for (std::size_t i = 0; i < body.count; ++i) {
        places_[d * body.count + i] = static_cast<double>(x[d * body.stride + i]);
      }
    }
  }

  /// How far a particle has moved since then, at most.
  template <class Real>
  double largest_move(const BodySlot<Real>& body, int dimension, const Stage<Real>& stage) const {
    const Real* x = (body.mapped ? stage.mapped_position : stage.position) + body.offset;
    double largest = 0.0;
    for (std::size_t i = 0; i < body.count; ++i) {
      double squared = 0.0;
      for (int d = 0; d < dimension; ++d) {
        const double move =
            static_cast<double>(x[d * body.stride + i]) - places_[d * body.count + i];
        squared += move * move;
      }
      largest = squared > largest ? squared : largest;
    }
    return std::sqrt(largest);
  }

  const std::vector<double>& all() const { return places_; }
  std::size_t bytes() const { return bytes_of(places_); }
  std::array<double, 3> of(std::size_t particle, std::size_t count, int dimension) const {
    std::array<double, 3> place{};
    for (int d = 0; d < dimension; ++d) place[d] = places_[d * count + particle];
    return place;
  }

 private:
  std::vector<double> places_;  ///< [axis][particle]
};

/// The origin that the places of lists are relative to.
class ListedOrigin {
 public:
  explicit ListedOrigin(const Origin& origin) : cells_(origin.cells) {}

  /// True where it is another one.
  bool moved_to(const Origin& origin) {
    if (origin.cells == cells_) return false;
    cells_ = origin.cells;
    return true;
  }

 private:
  std::array<std::int64_t, 3> cells_;
};

/// When the list of neighbours that particles of one body have in another, or in the same, has to
/// be made again, and the search for them.
template <class Real>
class NeighbourFinder {
 public:
  NeighbourFinder(const BoundBody<Real>& one, const BoundBody<Real>& other, int dimension,
                  double cutoff, const std::array<double, 3>& box, Search how)
      : one_(one.slot),
        other_(other.slot),
        same_(one.index == other.index),
        one_fixed_(one.coordinates == Coordinates::fixed),
        other_fixed_(other.coordinates == Coordinates::fixed),
        dimension_(dimension),
        in_stages_(how == Search::in_stages),
        reach_(cutoff * (1.0 + kSkin + kReachMargin)),
        skin_(kSkin * cutoff),
        candidate_skin_(kCandidateSkin * cutoff),
        search_(dimension, cutoff * reach_of(how), box) {}

  /// True where a list that was made before may lack a pair; then the search is ready. Particles
  /// that are fixed are looked at after the origin has moved only.
  bool begin(const Stage<Real>& stage) {
    if (valid_ && moved(places_, others_, stage) < skin_) return false;
    const bool sorts =
        !valid_ || !in_stages_ ||
        !(moved(candidate_places_, candidate_others_, stage) < candidate_skin_ - skin_);
    places_.take(one_, dimension_, stage);
    if (!same_ && (!valid_ || !other_fixed_)) others_.take(other_, dimension_, stage);
    const bool first = !valid_;
    valid_ = true;
    if (!sorts) return true;
    if (first || same_ || !other_fixed_) {
      search_.sort(same_ ? places_.all() : others_.all(), other_.count);
    }
    if (in_stages_) find_candidates();
    return true;
  }
  void forget() { valid_ = false; }

  /// The neighbours of a particle, itself left out, in ascending order.
  const std::vector<Neighbour>& of(std::size_t particle) {
    if (!in_stages_) {
      find(particle);
      return found_;
    }
    found_.clear();
    const std::array<double, 3> here = places_.of(particle, one_.count, dimension_);
    const ListedPlaces& others = same_ ? places_ : others_;
    for (std::size_t k = candidate_start_[particle]; k < candidate_start_[particle + 1]; ++k) {
      const Neighbour& near = candidates_[k];
      const std::array<double, 3> there = others.of(near.particle, other_.count, dimension_);
      double squared = 0.0;
      for (std::size_t d = 0; d < 3; ++d) {
        const double apart = (there[d] - here[d]) + near.shift[d];
        squared += apart * apart;
      }
      if (squared <= reach_ * reach_) found_.push_back(near);
    }
    return found_;
  }

  std::size_t count() const { return one_.count; }
  std::size_t bytes() const {
    return places_.bytes() + others_.bytes() + candidate_places_.bytes() +
           candidate_others_.bytes() + bytes_of(candidates_) + bytes_of(candidate_start_) +
           search_.bytes();
  }

 private:
  double moved(const ListedPlaces& places, const ListedPlaces& others,
               const Stage<Real>& stage) const {
    const double one = one_fixed_ ? 0.0 : places.largest_move(one_, dimension_, stage);
    if (same_) return one + one;
    return other_fixed_ ? one : one + others.largest_move(other_, dimension_, stage);
  }

  void find(std::size_t particle) {
    search_.find(places_.of(particle, one_.count, dimension_), found_);
    if (!same_) return;
    const auto itself = std::find_if(found_.begin(), found_.end(), [&](const Neighbour& near) {
      return near.particle == particle;
    });
    if (itself != found_.end()) found_.erase(itself);
  }

  void find_candidates() {
    candidate_places_ = places_;
    candidate_others_ = others_;
    candidates_.clear();
    candidate_start_.assign(1, 0);
    for (std::size_t i = 0; i < one_.count; ++i) {
      find(i);
      candidates_.insert(candidates_.end(), found_.begin(), found_.end());
      candidate_start_.push_back(candidates_.size());
    }
  }

  BodySlot<Real> one_;
  BodySlot<Real> other_;
  bool same_;
  bool one_fixed_;
  bool other_fixed_;
  int dimension_;
  bool in_stages_;
  double reach_;
  double skin_;
  double candidate_skin_;
  bool valid_ = false;
  ListedPlaces places_;
  ListedPlaces others_;
  NeighbourSearch search_;
  std::vector<Neighbour> found_;
  ListedPlaces candidate_places_;
  ListedPlaces candidate_others_;
  std::vector<Neighbour> candidates_;
  std::vector<std::size_t> candidate_start_;
};

}  // namespace tomlin
