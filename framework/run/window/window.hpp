#pragma once

#include <cstddef>
#include <cstdint>

#include "framework/model/model.hpp"

namespace tomlin {

class Rotations;

/// The window of [measure], with what stands at its edges: what is measured in it is a difference
/// of the two. With [run] until it is one period of the driver after another.
class MeasureWindow {
 public:
  /// One edge; the numbers stand in the run's state.
  struct Edge {
    double time = 0.0;
    std::int64_t* reached = nullptr;
    double* integrals = nullptr;
    double* centre = nullptr;  ///< [body * dimension + axis][high, low], cells included
    double* turns = nullptr;   ///< [body]
    double* stored = nullptr;  ///< kinetic and potential energy, with the ledger

    DoubleDouble position(std::size_t k) const { return {centre[2 * k], centre[2 * k + 1]}; }
  };

  explicit MeasureWindow(const Model& model) : model_(model) {}
  void declare(StateLayout& layout) const;
  void attach(RunState& state);

  const Edge& from() const { return from_; }
  const Edge& to() const { return to_; }
  void set(double from, double to);
  double length() const { return to_.time - from_.time; }
  bool contains(double time) const { return time >= from_.time && time <= to_.time; }
  bool is_open() const { return *from_.reached != 0 && *to_.reached == 0; }
  /// Both edges were reached.
  bool is_over() const { return *from_.reached != 0 && *to_.reached != 0; }
  /// The next edge; infinite where there is none.
  double next_edge() const;

  double gained(std::ptrdiff_t rate) const { return to_.integrals[rate] - from_.integrals[rate]; }
  DoubleDouble moved(std::size_t body, std::size_t axis) const;
  double turned(std::size_t body) const { return to_.turns[body] - from_.turns[body]; }

  /// The next edge is at this state. `stored` is kept with a ledger.
  void reach(const double* position, const double* integrals, const Rotations& rotations,
             double stored);
  /// The window begins where it ended, and ends at a later time.
  void shift_to(double end);

 private:
  const Model& model_;
  Edge from_;
  Edge to_;
};

}  // namespace tomlin
