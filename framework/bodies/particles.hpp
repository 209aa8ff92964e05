#pragma once

#include <filesystem>
#include <string>

#include "framework/core/records/body.hpp"
#include "framework/core/text/words.hpp"

/// Particles anywhere: listed in the scene, or in a file of coordinates.
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
  std::filesystem::path read_from;
  ParticleOutline outline = ParticleOutline::open;
};

BodyRecord particles_record();

}  // namespace tomlin
