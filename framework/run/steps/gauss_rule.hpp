#pragma once

#include <cstddef>

namespace tomlin {

/// The rule of Gauss and Legendre with four nodes in [0, 1]: order 8, which is more than dense
/// output has.
inline constexpr std::size_t kGaussNodes = 4;
inline constexpr double kGaussNode[kGaussNodes] = {0.0694318442029737124, 0.330009478207571868,
                                                   0.669990521792428132, 0.930568155797026288};
inline constexpr double kGaussWeight[kGaussNodes] = {0.173927422568726929, 0.326072577431273071,
                                                     0.326072577431273071, 0.173927422568726929};

}  // namespace tomlin
