#include "framework/bodies/register_bodies.hpp"

#include "framework/bodies/chain.hpp"
#include "framework/bodies/ellipse.hpp"
#include "framework/bodies/flake.hpp"
#include "framework/bodies/graphene.hpp"
#include "framework/bodies/nanotube.hpp"
#include "framework/bodies/particles.hpp"
#include "framework/bodies/point.hpp"
#include "framework/bodies/polygon.hpp"
#include "framework/bodies/ring.hpp"

namespace tomlin {

void register_bodies(Registry& registry) {
  registry.add(chain_record());
  registry.add(ellipse_record());
  registry.add(flake_record());
  registry.add(graphene_record());
  registry.add(nanotube_record());
  registry.add(particles_record());
  registry.add(point_record());
  registry.add(polygon_record());
  registry.add(ring_record());
}

}  // namespace tomlin
