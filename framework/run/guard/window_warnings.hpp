#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "framework/core/text/warning.hpp"
#include "framework/model/model.hpp"

/// Windows whose means say little of sliding.
namespace tomlin {

/// A driver, and what it and the body that it pulls do within the window.
struct DriverWindow {
  std::string driver;
  double from = 0.0;  ///< times
  double to = 0.0;
  int axis = 0;            ///< of its period; without one that along which it is fastest
  double speed = 0.0;      ///< along that axis
  double period = 0.0;     ///< of the forces along its way, a length; 0: there is none
  bool steady = true;      ///< its velocity is the same within the window
  bool one_period = true;  ///< no two forces have different periods along its way
};

/// The window as a driver of the scene sees it.
DriverWindow driver_window(const Model& model, std::size_t driver, double from, double to);

/// Whether it is a whole number of the driver's periods.
bool is_whole(const DriverWindow& window);

/// Before the run: the driver hardly moves within it, or it is no whole number of periods.
std::optional<Warning> doubt_before(const DriverWindow& window);

/// After the run, in which the pulled body has `moved` along the driver's way within the window and
/// so many slips have begun there; nothing where slips are not looked for. `whole_run` of them.
/// `at_end`: the window ends where the run does.
std::optional<Warning> doubt_after(const DriverWindow& window, double moved,
                                   std::optional<std::uint64_t> slips, std::uint64_t whole_run,
                                   bool at_end);

}  // namespace tomlin
