#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "framework/scene/scene.hpp"

/// Declarations of a scene's forces by their traits and contracts, held against what they do to
/// this scene's bodies with this scene's numbers. The properties themselves stand in properties/.
namespace tomlin {

/// The state in which a property was closest to breaking, or broke.
struct PropertyPoint {
  std::string state;             ///< "near the start", "far away", "almost touching", ...
  std::string body;              ///< empty: everything together
  std::ptrdiff_t particle = -1;  ///< -1: the body as a whole
  std::string coordinate;        ///< "x", "rotation"; empty: all of them
  std::vector<double> position;  ///< of the particle or the centre, relative to the scene's origin
  double time = 0.0;
  double found = 0.0;
  double expected = 0.0;

  std::string text() const;
};

/// Name under which the properties of all forces together are filed.
inline constexpr const char* kAllForces = "all forces";

/// One property of one force, or of all.
struct PropertyResult {
  std::string force;  ///< its name in the scene, or kAllForces
  std::string type;
  std::string property;  ///< "conservative", "internal", "dissipative", "periodic", ...
  std::string meaning;   ///< what was compared: "force = -gradient of the energy"
  bool holds = false;
  /// Relative, at the state where it is the largest part of what is allowed.
  double error = 0.0;
  double allowed = 0.0;  ///< what rounding and finite differences explain there
  int states = 0;        ///< at which something was compared; 0: the property holds for want of any
  PropertyPoint worst;
};

struct PropertyOptions {
  int displaced_states = 8;                 ///< besides the start
  std::uint64_t seed = 1;                   ///< of the displacements
  const std::atomic<bool>* stop = nullptr;  ///< true: no further property is looked at
};

/// Checks every force that the scene builds, in the scene's order, each on its own, then all of
/// them together. Looks at the start; near it, at random displacements of every coordinate by up to
/// a tenth of a length: the shortest that the scene declares, or the force's own where nothing
/// declares one or it is much shorter; far away, by a thousand and a million of them; high above
/// the start; and where two free particles almost touch, a thousandth and a millionth of a length
/// apart.
///
///   conservative   virtual work of the force equals minus the change of its energy, by differences
///                  whose error falls as h^8; near the start, and everywhere where `exact` cannot
///                  be
///   exact          the same everywhere, in quadruple precision: exact to a double's last digits
///   quadruple      the same of forces in quadruple precision, to their digits; of others power and
///                  heat
///   path           the same along paths of some lengths, where an energy may jump
///   hessian        second derivatives are the slopes of the force
///   stiffness      no curvature is beyond the declared bound, on which the stable step depends
///   finite         forces are numbers: also far away; where two particles touch either that or no
///                  number at all, which stops a run
///   internal       forces and torques on all bodies it acts on sum to zero
///   dissipative    its power is never positive, at any speed
///   friction       the friction matrix is what it does to velocities, at any speed, and never
///                  negative
///   friction bound no change of velocities changes it by more than the declared bound says, on
///                  which the stable step depends
///   balance        power, stored energy, heat and a driver's work add up, as the energy balance
///   needs flow           the operator that it provides is the exact solution of the force alone
///   flow repeats   with the same bits from the same stage
///   heat of flow   and takes the energy that is gone
///   driver         reports the force it exerts and its power
///   periodic       a shift by the declared period, or by millions, changes nothing
///   rebase         an origin moved by whole periods changes no bit
///   origin         nothing changes when positions are counted from elsewhere
///   velocity       what is not said to depend on velocities does not
///   time           what is not said to depend on time does not; what does, however time is counted
///   repeatable     the same bits again, whatever was evaluated in between
///   its own        touches nothing but forces on its own bodies, and adds to what is there
///   set and add    kernels that set write what those that add give to zeros, over anything
///   padding        forces are zero from the last particle of a body to the end of its group
///   point          the kernel of a single particle on a line has the bits of the loop
///   same bits      on every instruction set, in double precision
///   number types   the same in double and quadruple precision, each to its own rounding
///
/// What one state cannot refute has to be seen at one at least: where none shows it, nothing was
/// compared, and the property holds with no state.
///
///   not conservative  where it is not declared: the force is not the gradient of its energy
///   not internal      where it is not declared: forces do not sum to zero
///   uses velocity     where it is declared
///   uses time         where it is declared
///   tight             some curvature comes to half of the declared bound
///   digits            each number type rounds as its precision says
///
/// and last all of them together, as "all forces":
///
///   sum           what they do together is the sum of what each does alone, and so are the forces
///                 and the power of drivers: with no numbers in the arrays before, the same bits
///                 when evaluated again, in the opposite order too; near the start
///
/// Throws InputError when the scene cannot be bound.
std::vector<PropertyResult> check_properties(const Scene& scene,
                                             const PropertyOptions& options = {});

}  // namespace tomlin
