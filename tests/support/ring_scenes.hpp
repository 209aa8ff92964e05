#pragma once

#include <string>

#include "tests/support/scenes.hpp"

/// The scenes that most tests of runs share: a Prandtl-Tomlinson tip and the paper's ring.
namespace tomlin::test {

struct TipScene {
  double velocity = 0.25;
  double stiffness = 2.0;
  double damping = 1.0;
  double amplitude = 0.1;
  double period = 1.0;
  double position = 0.1;
  double start_velocity = 0.0;
  double duration = 20.0;
  std::string integrator = "{ type = \"rk4\", dt = 0.01 }";
  std::string more = "";  ///< [measure], [output]

  std::string text() const {
    return "[[body]]\nname = \"tip\"\ntype = \"point\"\nparticle_mass = 1.0\nposition = [" +
           digits(position) + "]\nvelocity = [" + digits(start_velocity) +
           "]\n"
           "[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = " +
           digits(stiffness) + "\nvelocity = [" + digits(velocity) +
           "]\n"
           "[[force]]\ntype = \"viscous_damping\"\ncoefficient = " +
           digits(damping) +
           "\n[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = " + digits(amplitude) +
           "\nperiod = " + digits(period) + "\n[run]\nduration = " + digits(duration) +
           "\nintegrator = " + integrator + "\n" + more;
  }
};

struct RingScene {
  std::string coordinates = "particles";
  int count = 8;
  double bonds = 1e3;
  double velocity = 0.25;
  double decay = 1.0;
  double period = 1.0;
  double centre = 0.0;
  double duration = 10.0;
  std::string integrator = "{ type = \"rk4\", dt = 0.002 }";
  std::string more = "";

  std::string text() const {
    const std::string n = std::to_string(count);
    return "[[body]]\nname = \"ring\"\ntype = \"ring\"\nradius = 1.0\ncount = " + n +
           "\nparticle_mass = \"1 / " + n + "\"\ncentre = [" + digits(centre) +
           ", 1.0]\ncoordinates = \"" + coordinates +
           "\"\n"
           "[[force]]\ntype = \"harmonic_bonds\"\npairs = \"all\"\nstiffness = " +
           digits(bonds) +
           "\n[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = 2.0\nvelocity = "
           "[" +
           digits(velocity) +
           ", 0.0]\n"
           "[[force]]\ntype = \"viscous_damping\"\ncoefficient = \"2 * sqrt(2) / " +
           n + "\"\n[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = \"0.1 / " + n +
           "\"\nperiod = " + digits(period) + "\ndecay = " + digits(decay) +
           "\n[run]\nduration = " + digits(duration) + "\nintegrator = " + integrator + "\n" + more;
  }
};

}  // namespace tomlin::test
