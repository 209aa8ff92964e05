#include "framework/plot/figure_layout.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
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
constexpr double kBarWidth = 14.0;
constexpr double kBarRoom = 96.0;        // for a bar of colours with its numbers and its label
constexpr double kSmallestPanel = 40.0;  // either way
constexpr double kRoundingOfPoints = 1e-6;

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

FigureLayout::FigureLayout(const Figure& figure) : unit_(figure.font.size / FigureFont().size) {
  for (const Panel& panel : figure.panels) {
    if (panel.raster && !panel.raster->label.text.empty()) bar_room_ = kBarRoom * unit_;
    for (const std::string& label : key_of(panel)) {
      key_room_ = std::max(key_room_, width_of(label) * unit_);
    }
  }
  arrange(figure, 1.0);
  if (figure.size) fit(figure, *figure.size);
}

void FigureLayout::arrange(const Figure& figure, double stretch) {
  tops_.clear();
  bottoms_.clear();
  key_rooms_.clear();
  double y = figure.title.empty() ? kTop : kTop + kTitle * unit_;
  double end_of_keys = 0.0;
  std::vector<std::string> key_above;
  for (const Panel& panel : figure.panels) {
    const std::vector<std::string> key = key_of(panel);
    const bool own_key = key != key_above;
    if (!panel.title.empty()) y += kPanelTitle * unit_;
    if (own_key) y = std::max(y, end_of_keys);
    const double room = own_key ? kKeyRow * unit_ * static_cast<double>(key.size()) : 0.0;
    tops_.push_back(y);
    bottoms_.push_back(y + stretch * panel.height);
    key_rooms_.push_back(room);
    if (own_key) end_of_keys = y + room;
    y = bottoms_.back() + kGap;
    key_above = key;
  }
  height_ = std::max(y - kGap + kBottom * unit_, end_of_keys + kTop);
  width_ = (kLeft * unit_) + panel_width_ + kRight + bar_room_ + key_room_;
}

void FigureLayout::fit(const Figure& figure, const FigureSize& size) {
  double panels = 0.0;
  for (const Panel& panel : figure.panels) panels += panel.height;
  const double texts_beside = width_ - panel_width_;
  const double texts_above = bottoms_.back() + kBottom * unit_ - panels;
  const double least_height =
      texts_above + kSmallestPanel * static_cast<double>(figure.panels.size());
  panel_width_ = size.width - texts_beside;
  double stretch = (size.height - texts_above) / panels;
  if (figure.to_scale) {
    stretch = std::min(stretch, panel_width_ / kPanelWidth);
    panel_width_ = stretch * kPanelWidth;
  }
  const bool too_small = panel_width_ < kSmallestPanel || size.height < least_height;
  if (!too_small) arrange(figure, stretch);
  if (too_small || height_ > size.height + kRoundingOfPoints) {
    refuse_input(FaultCode::command_invalid_value, "--size",
                 fmt::format("{:g}x{:g}", size.width, size.height),
                 "too small for the texts of the figure",
                 fmt::format("at least {:.0f}x{:.0f}", std::ceil(texts_beside + kSmallestPanel),
                             std::ceil(std::max(least_height, height_))));
  }
  width_ = size.width;
  height_ = size.height;
}

double FigureLayout::left() const { return kLeft * unit_ / width_; }

double FigureLayout::right() const { return (kLeft * unit_ + panel_width_) / width_; }

double FigureLayout::left_of_bars() const { return right() + kRight / width_; }

double FigureLayout::width_of_bars() const { return kBarWidth / width_; }

double FigureLayout::left_of_keys() const { return left_of_bars() + bar_room_ / width_; }

double FigureLayout::top_of_title() const { return 1.0 - kTop / height_; }

}  // namespace tomlin
