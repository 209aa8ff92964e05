#include "framework/plot/raster_figure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/plot/axis_text.hpp"
#include "framework/plot/equal_scale.hpp"
#include "framework/plot/series_reader.hpp"

namespace tomlin {
namespace {

constexpr double kImageHeight = 400.0;  // of the panel, in points of the screen
constexpr std::size_t kFewestPixels = 2;
constexpr std::size_t kMostByDefault = 256;
constexpr std::size_t kSamplesPerPixel = 2;

struct ScanSample {
  double x = 0.0;
  double y = 0.0;
  double value = 0.0;
};

/// The samples of all runs, and what their columns are.
struct Scan {
  Series x;
  Series y;
  Series value;
  std::vector<ScanSample> samples;
  std::size_t strokes = 0;  ///< in which they were taken
};

bool is_shown(ScanDirection direction, bool forward) {
  return direction == ScanDirection::both || (direction == ScanDirection::forward) == forward;
}

/// Adds the samples of the direction that is shown.
void add_samples(Scan& scan, const std::vector<double>& x, const std::vector<double>& y,
                 const std::vector<double>& values, ScanDirection direction) {
  // The first samples move as those that follow.
  std::size_t moved = 1;
  while (moved < x.size() && x[moved] == x[0]) ++moved;
  bool forward = moved == x.size() || x[moved] > x[0];
  bool counted = false;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (i > 0 && x[i] != x[i - 1] && (x[i] > x[i - 1]) != forward) {
      forward = !forward;
      counted = false;
    }
    if (!is_shown(direction, forward)) continue;
    if (!counted) ++scan.strokes;
    counted = true;
    scan.samples.push_back({x[i], y[i], values[i]});
  }
}

void check_same_unit(const StoredRun& run, const Series& first, const Series& other) {
  if (first.unit == other.unit) return;
  refuse_input(FaultCode::command_invalid_value, file_of(run, kTableFile), other.name,
               fmt::format("[{}], beside [{}] of another folder", other.unit, first.unit),
               "one unit to an axis");
}

Scan read_scan(const std::vector<StoredRun>& runs, const RasterRequest& request) {
  Scan scan;
  for (const StoredRun& run : runs) {
    const SampleTable table(file_of(run, kTableFile));
    const Series x = find_series(table, request.x, request.owners, "--x");
    const Series y = find_series(table, request.y, request.owners, "--y");
    const Series value = find_series(table, request.value, request.owners, "--value");
    SeriesReader reader;
    for (const Series* series : {&x, &y, &value}) reader.add(*series);
    reader.read(table);
    if (scan.samples.empty() && scan.strokes == 0) {
      scan.x = x;
      scan.y = y;
      scan.value = value;
    }
    check_same_unit(run, scan.x, x);
    check_same_unit(run, scan.y, y);
    check_same_unit(run, scan.value, value);
    add_samples(scan, reader.values(x), reader.values(y), reader.values(value), request.direction);
  }
  for (const Series* series : {&scan.x, &scan.y, &scan.value}) check_unit_names(runs, series->unit);
  if (scan.samples.empty()) {
    refuse_input(FaultCode::plot_no_data, "--scan", std::string(to_string(request.direction)),
                 fmt::format("{} never goes this way", request.x), "the other direction, or both");
  }
  return scan;
}

/// One axis of the image.
struct PixelAxis {
  double from = 0.0;
  double to = 0.0;
  std::size_t pixels = 1;

  std::size_t pixel_of(double value) const {
    const double share = (value - from) / (to - from);
    const double pixel = std::floor(share * static_cast<double>(pixels));
    return static_cast<std::size_t>(std::clamp(pixel, 0.0, static_cast<double>(pixels - 1)));
  }
};

std::pair<double, double> extent_of(const std::vector<ScanSample>& samples,
                                    double ScanSample::*coordinate) {
  const auto [least, most] = std::minmax_element(
      samples.begin(), samples.end(),
      [&](const ScanSample& a, const ScanSample& b) { return a.*coordinate < b.*coordinate; });
  return {(*least).*coordinate, (*most).*coordinate};
}

/// How many values of y there are; values closer than rounding are one.
std::size_t count_lines(const std::vector<ScanSample>& samples, double extent) {
  constexpr double kRounding = 1e-9;
  std::vector<double> all;
  all.reserve(samples.size());
  for (const ScanSample& sample : samples) all.push_back(sample.y);
  std::sort(all.begin(), all.end());
  std::size_t lines = 1;
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (all[i] - all[i - 1] > kRounding * extent) ++lines;
  }
  return lines;
}

/// Pixels whose outer centres are at the ends: the values are those of lines.
PixelAxis axis_of_lines(double from, double to, std::size_t lines) {
  const double half = 0.5 * (to - from) / static_cast<double>(lines - 1);
  return {from - half, to + half, lines};
}

struct PixelAxes {
  PixelAxis x;
  PixelAxis y;
};

PixelAxes axes_of(const Scan& scan, const RasterRequest& request) {
  const auto [left, right] = extent_of(scan.samples, &ScanSample::x);
  const auto [low, high] = extent_of(scan.samples, &ScanSample::y);
  const auto check = [](const char* option, const std::string& name, double from, double to) {
    if (from < to) return;
    refuse_input(FaultCode::plot_no_data, option, name,
                 fmt::format("it is {:g} in every sample: an image has two extents", from),
                 "a column that differs between samples or folders");
  };
  check("--x", request.x, left, right);
  check("--y", request.y, low, high);
  const std::size_t lines = count_lines(scan.samples, high - low);
  PixelAxes axes;
  if (request.pixels) {
    axes.x = {left, right, request.pixels->columns};
    axes.y = {low, high, request.pixels->rows};
    if (lines == axes.y.pixels && lines > 1) axes.y = axis_of_lines(low, high, lines);
    return axes;
  }
  if (lines <= kMostByDefault) {
    axes.y = axis_of_lines(low, high, lines);
  } else {
    axes.y = {low, high, std::clamp(scan.strokes, kFewestPixels, kMostByDefault)};
  }
  axes.x = {left, right,
            std::clamp(scan.samples.size() / (kSamplesPerPixel * axes.y.pixels), kFewestPixels,
                       kMostByDefault)};
  return axes;
}

/// Means by pixel, row by row from below.
std::vector<double> means_of(const Scan& scan, const PixelAxes& axes) {
  std::vector<double> sums(axes.x.pixels * axes.y.pixels, 0.0);
  std::vector<std::size_t> counts(sums.size(), 0);
  for (const ScanSample& sample : scan.samples) {
    const std::size_t pixel = axes.y.pixel_of(sample.y) * axes.x.pixels + axes.x.pixel_of(sample.x);
    sums[pixel] += sample.value;
    ++counts[pixel];
  }
  for (std::size_t k = 0; k < sums.size(); ++k) {
    sums[k] = counts[k] == 0 ? std::numeric_limits<double>::quiet_NaN()
                             : sums[k] / static_cast<double>(counts[k]);
  }
  return sums;
}

}  // namespace

Figure raster_figure(const std::vector<StoredRun>& runs, const RasterRequest& request,
                     std::vector<std::string>& notes) {
  const Scan scan = read_scan(runs, request);
  const PixelAxes axes = axes_of(scan, request);
  Raster raster{axes.x.from,
                axes.x.to,
                axes.y.from,
                axes.y.to,
                axes.x.pixels,
                means_of(scan, axes),
                axis_label_in_words(runs.front(), scan.value)};
  const auto empty = std::count_if(raster.values.begin(), raster.values.end(),
                                   [](double value) { return std::isnan(value); });
  if (empty > 0) {
    notes.push_back(fmt::format("{} of {} pixels ({}x{}) have no sample in them and stay white",
                                empty, raster.values.size(), axes.x.pixels, axes.y.pixels));
  }
  Panel panel;
  panel.height = kImageHeight;
  panel.y_label = axis_label_in_words(runs.front(), scan.y);
  panel.y_from = raster.y_from;
  panel.y_to = raster.y_to;
  Figure figure;
  figure.x_label = axis_label_in_words(runs.front(), scan.x);
  figure.x_from = raster.x_from;
  figure.x_to = raster.x_to;
  panel.raster = std::move(raster);
  figure.panels.push_back(std::move(panel));
  if (scan.x.unit == scan.y.unit) scale_equally(figure, 0.0);
  return figure;
}

}  // namespace tomlin
