#include "framework/run/window/window.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include "framework/run/results/rotations.hpp"

namespace tomlin {

void MeasureWindow::declare(StateLayout& layout) const {
  const std::size_t bodies = model_.bodies().size();
  for (const char* edge : {"window.from", "window.to"}) {
    const std::string name = edge;
    layout.add_integers(name, 1);
    layout.add_reals(name + ".integrals", model_.system().view.rates);
    layout.add_reals(name + ".centre", 2 * bodies * model_.dimension());
    layout.add_reals(name + ".turns", bodies);
    layout.add_reals(name + ".stored", 1);
  }
}

void MeasureWindow::attach(RunState& state) {
  for (Edge* edge : {&from_, &to_}) {
    const std::string name = edge == &from_ ? "window.from" : "window.to";
    edge->reached = state.integers(name);
    edge->integrals = state.reals(name + ".integrals");
    edge->centre = state.reals(name + ".centre");
    edge->turns = state.reals(name + ".turns");
    edge->stored = state.reals(name + ".stored");
  }
}

void MeasureWindow::set(double from, double to) {
  from_.time = from;
  to_.time = to;
}

double MeasureWindow::next_edge() const {
  if (*from_.reached == 0) return from_.time;
  return *to_.reached == 0 ? to_.time : std::numeric_limits<double>::infinity();
}

DoubleDouble MeasureWindow::moved(std::size_t body, std::size_t axis) const {
  const std::size_t k = body * static_cast<std::size_t>(model_.dimension()) + axis;
  return to_.position(k) - from_.position(k);
}

void MeasureWindow::reach(const double* position, const double* integrals,
                          const Rotations& rotations, double stored) {
  Edge& edge = *from_.reached == 0 ? from_ : to_;
  *edge.reached = 1;
  std::copy_n(integrals, model_.system().view.rates, edge.integrals);
  const int axes = model_.dimension();
  for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
    double centre[3];
    model_.centre(b, position, centre);
    for (int d = 0; d < axes; ++d) {
      const DoubleDouble absolute = model_.placed(d, centre[d]);
      edge.centre[2 * (b * axes + d)] = absolute.hi;
      edge.centre[2 * (b * axes + d) + 1] = absolute.lo;
    }
    edge.turns[b] = rotations.turns_of(b, position);
  }
  *edge.stored = stored;
}

void MeasureWindow::shift_to(double end) {
  set(to_.time, end);
  *to_.reached = 0;
  const std::size_t bodies = model_.bodies().size();
  std::copy_n(to_.integrals, model_.system().view.rates, from_.integrals);
  std::copy_n(to_.centre, 2 * bodies * model_.dimension(), from_.centre);
  std::copy_n(to_.turns, bodies, from_.turns);
  *from_.stored = *to_.stored;
}

}  // namespace tomlin
