#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "framework/output/hdf5_file.hpp"
#include "framework/output/trajectory.hpp"

namespace tomlin {

/// Dimension and units of the numbers of a dataset.
struct NumbersOfDataset {
  Dimension dimension;
  UnitSystem units = UnitSystem::reduced;
};

/// Numbers of each frame, in a dataset [frame][row][axis] (or fewer dimensions) that grows. It is
/// made when the first chunk is full, or at the end, so that short runs leave short files.
template <class Number>
class Hdf5Series {
 public:
  /// `shape` is that of one frame. Complaints, and the dataset's attributes `dimension` and `unit`,
  /// if any, go by the arguments.
  Hdf5Series(const Hdf5File& file, std::string name, std::vector<hsize_t> shape,
             const NumbersOfDataset& numbers);

  /// Makes room for the next frame, to be filled by the caller.
  std::span<Number> next(hid_t group);
  /// Everything is in the file. Throws OutputError, as next() does.
  void finish(hid_t group);

 private:
  void make_dataset(hid_t group);
  void flush(hid_t group);

  const Hdf5File& file_;
  std::string name_;
  std::vector<hsize_t> shape_;
  NumbersOfDataset numbers_;
  std::size_t per_frame_;
  std::size_t most_frames_;  ///< that are held before they are written: a chunk
  std::vector<Number> held_;
  hsize_t written_ = 0;  ///< frames
  Hdf5Handle dataset_;
};

extern template class Hdf5Series<double>;
extern template class Hdf5Series<std::int64_t>;

/// Bytes of a file at most: one frame each, and what a file has besides.
double h5md_bytes_per_frame(const RunLayout& layout);
double h5md_bytes_besides(const RunLayout& layout, const TrajectoryFacts& facts);

/// A trajectory in H5MD 1.1 (nongnu.org/h5md; P. de Buyl, P. H. Colberg, F. Hoefling, Comput. Phys.
/// Commun. 185 (2014) 1546, doi:10.1016/j.cpc.2014.01.018), in double precision:
///
///   /h5md                      version, author, creator; modules/units
///   /particles/all             all bodies, one after another
///     position/{step,time,value[frame][particle][3]}
///     box                      dimension, boundary; edges/{step,time,value} where it is periodic
///     mass, species, id        of each particle; the species is the index of its body
///     body                     where bodies have species: the same, and species that of a name
///   /parameters                attributes name and source of the scene; the scene itself
///     bodies                   names of the bodies
///     species                  names of the species, where bodies have any; X of those that have
///     none
///
/// Positions have three axes whatever the scene has, the missing ones zero, and edges come with
/// every frame, since MDAnalysis reads nothing else. `step` counts samples. Datasets carry
/// `dimension`, say "length". /h5md/modules/units names the `system` of units. "reduced" ones have
/// no symbols, and no `unit`, since MDAnalysis refuses files with one that it does not know; those
/// of "metal" are "Angstrom", "ps" and "u", the first two as MDAnalysis reads them. (The system
/// "SI" that the module defines has no Angstrom.) Strings of any length, since h5py gives others as
/// bytes, which MDAnalysis does not look up. Whose run it was is not known to the program. The same
/// rows give the same bytes.
class H5mdWriter : public TrajectoryWriter {
 public:
  H5mdWriter(const std::filesystem::path& file, const RunLayout& layout,
             const TrajectoryFacts& facts);
  ~H5mdWriter() override;

  void finish() override;

 private:
  void write(double time, std::span<const double> positions) override;
  void describe_file(const TrajectoryFacts& facts);
  void describe_scene(const TrajectoryFacts& facts);
  void list_particles(hid_t all, UnitSystem units);
  void describe_box(hid_t all);

  Hdf5File hdf5_;
  const TrajectoryBox box_;
  Hdf5Handle position_;  ///< group
  Hdf5Handle edges_;     ///< group, where the box is periodic
  Hdf5Series<double> positions_;
  Hdf5Series<double> times_;
  Hdf5Series<std::int64_t> steps_;
  Hdf5Series<double> lengths_;  ///< of the box
};

}  // namespace tomlin
