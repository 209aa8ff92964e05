#include "framework/plot/body_figure.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "framework/core/fault.hpp"
#include "framework/core/math.hpp"
#include "framework/model/model.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/plot/sample_table.hpp"
#include "framework/scene/scene.hpp"

namespace tomlin {
namespace {

constexpr int kMomentsByDefault = 5;
constexpr double kTau = 6.283185307179586477;
// Of a panel, in points of the screen; beyond them an axis is made longer.
constexpr double kLeastHeight = 110.0;
constexpr double kMostHeight = 480.0;
constexpr double kMargin = 0.06;  // around everything, as a share of the width

[[noreturn]] void refuse(std::string file, std::string key, std::string why,
                         std::string admissible = "") {
  Fault fault;
  fault.place.file = std::move(file);
  fault.key = std::move(key);
  fault.why = std::move(why);
  fault.admissible = std::move(admissible);
  throw InputError({fault});
}

/// A body without its motion.
struct Shape {
  std::vector<Point> arms;  ///< particles seen from the centre of mass
  bool round = false;       ///< a line joins them
};

Shape shape_of(const StoredRun& run, const std::string& name, const Registry& registry,
               std::vector<std::string>& notes) {
  const std::string file = file_of(run, kSceneFile);
  const std::shared_ptr<const Scene> scene = read_scene(file, registry);
  const Model model(scene);
  const auto& bodies = model.bodies();
  const auto found = std::find_if(bodies.begin(), bodies.end(),
                                  [&](const auto& body) { return body.bound.name == name; });
  if (found == bodies.end()) refuse(file, "body." + name, "there is no such body");
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
struct Moment {
  double time = 0.0;
  Point centre;
  double rotation = 0.0;
  std::vector<Point> drivers;
};

/// Columns of the table that say where things are, and the moments between its rows.
class Course {
 public:
  Course(const SampleTable& table, const std::string& body) : file_(table.file()) {
    std::vector<std::string> names = {"time", body + ".centre_of_mass.x",
                                      body + ".centre_of_mass.y", body + ".rotation"};
    for (const std::string& driver : owners_of(table, "position.y")) {
      names.push_back(driver + ".position.x");
      names.push_back(driver + ".position.y");
    }
    std::vector<std::size_t> columns;
    for (const std::string& name : names) {
      const auto column = table.find(name);
      if (!column) refuse(file_, "", "there is no column " + name);
      columns.push_back(*column);
    }
    numbers_ = table.read(columns);
  }

  std::vector<double> even_moments() const {
    std::vector<double> result;
    for (int k = 0; k < kMomentsByDefault; ++k) {
      const double share = static_cast<double>(k) / (kMomentsByDefault - 1);
      result.push_back(times().front() + share * (times().back() - times().front()));
    }
    return result;
  }

  Moment at(double time) const {
    if (!(time >= times().front() && time <= times().back())) {
      refuse("--at", fmt::format("{:g}", time), "outside the samples of " + file_,
             fmt::format("times from {:g} to {:g}", times().front(), times().back()));
    }
    const auto after = std::lower_bound(times().begin(), times().end(), time);
    const auto upper = static_cast<std::size_t>(after - times().begin());
    const std::size_t lower = upper == 0 ? 0 : upper - 1;
    const double step = times()[upper] - times()[lower];
    const double share = step > 0.0 ? (time - times()[lower]) / step : 0.0;
    const auto between = [&](std::size_t column) {
      const std::vector<double>& values = numbers_[column];
      return values[lower] + share * (values[upper] - values[lower]);
    };
    Moment moment{time, {between(1), between(2)}, between(3), {}};
    for (std::size_t column = 4; column < numbers_.size(); column += 2) {
      moment.drivers.push_back({between(column), between(column + 1)});
    }
    return moment;
  }

 private:
  const std::vector<double>& times() const { return numbers_.front(); }

  std::string file_;
  std::vector<std::vector<double>> numbers_;
};

std::vector<Point> particles_at(const Shape& shape, const Moment& moment) {
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

void add_moment(Panel& panel, const Shape& shape, const Moment& moment, int colour) {
  Polyline particles = particles_at(shape, moment);
  Curve body = marks(Mark::small_disc, colour, particles);
  body.label = fmt::format("t = {:g}", moment.time);
  body.line = shape.round;
  if (shape.round) body.pieces.front().push_back(particles.front());
  panel.curves.push_back(std::move(body));
  panel.curves.push_back(marks(Mark::large_disc, colour, {particles.front()}));
  panel.curves.push_back(marks(Mark::square, colour, {moment.centre}));
  if (!moment.drivers.empty()) {
    panel.curves.push_back(marks(Mark::open_triangle, colour, moment.drivers));
  }
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

struct Box {
  double left = HUGE_VAL, right = -HUGE_VAL, low = HUGE_VAL, high = -HUGE_VAL;

  void take(const Panel& panel) {
    for (const Curve& curve : panel.curves) {
      for (const Polyline& piece : curve.pieces) {
        for (const Point& point : piece) {
          left = std::min(left, point.x);
          right = std::max(right, point.x);
          low = std::min(low, point.y);
          high = std::max(high, point.y);
        }
      }
    }
  }
};

/// Axes in the same scale, x shared by all panels.
void scale(Figure& figure) {
  Box all;
  double tallest = 0.0;
  for (const Panel& panel : figure.panels) {
    Box box;
    box.take(panel);
    all.take(panel);
    tallest = std::max(tallest, box.high - box.low);
  }
  const double margin = kMargin * std::max(all.right - all.left, tallest);
  const double least_width = (tallest + 2.0 * margin) * kPanelWidth / kMostHeight;
  const double width = std::max(all.right - all.left + 2.0 * margin, least_width);
  const double middle = 0.5 * (all.left + all.right);
  figure.x_from = middle - 0.5 * width;
  figure.x_to = middle + 0.5 * width;
  const double points_per_length = kPanelWidth / width;
  for (Panel& panel : figure.panels) {
    Box box;
    box.take(panel);
    const double height =
        std::max(box.high - box.low + 2.0 * margin, kLeastHeight / points_per_length);
    const double centre = 0.5 * (box.low + box.high);
    panel.y_from = centre - 0.5 * height;
    panel.y_to = centre + 0.5 * height;
    panel.height = height * points_per_length;
  }
}

}  // namespace

Figure body_figure(const std::vector<StoredRun>& runs, const std::vector<std::string>& labels,
                   const BodyRequest& request, const Registry& registry,
                   std::vector<std::string>& notes) {
  Figure figure;
  const auto along = [](const char* axis) {
    return FigureText{fmt::format("{{/:Italic {}}} [length]", axis), true};
  };
  figure.x_label = along("x");
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const SampleTable table(file_of(runs[r], kTableFile));
    const std::string body = chosen_owner(table, Owner::body, "rotation", request.owners);
    const Shape shape = shape_of(runs[r], body, registry, notes);
    const Course course(table, body);
    Panel panel;
    panel.title = labels[r];
    panel.y_label = along("y");
    int colour = 0;
    bool driven = false;
    for (const double time : request.at.empty() ? course.even_moments() : request.at) {
      const Moment moment = course.at(time);
      add_moment(panel, shape, moment, colour++);
      driven = driven || !moment.drivers.empty();
    }
    add_key(panel, driven);
    figure.panels.push_back(std::move(panel));
  }
  scale(figure);
  return figure;
}

}  // namespace tomlin
