#include "framework/plot/surface_figure.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "framework/standard_registry.hpp"
#include "tests/framework/plot/figure_folder.hpp"
#include "tests/support/faults.hpp"

namespace tomlin {
namespace {

constexpr double kPi = 3.14159265358979324;
constexpr double kPeriod = 2.0;
constexpr double kAmplitude = 0.25;
constexpr double kDecay = 0.125;

std::string scene_with(const std::string& forces) {
  return R"([[body]]
name = "ring"
type = "ring"
count = 5
radius = 0.3
centre = [0.0, 0.0]
particle_mass = 1.0
coordinates = "rigid"
)" + forces +
         R"(
[[force]]
name = "driver"
type = "driving_spring"
body = "ring"
stiffness = 2.0
velocity = [0.1, 0.0]

[run]
duration = 1.0
integrator = { type = "rk4", dt = 0.1 }
)";
}

constexpr const char* kSubstrate = R"(
[[force]]
name = "ground"
type = "sinusoidal_substrate"
body = "ring"
amplitude = 0.25
period = 2.0
decay = 0.125
)";

constexpr const char* kTable =
    "time [time],ring.centre_of_mass.x [length],ring.centre_of_mass.y [length]\n"
    "0,0,0\n1,1,0.5\n2,4,1\n";

Figure surface_of(const std::string& scene, const SurfaceRequest& request = {}) {
  test::RunFolderOfTexts folder(kTable);
  folder.add("scene.toml", scene);
  return surface_figure(folder.run(), request, standard_registry());
}

/// In space the potential is that at the height at which the path begins, and the figure says so.
TEST(SurfaceFigure, InSpaceNamesItsHeight) {
  EXPECT_EQ(surface_of(scene_with(kSubstrate)).panels[0].title, "");
  test::RunFolderOfTexts folder(
      "time [time],tip.centre_of_mass.x [length],tip.centre_of_mass.y [length],"
      "tip.centre_of_mass.z [length]\n0,0,0,0.9\n1,1,0.5,0.8\n");
  folder.add("scene.toml", R"([[body]]
name = "tip"
type = "point"
position = [0.0, 0.0, 0.9]
particle_mass = 1.0
[[force]]
type = "lattice_substrate"
lattice = "square"
period = 1.0
amplitude = 0.1
decay = 2.0
[run]
duration = 1.0
integrator = { type = "rk4", dt = 0.1 }
)");
  EXPECT_EQ(surface_figure(folder.run(), {}, standard_registry()).panels[0].title, "z = 0.9");
}

/// The map is V = V_0 exp(-c y^2) cos(2 pi x / a) of one particle, not of the ring's five.
TEST(SurfaceFigure, IsThePotentialOfOneParticle) {
  const Figure figure = surface_of(scene_with(kSubstrate));
  const Raster& map = *figure.panels[0].raster;
  const std::size_t rows = map.values.size() / map.columns;
  ASSERT_GT(map.columns, 100U);
  ASSERT_GT(rows, 10U);
  const double width = (map.x_to - map.x_from) / static_cast<double>(map.columns);
  const double height = (map.y_to - map.y_from) / static_cast<double>(rows);
  // A few periods from the origin phases are rounded to 1e-15.
  constexpr double kRounding = 1e-14;
  for (std::size_t k = 0; k < map.values.size(); ++k) {
    const double x = map.x_from + (0.5 + static_cast<double>(k % map.columns)) * width;
    const double y = map.y_from + (0.5 + static_cast<double>(k / map.columns)) * height;
    const double exact = kAmplitude * std::exp(-kDecay * y * y) * std::cos(2.0 * kPi * x / kPeriod);
    ASSERT_NEAR(map.values[k], exact, kRounding) << x << ", " << y;
  }
  EXPECT_NEAR(width, height, 0.02 * width);  // square but for the rounding of a count of pixels
  EXPECT_TRUE(figure.to_scale);
  EXPECT_TRUE(map.grey);
  EXPECT_EQ(figure.panels[0].curves[0].pieces,
            (std::vector<Polyline>{{{0.0, 0.0}, {1.0, 0.5}, {4.0, 1.0}}}));
  EXPECT_LT(map.x_from, -1.0);
  EXPECT_GT(map.x_to, 5.0);
}

TEST(SurfaceFigure, SubstratesAddUp) {
  const std::string second = R"(
[[force]]
name = "second"
type = "sinusoidal_substrate"
body = "ring"
amplitude = 0.25
period = 2.0
decay = 0.125
)";
  const Raster one = *surface_of(scene_with(kSubstrate)).panels[0].raster;
  const Raster two = *surface_of(scene_with(kSubstrate + second)).panels[0].raster;
  ASSERT_EQ(one.values.size(), two.values.size());
  for (std::size_t k = 0; k < one.values.size(); ++k) ASSERT_EQ(two.values[k], 2.0 * one.values[k]);
}

std::string ground_with(const std::string& amplitude) {
  std::string text = kSubstrate;
  return text.replace(text.find("0.25"), 4, amplitude);
}

/// What all particles have together is shared out by the count of the body, not of the figure.
TEST(SurfaceFigure, SharesOutByTheCountOfTheBody) {
  const Raster plain = *surface_of(scene_with(ground_with("0.05"))).panels[0].raster;
  const Raster shared = *surface_of(scene_with(ground_with("\"0.25 / count\""))).panels[0].raster;
  EXPECT_EQ(plain.values, shared.values);
}

TEST(SurfaceFigure, RefusesWhatDiffersBetweenParticles) {
  for (const char* force :
       {"amplitude = \"0.1 * random(3, i)\"", "amplitude = [0.1, 0.2, 0.1, 0.1, 0.1]"}) {
    const std::string text = ground_with(std::string(force).substr(12));
    EXPECT_THROW(surface_of(scene_with(text)), InputError) << force;
  }
  const std::string formula = R"(
[[force]]
name = "ground"
type = "expression"
body = "ring"
period = [2.0, 0.0]
energy = "0.25 * cos(pi*x) / PART"
)";
  for (const char* part : {"(1 + i)", "count"}) {
    std::string text = formula;
    text.replace(text.find("PART"), 4, part);
    EXPECT_THROW(surface_of(scene_with(text)), InputError) << part;
  }
}

TEST(SurfaceFigure, ARangeCutsThePath) {
  SurfaceRequest request;
  request.from = 0.5;
  const Figure figure = surface_of(scene_with(kSubstrate), request);
  EXPECT_EQ(figure.panels[0].curves[0].pieces[0].size(), 2U);
  request.from = 7.0;
  EXPECT_EQ(test::brief(test::refusal_of([&] { surface_of(scene_with(kSubstrate), request); })),
            "[plot.no_data]");
}

TEST(SurfaceFigure, RefusesABodyWithoutASubstrate) {
  EXPECT_EQ(test::brief(test::refusal_of([] { surface_of(scene_with("")); })),
            "body.ring [plot.no_data]");
}

}  // namespace
}  // namespace tomlin
