#include "framework/plugin/kim/kim_surroundings.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tomlin::kim {
namespace {

/// Factor of distances that allows for rounding: models compare them once more.
constexpr double kRoundingMargin = 1.0 + 1e-9;
/// Factor of distances where positions are about to move.
constexpr double kMovementMargin = 1.02;

constexpr int kImageBits = 8;
constexpr int kMiddleImage = 1 << (kImageBits - 1);

std::uint64_t key_of(std::uint32_t particle, const Image& image) {
  std::uint64_t key = particle;
  for (const std::int8_t cells : image) {
    key = (key << kImageBits) | static_cast<std::uint64_t>(cells + kMiddleImage);
  }
  return key;
}

std::uint32_t particle_in(std::uint64_t key) {
  return static_cast<std::uint32_t>(key >> (3 * kImageBits));
}

Image image_in(std::uint64_t key) {
  Image image;
  for (int d = 2; d >= 0; --d, key >>= kImageBits) {
    constexpr std::uint64_t kMask = (1U << kImageBits) - 1;
    image[static_cast<std::size_t>(d)] =
        static_cast<std::int8_t>(static_cast<int>(key & kMask) - kMiddleImage);
  }
  return image;
}

/// Number of an image that is in the box or next to it, from 0 to 26.
int number_around(const Image& image) {
  return (image[0] + 1) * 9 + (image[1] + 1) * 3 + (image[2] + 1);
}

double distance_squared(const double* one, const double* other) {
  double squared = 0.0;
  for (int d = 0; d < 3; ++d) squared += (other[d] - one[d]) * (other[d] - one[d]);
  return squared;
}

}  // namespace

Surroundings::Surroundings(const std::vector<const BoundBody<double>*>& bodies, double reach,
                           const std::array<double, 3>& box)
    : box_(box) {
  for (const BoundBody<double>* body : bodies) {
    first_.push_back(body_of_.size());
    body_of_.insert(body_of_.end(), body->slot.count, static_cast<std::uint32_t>(bodies_.size()));
    bodies_.push_back(*body);
  }
  for (const BoundBody<double>& one : bodies_) {
    for (const BoundBody<double>& other : bodies_) {
      finders_.emplace_back(one, other, 3, single_list(reach), box);
    }
  }
  rows_.resize(finders_.size());
  position_.resize(3 * count());
  cell_.resize(3 * count());
}

bool Surroundings::update(const Stage<double>& stage) {
  bool finite = true;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const BodySlot<double>& slot = bodies_[b].slot;
    const double* x = (slot.mapped ? stage.mapped_position : stage.position) + slot.offset;
    for (std::size_t i = 0; i < slot.count; ++i) {
      for (std::size_t d = 0; d < 3; ++d) {
        const double at = x[d * slot.stride + i];
        const double cells = box_[d] > 0.0 ? std::floor(at / box_[d]) : 0.0;
        finite = finite && std::abs(at) < 1e15 && std::abs(cells) < 1e15;
        if (!finite) return false;
        position_[3 * (first_[b] + i) + d] = at - cells * box_[d];
        cell_[3 * (first_[b] + i) + d] = static_cast<std::int64_t>(cells);
      }
    }
  }
  for (std::size_t one = 0; one < bodies_.size(); ++one) {
    for (std::size_t other = 0; other < bodies_.size(); ++other) {
      if (finders_[one * bodies_.size() + other].begin(stage)) make_rows(one, other);
    }
  }
  return true;
}

void Surroundings::make_rows(std::size_t one, std::size_t other) {
  NeighbourFinder<double>& finder = finders_[one * bodies_.size() + other];
  Rows& rows = rows_[one * bodies_.size() + other];
  rows.start.assign(1, 0);
  rows.near.clear();
  for (std::size_t i = 0; i < bodies_[one].slot.count; ++i) {
    for (const Neighbour& found : finder.of(i)) {
      Near near;
      near.particle = static_cast<std::uint32_t>(first_[other] + found.particle);
      // Images belong to the positions as they are, not as they are taken into the box.
      for (std::size_t d = 0; d < 3; ++d) {
        if (box_[d] > 0.0)
          near.image[d] = static_cast<std::int8_t>(std::lround(found.shift[d] / box_[d]));
      }
      rows.near.push_back(near);
    }
    rows.start.push_back(rows.near.size());
  }
}

NeighbourCount Surroundings::neighbours() const {
  NeighbourCount all;
  std::vector<std::size_t> each(count(), 0);
  std::uint64_t neighbours = 0;
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const Rows& rows = rows_[k];
    all.bytes += finders_[k].bytes() + bytes_of(rows.start) + bytes_of(rows.near);
    for (std::size_t i = 0; i + 1 < rows.start.size(); ++i) {
      const std::size_t found = rows.start[i + 1] - rows.start[i];
      each[first_[k / bodies_.size()] + i] += found;
      neighbours += found;
    }
  }
  for (const std::size_t found : each) all.most = std::max(all.most, found);
  all.pairs = neighbours / 2;
  all.mean = static_cast<double>(neighbours) / static_cast<double>(count());
  return all;
}

Configuration::Configuration(const PortableModel& model, std::vector<int> codes)
    : reach_(model.facts().reach()), cutoffs_(model.facts().cutoffs), codes_(std::move(codes)) {
  for (std::size_t k = 0; k < cutoffs_.size(); ++k) {
    asks_around_others_.push_back(model.asks_around_others(k));
  }
  seen_.lists.resize(cutoffs_.size());
}

void Configuration::assemble(const Surroundings& around) {
  whole_ = true;
  contributing_.resize(around.count());
  for (std::uint32_t i = 0; i < around.count(); ++i) contributing_[i] = key_of(i, {});
  see_others(around, kRoundingMargin * reach_);
  place_all(around);
  list_neighbours(around, kRoundingMargin);
}

void Configuration::assemble_about(const Surroundings& around, std::uint32_t particle) {
  whole_ = false;
  contributing_.assign(1, key_of(particle, {}));
  around.for_neighbours(particle, {}, [&](std::uint32_t other, const Image& image) {
    contributing_.push_back(key_of(other, image));
  });
  std::sort(contributing_.begin(), contributing_.end());
  see_others(around, kMovementMargin * reach_);
  place_all(around);
  list_neighbours(around, kMovementMargin);
}

/// Adds all within reach of those that contribute. If all do, the images are those around the
/// box, and each is noted once.
void Configuration::see_others(const Surroundings& around, double reach) {
  others_.clear();
  noted_.assign(around.count(), 0);
  for (const Key key : contributing_) {
    const std::uint32_t particle = particle_in(key);
    const Image image = image_in(key);
    const std::array<double, 3> here = around.position(particle, image);
    around.for_neighbours(particle, image, [&](std::uint32_t other, const Image& seen) {
      if (whole_ && seen == Image{}) return;
      const std::uint32_t bit = whole_ ? 1U << number_around(seen) : 0U;
      if ((noted_[other] & bit) != 0) return;
      if (distance_squared(here.data(), around.position(other, seen).data()) > reach * reach)
        return;
      const Key found = key_of(other, seen);
      if (!whole_ && std::binary_search(contributing_.begin(), contributing_.end(), found)) return;
      noted_[other] |= bit;
      others_.push_back(found);
    });
  }
  std::sort(others_.begin(), others_.end());
  others_.erase(std::unique(others_.begin(), others_.end()), others_.end());
  first_other_.assign(around.count() + 1, 0);
  for (const Key key : others_) ++first_other_[particle_in(key) + 1];
  for (std::size_t i = 0; i < around.count(); ++i) first_other_[i + 1] += first_other_[i];
}

void Configuration::place_all(const Surroundings& around) {
  seen_.species.clear();
  seen_.contributing.clear();
  seen_.positions.clear();
  particle_of_.clear();
  image_of_.clear();
  const auto add = [&](const std::vector<Key>& keys, int contributes) {
    for (const Key key : keys) {
      particle_of_.push_back(particle_in(key));
      image_of_.push_back(image_in(key));
      seen_.species.push_back(codes_[particle_of_.back()]);
      seen_.contributing.push_back(contributes);
      const std::array<double, 3> at = around.position(particle_of_.back(), image_of_.back());
      seen_.positions.insert(seen_.positions.end(), at.begin(), at.end());
    }
  };
  add(contributing_, 1);
  add(others_, 0);
}

std::ptrdiff_t Configuration::number_of(std::uint32_t particle, const Image& image) const {
  if (whole_ && image == Image{}) return particle;
  const Key key = key_of(particle, image);
  if (!whole_) {
    const auto at = std::lower_bound(contributing_.begin(), contributing_.end(), key);
    if (at != contributing_.end() && *at == key) return at - contributing_.begin();
  }
  for (std::size_t k = first_other_[particle]; k < first_other_[particle + 1]; ++k) {
    if (others_[k] == key) return static_cast<std::ptrdiff_t>(contributing_.size() + k);
  }
  return -1;
}

void Configuration::list_neighbours(const Surroundings& around, double room) {
  double longest = 0.0;
  for (std::size_t list = 0; list < cutoffs_.size(); ++list) {
    seen_.lists[list].start.assign(1, 0);
    seen_.lists[list].neighbours.clear();
    longest = std::max(longest, cutoffs_[list]);
  }
  const bool others = std::find(asks_around_others_.begin(), asks_around_others_.end(), true) !=
                      asks_around_others_.end();
  const std::size_t listed = others ? seen_.count() : contributing_.size();
  for (std::size_t i = 0; i < listed; ++i) {
    const double* here = seen_.positions.data() + 3 * i;
    around.for_neighbours(
        particle_of_[i], image_of_[i], [&](std::uint32_t other, const Image& image) {
          const std::array<double, 3> there = around.position(other, image);
          const double squared = distance_squared(here, there.data()) / (room * room);
          if (squared > longest * longest) return;
          const std::ptrdiff_t j = number_of(other, image);
          if (j < 0) return;
          for (std::size_t list = 0; list < cutoffs_.size(); ++list) {
            if (squared > cutoffs_[list] * cutoffs_[list]) continue;
            seen_.lists[list].neighbours.push_back(static_cast<int>(j));
          }
        });
    for (std::size_t list = 0; list < cutoffs_.size(); ++list) {
      if (i >= contributing_.size() && !asks_around_others_[list]) {
        seen_.lists[list].neighbours.resize(seen_.lists[list].start.back());
        continue;
      }
      seen_.lists[list].start.push_back(seen_.lists[list].neighbours.size());
    }
  }
}

std::size_t Configuration::bytes() const {
  std::size_t bytes = bytes_of(codes_) + bytes_of(contributing_) + bytes_of(others_) +
                      bytes_of(first_other_) + bytes_of(noted_) + bytes_of(particle_of_) +
                      bytes_of(image_of_) + bytes_of(seen_.species) + bytes_of(seen_.contributing) +
                      bytes_of(seen_.positions);
  for (const ModelList& list : seen_.lists) {
    bytes += bytes_of(list.start) + bytes_of(list.neighbours);
  }
  return bytes;
}

}  // namespace tomlin::kim
