#include "framework/plot/figure.hpp"

#include <cmath>

namespace tomlin {

std::pair<double, double> with_margin(double from, double to, bool logarithmic) {
  constexpr double kCurveMargin = 0.04;  // as a share of what is between
  if (logarithmic) {
    const double factor = to > from ? std::pow(to / from, kCurveMargin) : 1.0 + kCurveMargin;
    return {from / factor, to * factor};
  }
  const double level = to == 0.0 ? 1.0 : kCurveMargin * std::abs(to);
  const double margin = to > from ? kCurveMargin * (to - from) : level;
  return {from - margin, to + margin};
}

}  // namespace tomlin
