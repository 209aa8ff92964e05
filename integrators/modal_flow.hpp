#pragma once

#include <cstddef>
#include <vector>

#include "framework/core/system/elastic.hpp"

/// The motion of one body under its bonds and its friction alone, in normal coordinates.
namespace tomlin {

/// The exact flow of q'' = -square (q - q0) - rate q' over h:
///   q - q0 <- a (q - q0) + b p,   p <- c (q - q0) + d p,
/// and what a force g does to it over a step.
///
/// Kicks before and after the flow last `first` and `last`, h together but for their filter,
/// sin(h omega)/(h omega) with the damped frequency. They are h/2 each without friction; with it
/// they are divided such that under a steady force p is that of the steady state at every step's
/// end: 0 for a mode with bonds, the terminal velocity g/rate for one without.
struct ModeFlow {
  double a = 1.0;
  double b = 0.0;
  double c = 0.0;
  double d = 1.0;
  double filter = 1.0;
  double first = 0.0;
  double last = 0.0;
  double pushed = 0.0;  ///< displacement from rest at q0 by a steady unit force
  double travel = 0.0;  ///< where square = 0: integral of its squared velocity meanwhile
};
ModeFlow mode_flow(double square, double rate, double h);

/// Energy that friction takes from a mode over h from q - q0 = u and p on, under a steady force g:
/// the integral of rate p^2.
double mode_heat(const ModeFlow& flow, double square, double rate, double u, double p, double g);

/// One body within a step. Vectors run over its coordinates as in ElasticBody.
class ModalBody {
 public:
  explicit ModalBody(const ElasticBody& body);

  /// At the start: puts the frame on the body, and gives the first kick. Returns the heat of
  /// friction over the step, of the exact flow under the forces at its start.
  double enter(const double* position, const double* velocity, const double* force, double h);
  /// After enter(): whether the modes still follow the bonds. What bonds do at the present shape
  /// beyond their linear part is left to the kicks, whose filter loses part of it: no more than
  /// kLostForce of the bonds' force, or of the largest `other` force so far.
  bool keeps_shape(double& other);
  /// From there on over h: positions and velocities before the last kick.
  void flow(double h, double* move, double* velocity);
  /// The last kick, by the forces at the new positions.
  void leave(const double* force, double* velocity);

  /// Whether a step of h is long against the time in which friction stops a motion: a cubic
  /// does not follow it.
  bool is_stopped_within(double h) const;
  /// Then the state at a part theta of it, from both ends: the exact motion under friction and a
  /// force that changes linearly, which fits them.
  void interpolate(double theta, double h, const double* const start[2], const double* const end[2],
                   double* position, double* velocity) const;

 private:
  using Vector = std::vector<double>;

  void prepare(double h);
  void place_frame(const double* position);
  void to_frame(const double* from, Vector& to) const;
  void turn(Vector& x, double sine, double cosine) const;
  void to_modes(const Vector& x, Vector& q) const;
  void from_modes(const Vector& q, Vector& x) const;
  /// Two particles in the plane with bonds between them, as a spring that gives their block of the
  /// matrix K: exact for springs, and for others in what turning them does.
  struct Spring {
    std::size_t first = 0;
    std::size_t second = 0;
    double apart[2] = {};  ///< in the shape
    double length = 0.0;
    double along = 0.0;  ///< stiffness along it
    double force = 0.0;  ///< at that length
    double block[4] = {};
  };

  void list_springs();
  double first_kick();
  void last_kick();
  void find_kick();
  void find_motion();
  void centrifugal_kick(double rate, double half);

  const ElasticBody& body_;
  bool bonded_;
  std::size_t n_;
  double known_h_ = 0.0;
  std::vector<ModeFlow> flows_;
  std::vector<Spring> springs_;
  double rounding_ = 0.0;  ///< of forces between them
  ModeFlow whole_;         ///< of what no bond holds

  // The frame: its centre, relative to the scene's origin, its turn, and how both move.
  double centre_[3] = {};
  double cosine_ = 1.0;
  double sine_ = 0.0;
  double speed_[3] = {};  ///< in the frame
  double spin_ = 0.0;

  Vector position_;  ///< in the frame, from the centre
  Vector before_;
  Vector velocity_;  ///< in the frame; without the frame's own after find_motion()
  Vector force_;
  Vector q_, p_, g_, beyond_;
  Vector rotated_;
  Vector forward_;  ///< coordinates to modes, [coordinate * n + mode]
  Vector back_;     ///< modes to coordinates, [mode * n + coordinate]
};

}  // namespace tomlin
