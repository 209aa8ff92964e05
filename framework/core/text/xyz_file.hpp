#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tomlin {

/// Letters, digits, _, -, + and parentheses, the first a letter or _, and at most 60 of them.
bool is_species_name(std::string_view name);

/// A frame of an extended XYZ file, or the faults that keep it from being read.
struct XyzFrame {
  std::size_t dimension = 3;
  std::vector<double> positions;     ///< [particle][axis]
  std::vector<double> velocities;    ///< the same; empty: the file has none
  std::vector<double> masses;        ///< [particle]; empty: the file has none
  std::vector<std::string> species;  ///< [particle]; empty: the file has none, or X ("none") alone
  std::vector<std::string> faults;   ///< "NAME:LINE: why", by line; of many the first ones
};

/// Frame number `frame` of the text, from 0 on; a negative number counts from the end, -1 is the
/// last. `name` stands in messages. A frame is
///
///   the number of particles
///   key=value ..., where Properties=species:S:1:pos:R:3:... names the columns; or any text
///   a line for each particle
///
/// Columns that are read are species, pos, velo (or vel, velocity, velocities) and mass (or
/// masses); others are skipped. Without Properties columns are a species and three coordinates, and
/// further ones are skipped. With `dimension=2`, which this program writes, only the first axes
/// count, and the others are zero.
///
/// The format is that of ASE and OVITO: https://github.com/libAtoms/extxyz, and
/// A. H. Larsen et al., J. Phys.: Condens. Matter 29 (2017) 273002, doi:10.1088/1361-648X/aa680e.
XyzFrame parse_xyz(std::string_view text, const std::string& name, std::int64_t frame);

}  // namespace tomlin
