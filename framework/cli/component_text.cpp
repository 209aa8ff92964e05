#include "framework/cli/component_text.hpp"

#include "framework/core/text/axis_names.hpp"

namespace tomlin {

const char* to_string(Element element) {
  switch (element) {
    case Element::site:
      return "each particle";
    case Element::pair:
      return "pairs of particles";
    case Element::triple:
      return "angles of three particles";
    case Element::surroundings:
      return "each particle and its neighbours";
    case Element::body:
      return "a body as a whole, or particles of it";
  }
  return "";
}

const char* axis_name(int axis) { return kAxisNames[axis]; }

}  // namespace tomlin
