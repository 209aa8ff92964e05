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
  /// Throws InputError when the figure's size leaves no room for its panels.
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
  double left_of_bars() const;   ///< of colours, beside a panel
  double width_of_bars() const;  ///< without their numbers
  /// Down to where there is room for it.
  double bottom_of_key(std::size_t panel) const {
    return 1.0 - (tops_[panel] + key_rooms_[panel]) / height_;
  }

 private:
  /// Places the panels with heights of so many times their own.
  void arrange(const Figure& figure, double stretch);
  void fit(const Figure& figure, const FigureSize& size);

  double unit_ = 1.0;  ///< of lengths that grow with the font
  double panel_width_ = kPanelWidth;
  double bar_room_ = 0.0;
  double key_room_ = 0.0;
  double width_ = 0.0;
  double height_ = 0.0;
  std::vector<double> tops_;
  std::vector<double> bottoms_;
  std::vector<double> key_rooms_;
};

}  // namespace tomlin
