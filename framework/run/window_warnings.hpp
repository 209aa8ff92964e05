#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// Windows whose means say little of sliding.
namespace tomlin {

/// A driver, and what it and the body that it pulls do within the window.
struct DriverWindow {
  std::string driver;
  double from = 0.0;  ///< times
  double to = 0.0;
  double speed = 0.0;
  double period = 0.0;  ///< of the forces along its way, a length; 0: there is none
  bool steady = true;   ///< its velocity is the same within the window
};

/// Whether it is a whole number of the driver's periods.
bool is_whole(const DriverWindow& window);

/// Before the run: the driver hardly moves within it, or it is no whole number of periods.
std::vector<std::string> doubts_before(const DriverWindow& window);

/// After the run, in which the pulled body has `moved` along the driver's way within the window and
/// so many slips have begun there; nothing where slips are not looked for. `whole_run` of them.
std::vector<std::string> doubts_after(const DriverWindow& window, double moved,
                                      std::optional<std::uint64_t> slips, std::uint64_t whole_run);

}  // namespace tomlin
