#include "framework/core/elements/neighbour_list.hpp"

#include <fmt/format.h>

namespace tomlin {

std::vector<Complaint> cutoff_complaints(const char* key, double cutoff, const SceneOutline& scene,
                                         Search how) {
  const double shortest = 2.0 * cutoff * reach_of(how);
  for (const double length : scene.box) {
    if (!(length > 0.0) || length >= shortest) continue;
    return {
        {.key = key,
         .why = fmt::format("the periodic box is {:.6g} long, less than twice the cutoff and "
                            "the skin of its neighbour list, {:.6g}",
                            length, shortest),
         .admissible = fmt::format("at most {:.6g}, or a longer box", 0.5 * length / reach_of(how)),
         .code = FaultCode::scene_out_of_range}};
  }
  return {};
}

}  // namespace tomlin
