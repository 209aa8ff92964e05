// Writes trajectories for programs that read them: write_trajectories FOLDER. One of them ends in
// the middle, as that of a run that was killed.
#include <csignal>
#include <filesystem>

#include <sys/wait.h>
#include <unistd.h>

#include "framework/output/extended_xyz.hpp"
#include "framework/output/h5md.hpp"
#include "tests/framework/output/trajectory_fixture.hpp"

int main(int, char** arguments) {
  using namespace tomlin;
  using namespace tomlin::test;
  const std::filesystem::path folder = arguments[1];
  for (const auto& [name, layout] :
       {std::pair{"two_bodies", two_bodies()}, {"species", with_species()}, {"line", line_of(3)}}) {
    for (const auto& [format, suffix] :
         {std::pair{TrajectoryFormat::h5md, ".h5"}, {TrajectoryFormat::xyz, ".xyz"}}) {
      const auto writer =
          trajectory_writer(format, folder / (std::string(name) + suffix), layout, some_facts());
      write_frames(*writer, layout, 5);
      writer->finish();
    }
  }
  TrajectoryFacts metal = some_facts();
  metal.units = UnitSystem::metal;
  H5mdWriter writer(folder / "metal.h5", two_bodies(), metal);
  write_frames(writer, two_bodies(), 5);
  writer.finish();
  const pid_t child = ::fork();
  if (child == 0) {
    H5mdWriter writer(folder / "killed.h5", line_of(1), some_facts());
    write_frames(writer, line_of(1), 100000);
    ::raise(SIGKILL);
  }
  return ::waitpid(child, nullptr, 0) == child ? 0 : 1;
}
