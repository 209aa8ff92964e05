#include "framework/plot/body_figure.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "framework/core/numbers/math.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/model/model.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/plot/axis_text.hpp"
#include "framework/plot/equal_scale.hpp"
#include "framework/plot/sample_table.hpp"
#include "framework/scene/scene.hpp"

namespace tomlin {
namespace {

constexpr int kMomentsByDefault = 5;
constexpr double kTau = 6.283185307179586477;
constexpr double kMargin = 0.06;  // around everything, as a share of the width

/// A body without its motion.
struct Shape {
  std::vector<Point> arms;  ///< particles seen from the centre of mass
  bool round = false;       ///< a line joins them
};

Shape shape_of(const StoredRun& run, const std::string& name, const Registry& registry,
               std::vector<std::string>& notes) {
  const std::string file = file_of(run, kSceneFile);
  const Model model(run.scene->read(registry));
  const auto& bodies = model.bodies();
  const auto found = std::find_if(bodies.begin(), bodies.end(),
                                  [&](const auto& body) { return body.bound.name == name; });
  if (found == bodies.end()) {
    refuse_input(FaultCode::plot_no_data, file, "body." + name, "there is no such body");
  }
  if (!found->moves_as_one() && !found->prescribed()) {
    notes.push_back(fmt::format("{}: {} is flexible, and is drawn in the shape it starts with",
                                run.folder, name));
  }
  Shape shape;
  shape.round = found->rolling_radius > 0.0;
  for (const auto& arm : found->arms) shape.arms.push_back({arm[0], arm[1]});
  return shape;
}

/// Where a body and what pulls it are at one moment.
struct Snapshot {
  double value = 0.0;  ///< of the clock
  Point centre;
  double rotation = 0.0;
  std::vector<Point> drivers;
};

/// Where things are, as the table has it, and in between.
class Course {
 public:
  Course(const SampleTable& table, const Series& clock, const std::string& body)
      : file_(table.file()), measure_(clock.measure), parts_(clock.columns.size()) {
    std::vector<std::size_t> columns = clock.columns;
    const auto add = [&](const std::string& name) {
      const auto column = table.find(name);
      if (!column) refuse_input(FaultCode::plot_no_data, file_, "", "there is no column " + name);
      columns.push_back(*column);
    };
    for (const char* column : {".centre_of_mass.x", ".centre_of_mass.y", ".rotation"}) {
      add(body + column);
    }
    for (const std::string& driver : owners_of(table, "position.y")) {
      add(driver + ".position.x");
      add(driver + ".position.y");
    }
    numbers_ = table.read(columns);
    for (std::size_t row = 0; row < numbers_.front().size(); ++row) {
      std::vector<double> parts;
      for (std::size_t k = 0; k < parts_; ++k) parts.push_back(numbers_[k][row]);
      clock_.push_back(value_of(measure_, parts));
    }
  }

  std::vector<double> even_moments() const {
    const auto [least, most] = std::minmax_element(clock_.begin(), clock_.end());
    std::vector<double> result;
    for (int k = 0; k < kMomentsByDefault; ++k) {
      const double share = static_cast<double>(k) / (kMomentsByDefault - 1);
      result.push_back(k + 1 == kMomentsByDefault ? *most : *least + share * (*most - *least));
    }
    return result;
  }

  /// Where the clock first shows this value.
  Snapshot at(double value) const {
    const std::size_t upper = first_row_beyond(value);
    const std::size_t lower = upper == 0 ? 0 : upper - 1;
    const double step = clock_[upper] - clock_[lower];
    const double share = step != 0.0 ? (value - clock_[lower]) / step : 0.0;
    const auto between = [&](std::size_t column) {
      const std::vector<double>& values = numbers_[parts_ + column];
      return values[lower] + share * (values[upper] - values[lower]);
    };
    Snapshot moment{value, {between(0), between(1)}, between(2), {}};
    for (std::size_t column = 3; parts_ + column < numbers_.size(); column += 2) {
      moment.drivers.push_back({between(column), between(column + 1)});
    }
    return moment;
  }

 private:
  /// The first row at the value or behind it, seen from where the run begins.
  std::size_t first_row_beyond(double value) const {
    const bool rising = clock_.front() <= value;
    const auto found = std::find_if(clock_.begin(), clock_.end(), [&](double shown) {
      return rising ? shown >= value : shown <= value;
    });
    if (found != clock_.end()) return static_cast<std::size_t>(found - clock_.begin());
    const auto [least, most] = std::minmax_element(clock_.begin(), clock_.end());
    refuse_input(FaultCode::plot_no_data, "--at", fmt::format("{:g}", value),
                 "outside the samples of " + file_,
                 fmt::format("from {:g} to {:g}", *least, *most));
  }

  std::string file_;
  Measure measure_;
  std::size_t parts_;  ///< columns that the clock is made of; the places follow
  std::vector<std::vector<double>> numbers_;
  std::vector<double> clock_;
};

std::vector<Point> particles_at(const Shape& shape, const Snapshot& moment) {
  double sine = 0.0;
  double cosine = 1.0;
  sincos_turns(moment.rotation / kTau, sine, cosine);
  std::vector<Point> result;
  result.reserve(shape.arms.size());
  for (const Point& arm : shape.arms) {
    result.push_back({moment.centre.x + cosine * arm.x - sine * arm.y,
                      moment.centre.y + sine * arm.x + cosine * arm.y});
  }
  return result;
}

Curve marks(Mark mark, int colour, Polyline points) {
  Curve curve;
  curve.mark = mark;
  curve.colour = colour;
  curve.line = false;
  if (!points.empty()) curve.pieces = {std::move(points)};
  return curve;
}

void add_moment(Panel& panel, const Shape& shape, const Snapshot& moment, const std::string& clock,
                int colour) {
  Polyline particles = particles_at(shape, moment);
  Curve body = marks(Mark::small_disc, colour, particles);
  body.label = fmt::format("{} = {:g}", clock, moment.value);
  body.line = shape.round;
  if (shape.round) body.pieces.front().push_back(particles.front());
  panel.curves.push_back(std::move(body));
  panel.curves.push_back(marks(Mark::large_disc, colour, {particles.front()}));
  panel.curves.push_back(marks(Mark::square, colour, {moment.centre}));
  if (!moment.drivers.empty()) {
    panel.curves.push_back(marks(Mark::open_triangle, colour, moment.drivers));
  }
}

/// For a key: the field's letters for what moments usually are named by.
std::string short_name(const Series& clock) {
  if (clock.name == "time") return "t";
  return clock.name == "driver_position" ? "vt" : clock.name;
}

/// What the marks mean.
void add_key(Panel& panel, bool driven) {
  const auto entry = [&](Mark mark, const char* label) {
    Curve curve = marks(mark, kGrey, {});
    curve.label = label;
    panel.curves.push_back(std::move(curve));
  };
  entry(Mark::large_disc, "particle 0");
  entry(Mark::square, "centre of mass");
  if (driven) entry(Mark::open_triangle, "driver");
}

}  // namespace

Figure body_figure(const std::vector<StoredRun>& runs, const std::vector<std::string>& labels,
                   const BodyRequest& request, const Registry& registry,
                   std::vector<std::string>& notes) {
  Figure figure;
  check_unit_names(runs, "length");
  const auto along = [&](const char* axis) {
    return axis_text("", fmt::format("{{/:Italic {}}}", axis), unit_name(runs.front(), "length"));
  };
  figure.x_label = along("x");
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const SampleTable table(file_of(runs[r], kTableFile));
    const std::string body = chosen_owner(table, Owner::body, "rotation", request.owners);
    const Shape shape = shape_of(runs[r], body, registry, notes);
    const Series clock = find_series(table, request.x, request.owners, "--x");
    const Course course(table, clock, body);
    Panel panel;
    panel.title = labels[r];
    panel.y_label = along("y");
    int colour = 0;
    bool driven = false;
    for (const double value : request.at.empty() ? course.even_moments() : request.at) {
      const Snapshot moment = course.at(value);
      add_moment(panel, shape, moment, short_name(clock), colour++);
      driven = driven || !moment.drivers.empty();
    }
    add_key(panel, driven);
    figure.panels.push_back(std::move(panel));
  }
  scale_equally(figure, kMargin);
  return figure;
}

}  // namespace tomlin
