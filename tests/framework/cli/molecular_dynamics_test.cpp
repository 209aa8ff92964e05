#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/framework/cli/cli_fixture.hpp"
#include "tests/support/tube_scene.hpp"

/// Scenes of molecular dynamics: what is refused, at its position; what a run that diverges says
/// and leaves; and what `explain` says of neighbours.
namespace tomlin::test {
namespace {

class MolecularDynamics : public Cli {
 protected:
  Ended run_of(const std::string& text, std::vector<std::string> more = {}) {
    write(folder_ / "tube.toml", text);
    more.insert(more.begin(), {"run", "tube.toml", "-o", "out", "--force", "--quiet"});
    return tomlin(more);
  }
};

struct SpoiltTube {
  const char* what;
  std::string old_text;
  std::string new_text;
  std::string errors;              // without wording
  std::vector<std::string> words;  // of the message
};

/// With faulty potentials in `bad.tersoff` and `silicon.tersoff`.
std::vector<SpoiltTube> spoilt_tubes() {
  const std::string named = "parameters = \"lindsay_broido_2010\"";
  const std::string second =
      "[[force]]\nname = \"second\"\ntype = \"nose_hoover_chain\"\nbody = \"tube\"\n"
      "temperature = 10.0\nperiod = 0.1\n\n[run]";
  return {
      {"a box shorter than twice cutoff and skin",
       "cutoff = 3.7",
       "cutoff = 3.8",
       "tube.toml:46:10: force.contact.cutoff = 3.8 [scene.out_of_range]\n",
       {"8.6328", "8.74076"}},
      {"a species without parameters",
       "species = \"C\"",
       "species = \"Si\"",
       "tube.toml:20:11: body.tube.species = \"Si\" [component.unsuitable]\n",
       {"Si Si Si", "expected: C "}},
      {"a box that cuts the tube and its sheet",
       "\"6 * b\"",
       "9.2",
       "tube.toml:9:11: box.lengths = [9.2, \"4 * a\", 40.0] [box.invalid]\n"
       "tube.toml:9:11: box.lengths = [9.2, \"4 * a\", 40.0] [box.invalid]\n",
       {"cuts \"tube\"", "cuts \"sheet\"", "8.6328"}},
      {"a species that a file lacks",
       named,
       "file = \"silicon.tersoff\"",
       "tube.toml:20:11: body.tube.species = \"C\" [component.unsuitable]\n",
       {"C C C", "expected: Si "}},
      {"a faulty potential file",
       named,
       "file = \"bad.tersoff\"",
       "tube.toml:38:8: force.bonds.file = \"bad.tersoff\" [file.invalid]\n",
       {"bad.tersoff:3: ", "column 3"}},
      {"no potential file",
       named,
       "file = \"none.tersoff\"",
       "tube.toml:38:8: force.bonds.file = \"none.tersoff\" [file.cannot_read]\n",
       {"none.tersoff"}},
      {"atoms nearer than a quarter of the cutoff of their bonds",
       "type = \"nanotube\"\nchirality = [5, 0]\nbond_length = \"b\"\ncells = 2\naxis = \"x\"\n"
       "centre = [0.0, 0.0, 5.2]\nspecies = \"C\"",
       "type = \"particles\"\npositions = [[0, 0, 5], [1.4, 0, 5], [1.4, 0.5, 5], [2.5, 0, 5]]\n"
       "species = [\"C\", \"C\", \"C\", \"C\"]",
       "tube.toml:33:8: force.bonds.body [body.invalid_coordinates]\n",
       {"particle 1 of \"tube\" (C) and particle 2 of \"tube\" (C)", "0.5 apart", "0.525"}},
      {"a tube through the sheet",
       "5.2]",
       "1.0]",
       "tube.toml:43:10: force.contact.bodies [body.invalid_coordinates]\n",
       {"\"tube\" passes through \"sheet\"", "across z", "of \"tube\" (C)", "of \"sheet\" (C)",
        "half of sigma"}},
      {"a tube too near to the sheet",
       "5.2]",
       "3.0]",
       "tube.toml:43:10: force.contact.bodies [body.invalid_coordinates]\n",
       {"of \"tube\" (C)", "of \"sheet\" (C)", "at least 1.7"}},
      {"a tube through the sheet's image in the box",
       "40.0]\nperiodic = [true, true, false]",
       "8.7]\nperiodic = [true, true, true]",
       "tube.toml:43:10: force.contact.bodies [body.invalid_coordinates]\n",
       {"half of sigma"}},
      {"no such chirality",
       "[5, 0]",
       "[5, 6]",
       "tube.toml:15:13: body.tube.chirality = [5, 6] [component.invalid]\n",
       {}},
      {"two thermostats on a body",
       "[run]",
       second,
       "tube.toml:66:15: force.second.temperature [component.unsuitable]\n",
       {"\"bath\"", "\"tube\""}},
      {"a thermostat with nothing free",
       "type = \"nose_hoover_chain\"\nbody = \"tube\"",
       "type = \"nose_hoover_chain\"\nbody = \"sheet\"",
       "tube.toml:52:15: force.bath.temperature [component.unsuitable]\n",
       {"\"sheet\""}},
      {"a thermostat with an adaptive scheme",
       "{ type = \"velocity_verlet\", dt = 1e-3 }",
       "{ type = \"dopri5\" }",
       "tube.toml:64:14: run.integrator.type = \"dopri5\" [integrator.unsuitable]\n",
       {"\"bath\"", "velocity_verlet"}},
      {"a thermostat with a multistage scheme",
       "\"velocity_verlet\"",
       "\"rk4\"",
       "tube.toml:64:14: run.integrator.type = \"rk4\" [integrator.unsuitable]\n",
       {"\"bath\"", "velocity_verlet"}},
      {"samples between steps",
       "every = 0.05",
       "every = 0.0505",
       "tube.toml:68:9: output.every = 0.0505 [component.unsuitable]\n",
       {"\"bath\"", "0.001"}},
  };
}

TEST_F(MolecularDynamics, FaultsHaveTheirPlace) {
  write(folder_ / "bad.tersoff",
        "# carbon\nC C C 3 1 0 38049 4.3484 -0.930 0.72751 1.5724e-7 2.2119\n"
        "430.0 1.95 0.1x5 3.4879 1393.6\n");
  write(folder_ / "silicon.tersoff",
        "Si Si Si 3 1 0 100390 16.217 -0.59825 0.78734 1.1e-6 1.7322 471.18 2.85 0.15 2.4799 "
        "1830.8\n");
  for (const SpoiltTube& spoilt : spoilt_tubes()) {
    SCOPED_TRACE(spoilt.what);
    const Ended ended = expect_status(2, run_of(tube_scene_with(spoilt.old_text, spoilt.new_text)));
    EXPECT_EQ(abridged(ended.err), spoilt.errors) << ended.err;
    expect_parts(ended.err, spoilt.words);
    EXPECT_FALSE(fs::exists(folder_ / "out"));
  }
}

TEST_F(MolecularDynamics, ThreadsAreANumber) {
  for (const char* wrong : {"0", "-1", "two", "5000", "1.5"}) {
    const Ended ended = run_of(kTubeOnSheet, {"--threads", wrong});
    EXPECT_EQ(ended.status, 2) << wrong;
    expect_parts(ended.err, {"--threads", "[command.invalid_value]"});
    EXPECT_FALSE(fs::exists(folder_ / "out"));
  }
}

TEST_F(MolecularDynamics, ThreadsChangeNoFile) {
  // A tube of 320 atoms, of which two threads have a part each.
  std::string scene = tube_scene_with("chirality = [5, 0]", "chirality = [40, 0]");
  scene = tube_scene_with("0.0, 5.2]", "0.0, 19.2]", scene);
  scene = tube_scene_with("\"4 * a\"", "\"16 * a\"", scene);
  scene = tube_scene_with("cells = [2, 4]", "cells = [2, 16]", scene);
  scene = tube_scene_with("duration = 1.0", "duration = 0.1", scene);
  const auto summary = [this] {
    Json all = Json::parse(file("out/summary.json"));
    const Json threads = all["performance"]["threads"];
    all.erase("performance");
    return std::pair(all.dump(), threads);
  };
  EXPECT_EQ(run_of(scene).status, 0);
  const auto alone = summary();
  const std::string table = file("out/observables.csv");
  EXPECT_EQ(alone.second, 1);
  EXPECT_EQ(run_of(scene, {"--threads", "3"}).status, 0);
  EXPECT_EQ(summary(), std::pair(alone.first, Json(3)));
  EXPECT_EQ(file("out/observables.csv"), table);
}

/// A valid scene is accepted, and so is one with atoms as near as they may be.
TEST_F(MolecularDynamics, WhatIsNotRefused) {
  const std::string shorter = tube_scene_with("duration = 1.0", "duration = 0.05");
  EXPECT_EQ(run_of(shorter).status, 0);
  // Its lowest atoms are 1.98 below the centre.
  EXPECT_EQ(run_of(tube_scene_with("5.2]", "3.7]", shorter)).status, 0);
  // In reduced units lengths are what the scene says, and so is the limit.
  expect_status(
      0,
      run_of(
          "[[body]]\ntype = \"particles\"\npositions = [[0.0, 0.0], [0.006, 0.0]]\n"
          "particle_mass = 1.0\n[[force]]\ntype = \"lennard_jones\"\nepsilon = 1.0\nsigma = 0.01\n"
          "cutoff = 0.03\n[run]\nduration = 1e-8\nintegrator = { type = \"velocity_verlet\", dt = "
          "1e-9 }\n"));
}

/// Whether a text contains nan or inf, as printed in a table.
bool has_non_finite(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const std::string word : {"nan", "inf"}) {
    for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
      const char next = at + word.size() < text.size() ? text[at + word.size()] : ' ';
      if (!std::isalpha(static_cast<unsigned char>(next))) return true;
    }
  }
  return false;
}

/// A step that is far too long: with a thermostat and without, in ways that differ by where the run
/// goes wrong.
TEST_F(MolecularDynamics, ARunawayNamesAtomSpeciesAndForce) {
  ASSERT_TRUE(has_non_finite("1,-nan,2") && has_non_finite("inf\n") && !has_non_finite("info"));
  const auto bath = kTubeOnSheet.find("[[force]]\nname = \"bath\"");
  std::string without = kTubeOnSheet;
  without.erase(bath, kTubeOnSheet.find("[[force]]\nname = \"driver\"") - bath);
  for (const std::string& scene : {kTubeOnSheet, without}) {
    for (const char* dt : {"0.01", "0.02", "0.05", "0.2", "1.0"}) {
      SCOPED_TRACE(dt);
      const std::string step = std::string("dt = ") + dt;
      const std::string text = tube_scene_with(
          "every = 0.05", std::string("every = ") + dt,
          tube_scene_with(
              "dt = 1e-3", step,
              tube_scene_with("duration = 1.0", "duration = 100.0\nallow_unstable = true", scene)));
      const Ended ended = expect_status(1, run_of(text));
      EXPECT_FALSE(contains(ended.err, "file.cannot_write")) << ended.err;
      const Json failure = summary("out")["failure"];
      EXPECT_EQ(failure["code"], "run.step.unstable");
      EXPECT_EQ(failure["body"], "tube");
      EXPECT_GE(failure["particle"], 0);
      EXPECT_TRUE(failure["force"] == "bonds" || failure["force"] == "bath" ||
                  failure["force"] == "contact")
          << failure;
      EXPECT_TRUE(contains(failure["what"], "species C")) << failure;
      for (const char* name : {"out/observables.csv", "out/summary.json", "out/events.csv"}) {
        EXPECT_FALSE(has_non_finite(file(name))) << name;
      }
    }
  }
}

/// A body that starts so hot that the thermostat has no flow for it.
TEST_F(MolecularDynamics, AThermostatThatFailsIsNamed) {
  const std::string hot =
      tube_scene_with("start_temperature = 300.0", "start_temperature = 1e4",
                      tube_scene_with("temperature = 300.0\nperiod", "temperature = 1e-9\nperiod"));
  expect_status(1, run_of(hot));
  const Json failure = summary("out")["failure"];
  EXPECT_EQ(failure["body"], "tube");
  EXPECT_EQ(failure["force"], "bath") << failure;
  for (const char* name : {"out/observables.csv", "out/summary.json"}) {
    EXPECT_FALSE(has_non_finite(file(name))) << name;
  }
}

TEST_F(MolecularDynamics, ExplainCountsNeighbours) {
  write(folder_ / "tube.toml", kTubeOnSheet);
  const Ended ended = expect_status(0, tomlin({"explain", "tube.toml", "--json"}));
  const Json scene = Json::parse(ended.out);
  // Within 2.1 and the inner skin of 0.17 are three neighbours; two on the same ring, 2.33 away,
  // are not.
  const Json bonds = scene["forces"][0]["neighbours"];
  EXPECT_EQ(bonds["mean"], 3.0);
  EXPECT_EQ(bonds["most"], 3);
  EXPECT_EQ(bonds["pairs"], 60);
  // Each of 40 atoms takes bytes for itself and the scratch of its forces, not for all others.
  EXPECT_GT(bonds["bytes"], 40 * 3 * 8);
  EXPECT_LT(bonds["bytes"], 40 * 2000);
  const Json contact = scene["forces"][1]["neighbours"];
  EXPECT_GT(contact["most"], contact["mean"]);
  EXPECT_NEAR(contact["pairs"], 40.0 * contact["mean"].get<double>(), 1e-6);
  EXPECT_FALSE(scene["forces"][3].contains("neighbours"));
  // Phonons of graphene have frequencies of at most 1600/cm, so that velocity Verlet is stable up
  // to 6.6 fs; the bound is at most half as long.
  EXPECT_GT(scene["integrator"]["stable_step"], 3.3e-3);
  EXPECT_LT(scene["integrator"]["stable_step"], 6.6e-3);
  EXPECT_TRUE(contains(tomlin({"explain", "tube.toml"}).out, "3 neighbours of a particle"));
}

/// A force that starts later has no lists yet.
TEST_F(MolecularDynamics, ExplainKnowsNoNeighboursOfAForceThatStartsLater) {
  std::string later = kTubeOnSheet;
  const std::string type = "type = \"tersoff\"\n";
  ASSERT_NE(later.find(type), std::string::npos);
  later.insert(later.find(type), "active = { from = 0.01 }\n");
  write(folder_ / "later.toml", later);
  const Ended ended = expect_status(0, tomlin({"explain", "later.toml", "--json"}));
  EXPECT_EQ(Json::parse(ended.out)["forces"][0]["neighbours"]["pairs"], 0);
}

}  // namespace
}  // namespace tomlin::test
