#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "framework/plot/figure.hpp"

namespace tomlin {

inline constexpr std::size_t kLongestText = 200;  ///< bytes of a title or label

/// Where everything of a figure is. Lengths are in points of the screen; shares are of the whole,
/// from the bottom left, as gnuplot counts.
class FigureLayout {
 public:
  explicit FigureLayout(const Figure& figure);

  double width() const { return width_; }
  double height() const { return height_; }

  double left() const;
  double right() const;
  double top_of_title() const;
  double top_of(std::size_t panel) const { return 1.0 - tops_[panel] / height_; }
  double bottom_of(std::size_t panel) const { return 1.0 - bottoms_[panel] / height_; }

  /// Has the panel a key of its own, because it says something else than the one above?
  bool has_key(std::size_t panel) const { return key_rooms_[panel] > 0.0; }
  double left_of_keys() const;
  /// Down to where there is room for it.
  double bottom_of_key(std::size_t panel) const {
    return 1.0 - (tops_[panel] + key_rooms_[panel]) / height_;
  }

 private:
  double width_ = 0.0;
  double height_ = 0.0;
  std::vector<double> tops_;
  std::vector<double> bottoms_;
  std::vector<double> key_rooms_;
};

}  // namespace tomlin
