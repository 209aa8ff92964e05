#pragma once

#include <filesystem>
#include <limits>
#include <string>

#include "framework/core/records/body.hpp"
#include "framework/core/text/words.hpp"

/// Particles anywhere: listed in the scene, or in a file of coordinates, or in one of extended XYZ
/// (framework/core/text/xyz_file.hpp), which may have their species, velocities and masses, too.
///
/// With outline = "closed" they are, in their order, the outline of a planar body: "neighbours"
/// joins the last to the first, and one turn without sliding advances it by the perimeter of the
/// polygon through them: see framework/bodies/outline.hpp.
namespace tomlin {

enum class ParticleOutline { open, closed };

constexpr auto word_table(ParticleOutline) {
  using enum ParticleOutline;
  return std::to_array<Word<ParticleOutline>>({{open, "open"}, {closed, "closed"}});
}

struct ParticlesDescription : BodyDescription {
  PointList positions;
  std::string file;  ///< empty once its positions are fetched: see read_from
  double frame = std::numeric_limits<double>::quiet_NaN();  ///< of extended XYZ; NaN: the last
  std::filesystem::path read_from;
  ParticleOutline outline = ParticleOutline::open;
};

BodyRecord particles_record();

}  // namespace tomlin
