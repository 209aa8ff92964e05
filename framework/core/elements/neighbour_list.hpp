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
#include "framework/core/records/neighbour_count.hpp"
#include "framework/core/system/aligned.hpp"

/// Neighbour lists of forces with a cutoff. A list holds all pairs within the cutoff and a skin
/// around it, and is made again when particles have moved by so much that a pair which is not in it
/// may have come within the cutoff. What a force makes of a list depends on the pairs within the
/// cutoff alone, so that no list is part of a run's state, and any place can be evaluated.
namespace tomlin {

/// The skin, in parts of the cutoff.
inline constexpr double kSkin = 0.15;
/// Of the reach, kept for the rounding of distances in numbers of type float.
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

/// Of a list that is searched by cells.
constexpr ListReach single_list(double cutoff) {
  return {cutoff * (1.0 + kSkin + kReachMargin), kSkin * cutoff};
}
/// Of a dual list's outer one.
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
  const std::vector<std::array<double, 3>>& place;  ///< [particle][axis]
  const std::vector<std::int32_t>& species;         ///< indices of names; empty: it has none
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
    apart_ = body.count;
    places_.resize(static_cast<std::size_t>(dimension) * apart_);
    for (int d = 0; d < dimension; ++d) {
      const Real* from = x + d * body.stride;
      double* to = places_.data() + d * apart_;
      for (std::size_t i = 0; i < apart_; ++i) to[i] = static_cast<double>(from[i]);
    }
  }

  /// How far a particle has moved since then, at most; infinite where one is, or was, at a place
  /// that is no finite number, as trial steps may have it: what is listed there lacks its pairs.
  template <class Real>
  double largest_move(const BodySlot<Real>& body, int dimension, const Stage<Real>& stage) const {
    const Real* x = (body.mapped ? stage.mapped_position : stage.position) + body.offset;
    // Eight at a time, which a compiler makes vectors of.
    double largest[kGroup] = {};
    double total[kGroup] = {};  // not finite if one of them is not
    const auto look = [&](std::size_t first, std::size_t particles) {
      double squared[kGroup] = {};
      for (int d = 0; d < dimension; ++d) {
        const Real* now = x + d * body.stride + first;
        const double* then = places_.data() + d * apart_ + first;
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
    const std::size_t whole = apart_ / kGroup * kGroup;
    for (std::size_t i = 0; i < whole; i += kGroup) look(i, kGroup);
    if (whole < apart_) look(whole, apart_ - whole);
    const bool finite =
        std::all_of(total, total + kGroup, [](double sum) { return std::isfinite(sum); });
    return finite ? std::sqrt(*std::max_element(largest, largest + kGroup))
                  : std::numeric_limits<double>::infinity();
  }

  /// [axis][particle]
  const std::vector<double>& all() const { return places_; }
  std::size_t bytes() const { return bytes_of(places_); }
  std::array<double, 3> of(std::size_t particle, int dimension) const {
    std::array<double, 3> place{};
    for (int d = 0; d < dimension; ++d) place[d] = places_[d * apart_ + particle];
    return place;
  }

 private:
  std::size_t apart_ = 0;  ///< particles
  std::vector<double> places_;
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
                  const ListReach& list, const std::array<double, 3>& box)
      : one_(one.slot),
        other_(other.slot),
        same_(one.index == other.index),
        one_fixed_(one.coordinates == Coordinates::fixed),
        other_fixed_(other.coordinates == Coordinates::fixed),
        dimension_(dimension),
        slack_(list.slack),
        search_(dimension, list.reach, box) {}

  /// True where a list that was made before may lack a pair; then the search is ready. Particles
  /// that are fixed are looked at after the origin has moved only.
  bool begin(const Stage<Real>& stage) {
    if (valid_ && moved(stage) < slack_) return false;
    places_.take(one_, dimension_, stage);
    if (!same_ && (!valid_ || !other_fixed_)) others_.take(other_, dimension_, stage);
    if (!valid_ || same_ || !other_fixed_) {
      search_.sort(same_ ? places_.all() : others_.all(), other_.count);
    }
    valid_ = true;
    return true;
  }
  void forget() { valid_ = false; }

  /// The neighbours of a particle, itself left out, in ascending order.
  const std::vector<Neighbour>& of(std::size_t particle) {
    search_.find(places_.of(particle, dimension_), found_);
    if (!same_) return found_;
    const auto itself = std::find_if(found_.begin(), found_.end(), [&](const Neighbour& near) {
      return near.particle == particle;
    });
    if (itself != found_.end()) found_.erase(itself);
    return found_;
  }

  std::size_t count() const { return one_.count; }
  std::size_t bytes() const { return places_.bytes() + others_.bytes() + search_.bytes(); }

 private:
  double moved(const Stage<Real>& stage) const {
    const double one = one_fixed_ ? 0.0 : places_.largest_move(one_, dimension_, stage);
    if (same_) return one + one;
    return other_fixed_ ? one : one + others_.largest_move(other_, dimension_, stage);
  }

  BodySlot<Real> one_;
  BodySlot<Real> other_;
  bool same_;
  bool one_fixed_;
  bool other_fixed_;
  int dimension_;
  double slack_;
  bool valid_ = false;
  ListedPlaces places_;
  ListedPlaces others_;
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
      : body_(body.slot),
        dimension_(dimension),
        kind_(cutoffs.kind),
        kinds_(cutoffs.kinds),
        wide_(cutoffs, kInnerSkin),
        tight_(cutoffs, kTightSkin),
        finder_(body, body, dimension, outer_list(cutoffs.longest()), box),
        near_start_(body.slot.count + 1, 0) {}

  /// True where a neighbour is new or gone.
  bool update(const Stage<Real>& stage) {
    const double slack = is_tight_ ? tight_.slack : wide_.slack;
    if (valid_ && 2.0 * places_.largest_move(body_, dimension_, stage) < slack) return false;
    valid_ = true;
    places_.take(body_, dimension_, stage);
    const bool searched = finder_.begin(stage);
    if (searched) search();
    const bool changed = choose() || searched;
    if (changed) list();
    return changed;
  }
  void forget() {
    valid_ = false;
    finder_.forget();
  }

  std::size_t count() const { return body_.count; }
  /// In ascending order.
  std::span<const Entry> of(std::size_t particle) const {
    return {near_.data() + near_start_[particle],
            near_start_[particle + 1] - near_start_[particle]};
  }
  const std::array<double, 3>& shift_of(const Entry& near) const { return shifts_[near.shift]; }
  std::size_t bytes() const {
    return places_.bytes() + finder_.bytes() + bytes_of(outer_start_) + bytes_of(outer_) +
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
    for (std::size_t i = 0; i < body_.count; ++i) {
      for (const Neighbour& found : finder_.of(i)) {
        outer_.push_back({found.particle, shifts_.number_of(found.shift)});
      }
      outer_start_.push_back(static_cast<std::uint32_t>(outer_.size()));
    }
    within_.assign(outer_.size(), kNone);
    is_near_.assign(outer_.size(), 0);
  }

  /// Which of the outer neighbours are inner ones; true where it is another than before.
  bool choose() {
    double wide_work = 0.0;
    double tight_work = 0.0;
    for (std::size_t i = 0; i < body_.count; ++i) {
      const std::array<double, 3> here = places_.of(i, dimension_);
      const std::size_t kinds_of_i = static_cast<std::size_t>(kind_[i]) * kinds_;
      double wide = 0.0;
      double tight = 0.0;
      for (std::size_t k = outer_start_[i]; k < outer_start_[i + 1]; ++k) {
        const std::array<double, 3> there = places_.of(outer_[k].particle, dimension_);
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
    for (std::size_t i = 0; i < body_.count; ++i) {
      for (std::size_t k = outer_start_[i]; k < outer_start_[i + 1]; ++k) {
        if (is_near_[k] != 0) near_.push_back(outer_[k]);
      }
      near_start_.push_back(static_cast<std::uint32_t>(near_.size()));
    }
  }

  BodySlot<Real> body_;
  int dimension_;
  std::span<const std::int64_t> kind_;
  std::size_t kinds_;
  Skin wide_;
  Skin tight_;
  bool is_tight_ = false;
  bool valid_ = false;
  ListedPlaces places_;
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
