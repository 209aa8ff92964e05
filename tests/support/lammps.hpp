#pragma once

#include <array>
#include <cstddef>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "framework/lammps/lammps_input.hpp"
#include "tests/framework/output/temporary_folder.hpp"

/// Runs what a scene becomes in LAMMPS.
namespace tomlin::test {

inline bool has_lammps() {
  static const bool found = std::system("command -v lmp >/dev/null 2>&1") == 0;
  return found;
}

/// Energy, positions (as if the box had no sides) and forces of atoms in the order of bodies and
/// particles, [atom][axis].
struct LammpsState {
  double energy = 0.0;
  std::vector<std::array<double, 3>> position;
  std::vector<std::array<double, 3>> force;
};

inline LammpsState run_lammps(const std::vector<LammpsFile>& files, long steps) {
  const TemporaryFolder folder;
  for (const LammpsFile& file : files) write(folder / file.name, file.text);
  write(folder / "test.lmp",
        "include in.lmp\n"
        "print \"$(pe:%.17g)\" file energy.txt\n"
        "write_dump all custom atoms.txt xu yu zu fx fy fz modify sort id format float %.17g\n");
  // Open MPI refuses root without these, and starts a daemon where it may.
  const std::string command = "cd '" + folder.path().string() +
                              "' && OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
                              "OMPI_MCA_ess_singleton_isolated=1 "
                              "OMP_NUM_THREADS=1 timeout 300 lmp -in test.lmp -var steps " +
                              std::to_string(steps) + " -log none > log.txt 2>&1";
  if (std::system(command.c_str()) != 0) {
    throw std::runtime_error("lmp failed:\n" + content(folder / "log.txt") + "\n" +
                             files.back().text);
  }
  LammpsState state;
  std::istringstream(content(folder / "energy.txt")) >> state.energy;
  std::istringstream atoms(content(folder / "atoms.txt"));
  std::string line;
  while (std::getline(atoms, line) && line.rfind("ITEM: ATOMS", 0) != 0) continue;
  while (std::getline(atoms, line)) {
    std::istringstream numbers(line);
    std::array<double, 3> x{};
    std::array<double, 3> f{};
    numbers >> x[0] >> x[1] >> x[2] >> f[0] >> f[1] >> f[2];
    state.position.push_back(x);
    state.force.push_back(f);
  }
  return state;
}

}  // namespace tomlin::test
