#pragma once

#include <cstddef>
#include <vector>

#include "framework/core/elastic.hpp"

/// The motion of one body under its bonds and its friction alone, in normal coordinates.
namespace tomlin {

/// The exact flow of q'' = -square (q - q0) - rate q' over h:
///   q - q0 <- a (q - q0) + b p,   p <- c (q - q0) + d p,
/// and the filter of its kicks, sin(h omega)/(h omega).
struct ModeFlow {
  double a = 1.0;
  double b = 0.0;
  double c = 0.0;
  double d = 1.0;
  double filter = 1.0;
};
ModeFlow mode_flow(double square, double rate, double h);

/// One body within a step. Vectors run over its coordinates as in ElasticBody.
class ModalBody {
 public:
  explicit ModalBody(const ElasticBody& body);

  /// At the start: puts the frame on the body, and kicks by forces over h/2.
  void enter(const double* position, const double* velocity, const double* force, double h);
  /// From there on over h: positions and velocities before the last kick.
  void flow(double h, double* move, double* velocity);
  /// The last kick, by the forces at the new positions.
  void leave(const double* force, double h, double* velocity);

 private:
  using Vector = std::vector<double>;

  void prepare(double h);
  void place_frame(const double* position);
  void to_frame(const double* from, Vector& to) const;
  void add_from_frame(const Vector& from, double* to) const;
  void turn(Vector& x, double sine, double cosine) const;
  void to_modes(const Vector& x, Vector& q) const;
  void from_modes(const Vector& q, Vector& x) const;
  void kick(const Vector& force, double half);
  void find_motion();
  void centrifugal_kick(double rate, double half);

  const ElasticBody& body_;
  bool bonded_;
  std::size_t n_;
  double known_h_ = 0.0;
  std::vector<ModeFlow> flows_;
  ModeFlow whole_;  ///< of what no bond holds

  // The frame: its centre, relative to the scene's origin, its turn, and how both move.
  double centre_[3] = {};
  double cosine_ = 1.0;
  double sine_ = 0.0;
  double speed_[3] = {};  ///< in the frame
  double spin_ = 0.0;

  Vector place_;  ///< in the frame, from the centre
  Vector before_;
  Vector velocity_;  ///< in the frame; without the frame's own after find_motion()
  Vector force_;
  Vector q_, p_, g_;
  Vector rotated_;
  Vector forward_;  ///< coordinates to modes, [coordinate * n + mode]
  Vector back_;     ///< modes to coordinates, [mode * n + coordinate]
};

}  // namespace tomlin
