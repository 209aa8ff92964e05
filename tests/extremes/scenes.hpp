#pragma once

#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/core/numbers/constants.hpp"
#include "tests/extremes/extreme_case.hpp"
#include "tests/extremes/observed.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/tables.hpp"

/// The scenes that are driven to extremes, by settings of their parameters and keys.
namespace tomlin::test {

struct NamedScene {
  std::string name;
  std::string summary;
  std::string text;
};

/// A tip at rest in a minimum of its substrate, about to be pulled out of it.
inline const NamedScene kTip = {"tip", "a Prandtl-Tomlinson tip that starts in a minimum",
                                tables(R"toml([parameters] | m = 1.0 | a = 1.0 | V0 = 0.1 | k = 2.0
v = 0.01 | c = 2.0 | x0 = "a / 2" | T = 100.0

[[body]] | name = "tip" | type = "point" | position = ["x0"] | particle_mass = "m"

[[force]] | name = "driver" | type = "driving_spring" | stiffness = "k" | velocity = ["v"]

[[force]] | type = "viscous_damping" | coefficient = "c"

[[force]] | type = "sinusoidal_substrate" | amplitude = "V0" | period = "a"

[run] | duration = "T" | integrator = { type = "dopri5" }
)toml")};

/// The paper's ring, slow and long enough to see what is to be seen.
inline const NamedScene kRing = {"ring", "the rolling ring, in the parameters of its paper",
                                 tables(R"toml([parameters] | N = 8 | R = 1.0 | a = 1.0 | V0 = 0.1
lambda = 1.0 | k = 2.0 | k_wh = 1e3 | xi = "2 * sqrt(2)" | v = 0.1 | y0 = "R" | T = 30.0

[[body]] | name = "ring" | type = "ring" | count = "N" | radius = "R" | particle_mass = "1 / N"
centre = [0.0, "y0"] | coordinates = "rigid"

[[force]] | type = "harmonic_bonds" | pairs = "all" | stiffness = "k_wh"

[[force]] | name = "driver" | type = "driving_spring" | stiffness = "k" | velocity = ["v", 0.0]

[[force]] | type = "viscous_damping" | coefficient = "xi / N"

[[force]] | type = "sinusoidal_substrate" | amplitude = "V0 / N" | period = "a"
decay = "lambda / R"

[run] | duration = "T" | integrator = { type = "dopri5" }
)toml")};

inline const NamedScene kChain = {"chain", "a chain of neighbours on springs, pulled as a whole",
                                  tables(R"toml([parameters] | N = 2 | b = 1.0 | a = 1.0 | V0 = 0.01
K = 1.0 | m = 1.0 | v = 0.1 | T = 1.0

[[body]] | name = "chain" | type = "chain" | count = "N" | spacing = "b" | particle_mass = "m"

[[force]] | type = "harmonic_bonds" | pairs = "neighbours" | stiffness = "K"

[[force]] | name = "driver" | type = "driving_spring" | stiffness = 1.0 | velocity = ["v"]

[[force]] | type = "sinusoidal_substrate" | amplitude = "V0" | period = "a"

[run] | duration = "T" | integrator = { type = "rk4", dt = 1e-2 }
)toml")};

/// Nothing but two particles and the bond between them.
inline const NamedScene kPair = {"pair", "two particles in the plane and a spring of their own",
                                 tables(R"toml([parameters] | d = 1.0 | l0 = 1.0 | K = 1.0
m1 = 1.0 | m2 = 1.0 | T = 10.0

[[body]] | name = "pair" | type = "particles" | positions = [[0.0, 0.0], ["d", 0.0]]
particle_mass = ["m1", "m2"]

[[force]] | type = "harmonic_bonds" | pairs = "all" | stiffness = "K" | rest_lengths = "l0"

[run] | duration = "T" | integrator = { type = "dopri5" } | ledger = true
)toml")};

inline const NamedScene kLine = {"line", "the same two particles on a line",
                                 tables(R"toml([parameters]
d = 1.0 | l0 = 1.0 | K = 1.0 | T = 10.0

[[body]] | name = "pair" | type = "particles" | positions = [0.0, "d"] | particle_mass = 1.0

[[force]] | type = "harmonic_bonds" | pairs = "all" | stiffness = "K" | rest_lengths = "l0"

[run] | duration = "T" | integrator = { type = "dopri5" } | ledger = true
)toml")};

/// A particle that goes its prescribed way over a substrate.
inline const NamedScene kWay = {"way", "a particle that is moved along over a substrate",
                                tables(R"toml([parameters] | a = 1.0 | V0 = 0.1 | T = 10.0

[[body]] | name = "tip" | type = "point" | position = [0.0] | particle_mass = 1.0
coordinates = "prescribed" | motion = { velocity = [1.0] }

[[force]] | type = "sinusoidal_substrate" | amplitude = "V0" | period = "a"

[run] | duration = "T" | integrator = { type = "rk4", dt = 1e-2 }
)toml")};

inline std::vector<NamedScene> base_scenes() { return {kTip, kRing, kChain, kPair, kLine, kWay}; }

inline ExtremeCase case_of(const NamedScene& scene, std::string name, std::string extreme,
                           std::vector<Setting> settings) {
  ExtremeCase made;
  made.name = std::move(name);
  made.extreme = std::move(extreme);
  made.scene = scene.name;
  made.text = scene.text;
  made.settings = std::move(settings);
  return made;
}

inline ExtremeCase finishes(const NamedScene& scene, std::string name, std::string extreme,
                            std::vector<Setting> settings, std::vector<Value> values,
                            std::vector<FaultCode> warnings = {}) {
  ExtremeCase made = case_of(scene, std::move(name), std::move(extreme), std::move(settings));
  made.values = std::move(values);
  made.warnings = std::move(warnings);
  return made;
}

inline ExtremeCase refused(const NamedScene& scene, std::string name, std::string extreme,
                           std::vector<Setting> settings, std::vector<std::string> words) {
  ExtremeCase made = case_of(scene, std::move(name), std::move(extreme), std::move(settings));
  made.outcome = Outcome::refused;
  made.words = std::move(words);
  return made;
}

inline ExtremeCase fails(const NamedScene& scene, std::string name, std::string extreme,
                         std::vector<Setting> settings, std::vector<std::string> words) {
  ExtremeCase made = case_of(scene, std::move(name), std::move(extreme), std::move(settings));
  made.outcome = Outcome::failed;
  made.words = std::move(words);
  return made;
}

/// A number known beforehand.
inline Value is(std::string path, double right, double tolerance, std::string reason) {
  return {std::move(path), [right] { return right; }, tolerance, std::move(reason)};
}

/// A number that another scene has to give, too.
inline Value is_that_of(std::string path, const NamedScene& scene, std::vector<Setting> settings,
                        double tolerance, std::string reason, double factor = 1.0,
                        std::string other_path = "") {
  const std::string text = scene.text;
  if (other_path.empty()) other_path = path;
  return {std::move(path), [=] { return factor * result_of(text, settings, other_path); },
          tolerance, std::move(reason)};
}

/// The shortest text that reads back as the same number.
inline std::string text_of(double number) { return fmt::format("{}", number); }

inline Setting fixed(const std::string& scheme, double dt) {
  return {"run.integrator", "{ type = \"" + scheme + "\", dt = " + text_of(dt) + " }"};
}
inline Setting rk4(double dt) { return fixed("rk4", dt); }
inline Setting with_verlet(double dt) { return fixed("velocity_verlet", dt); }
inline Setting dopri5(double tolerance) {
  const std::string to = text_of(tolerance);
  return {"run.integrator", "{ type = \"dopri5\", absolute_tolerance = " + to +
                                ", relative_tolerance = " + to + " }"};
}

}  // namespace tomlin::test
