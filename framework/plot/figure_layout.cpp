#include "framework/plot/figure_layout.hpp"

#include <algorithm>

#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

constexpr double kLeft = 84.0;
constexpr double kRight = 18.0;
constexpr double kTop = 14.0;
constexpr double kTitle = 26.0;
constexpr double kBottom = 54.0;
constexpr double kGap = 16.0;
constexpr double kPanelTitle = 18.0;
constexpr double kKeySample = 40.0;
constexpr double kKeyCharacter = 7.0;
constexpr double kKeyRow = 20.0;

std::vector<std::string> key_of(const Panel& panel) {
  std::vector<std::string> labels;
  for (const Curve& curve : panel.curves) {
    if (!curve.label.empty()) labels.push_back(curve.label);
  }
  return labels;
}

double width_of(const std::string& label) {
  const std::string shown = shortened(label, kLongestText);
  const auto characters =
      std::count_if(shown.begin(), shown.end(), [](char c) { return !is_utf8_continuation(c); });
  return kKeySample + kKeyCharacter * static_cast<double>(characters);
}

}  // namespace

FigureLayout::FigureLayout(const Figure& figure) {
  double y = figure.title.empty() ? kTop : kTop + kTitle;
  double end_of_keys = 0.0;
  double width_of_keys = 0.0;
  std::vector<std::string> key_above;
  for (const Panel& panel : figure.panels) {
    const std::vector<std::string> key = key_of(panel);
    const bool own_key = key != key_above;
    if (!panel.title.empty()) y += kPanelTitle;
    if (own_key) y = std::max(y, end_of_keys);
    const double room = own_key ? kKeyRow * static_cast<double>(key.size()) : 0.0;
    for (const std::string& label : key) width_of_keys = std::max(width_of_keys, width_of(label));
    tops_.push_back(y);
    bottoms_.push_back(y + panel.height);
    key_rooms_.push_back(room);
    if (own_key) end_of_keys = y + room;
    y += panel.height + kGap;
    key_above = key;
  }
  height_ = std::max(y - kGap + kBottom, end_of_keys + kTop);
  width_ = kLeft + kPanelWidth + kRight + width_of_keys;
}

double FigureLayout::left() const { return kLeft / width_; }

double FigureLayout::right() const { return (kLeft + kPanelWidth) / width_; }

double FigureLayout::left_of_keys() const { return (kLeft + kPanelWidth + kRight) / width_; }

double FigureLayout::top_of_title() const { return 1.0 - kTop / height_; }

}  // namespace tomlin
