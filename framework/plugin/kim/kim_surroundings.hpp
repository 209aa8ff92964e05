#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "framework/core/elements/neighbour_list.hpp"
#include "framework/core/records/bound_force.hpp"
#include "framework/plugin/kim/kim_library.hpp"

/// The atoms of several bodies as one configuration, of which a model sees what is near.
namespace tomlin::kim {

/// Numbers of lengths of the box, along each axis.
using Image = std::array<std::int8_t, 3>;

/// The neighbours of each atom among all atoms, those of the first body first, in ascending order:
/// a list of each body in each, by the neighbour service of the engine.
class Surroundings {
 public:
  struct Near {
    std::uint32_t particle = 0;
    Image image{};  ///< of it, that is near
  };

  Surroundings(const std::vector<const BoundBody<double>*>& bodies, double reach,
               const std::array<double, 3>& box);

  /// Takes the positions of all atoms at a stage, and makes lists that may lack a neighbour again.
  /// False where a position is no finite number: then there is nothing to be had.
  bool update(const Stage<double>& stage);

  std::size_t count() const { return body_of_.size(); }
  std::size_t body_of(std::size_t particle) const { return body_of_[particle]; }
  std::size_t first_of(std::size_t body) const { return first_[body]; }
  NeighbourCount neighbours() const;

  /// Position of an image of an atom. Its own image is the one taken into the box by whole lengths.
  std::array<double, 3> position(std::uint32_t particle, const Image& image) const {
    std::array<double, 3> at{};
    for (std::size_t d = 0; d < 3; ++d) {
      at[d] = position_[3 * std::size_t{particle} + d] + static_cast<double>(image[d]) * box_[d];
    }
    return at;
  }

  /// use(particle, image): all within reach of an image of an atom, and some that are not.
  template <class Use>
  void for_neighbours(std::uint32_t particle, const Image& image, Use&& use) const {
    const std::size_t body = body_of_[particle];
    const std::size_t row = particle - first_[body];
    for (std::size_t other = 0; other < bodies_.size(); ++other) {
      const Rows& rows = rows_[body * bodies_.size() + other];
      for (std::size_t k = rows.start[row]; k < rows.start[row + 1]; ++k) {
        const Near& near = rows.near[k];
        Image seen;
        for (std::size_t d = 0; d < 3; ++d) {
          const std::int64_t cells =
              cell_[3 * std::size_t{near.particle} + d] - cell_[3 * std::size_t{particle} + d];
          seen[d] = static_cast<std::int8_t>(image[d] + near.image[d] + cells);
        }
        use(near.particle, seen);
      }
    }
  }

 private:
  struct Rows {
    std::vector<std::size_t> start;
    std::vector<Near> near;  ///< with the image of it that is near to where the atom itself is
  };

  void make_rows(std::size_t one, std::size_t other);

  std::vector<BoundBody<double>> bodies_;
  std::array<double, 3> box_;
  std::vector<std::size_t> first_;                ///< atom of each body
  std::vector<std::uint32_t> body_of_;            ///< [atom]
  std::vector<NeighbourFinder<double>> finders_;  ///< [one body][another]
  std::vector<Rows> rows_;
  std::vector<double> position_;    ///< [atom][axis], within the box
  std::vector<std::int64_t> cell_;  ///< [atom][axis]: so many lengths of the box were taken off
};

/// A model's view of the surroundings, for the energies of all atoms or of some. Particles of
/// other images, and those that are there for others' sake, come behind, in ascending order; so do
/// neighbours. It follows from the positions alone: a list that holds more than it needs to, since
/// it was made earlier or later, changes nothing.
class Configuration {
 public:
  Configuration(const PortableModel& model, std::vector<int> codes);

  /// The energies of all atoms.
  void assemble(const Surroundings& around);
  /// The energies of all atoms that one is near to, itself among them; positions may then move by a
  /// little.
  void assemble_about(const Surroundings& around, std::uint32_t particle);

  const SeenParticles& seen() const { return seen_; }
  SeenParticles& seen() { return seen_; }
  /// The atom that a particle is an image of.
  std::uint32_t atom_of(std::size_t seen) const { return particle_of_[seen]; }
  /// Index of an image among the particles; -1: it is not seen.
  std::ptrdiff_t number_of(std::uint32_t particle, const Image& image) const;
  std::size_t bytes() const;

 private:
  using Key = std::uint64_t;  ///< of an atom's image; ascends with the atom, then with the image

  void see_others(const Surroundings& around, double reach);
  void place_all(const Surroundings& around);
  void list_neighbours(const Surroundings& around, double room);

  double reach_;
  std::vector<double> cutoffs_;
  std::vector<bool> asks_around_others_;
  std::vector<int> codes_;  ///< [atom]
  bool whole_ = false;      ///< all atoms contribute
  std::vector<Key> contributing_;
  std::vector<Key> others_;
  std::vector<std::size_t> first_other_;  ///< [atom]: where its images begin among the others
  std::vector<std::uint32_t> noted_;      ///< [atom]: which of 27 images are among the others
  std::vector<std::uint32_t> particle_of_;
  std::vector<Image> image_of_;
  SeenParticles seen_;
};

}  // namespace tomlin::kim
