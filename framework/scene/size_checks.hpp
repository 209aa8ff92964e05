#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "framework/scene/checks.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/fault_list.hpp"

/// How much a scene may ask for: what would take too long to read or too much memory to run is
/// refused before anything of it is evaluated or built. See document.hpp and expression.hpp for the
/// limits of a file and of one expression.
namespace tomlin {

inline constexpr std::size_t kMostComponents = 10'000;  ///< bodies, or forces, of a scene
inline constexpr std::size_t kMostParameters = 10'000;
/// Bytes of all expressions of a scene. The costliest, powers, take some seconds at that size.
inline constexpr std::size_t kMostExpressionText = std::size_t{1} << 20;

inline constexpr std::int64_t kMostParticles = 10'000'000;  ///< of a scene
inline constexpr std::uint64_t kMostPairs = 50'000'000;     ///< of a scene

// Bytes that a run takes for each, as measured with double precision and rk4, and rounded; a
// multistage or adaptive scheme, quadruple precision and each force add to it.
inline constexpr double kBytesPerParticle = 260.0;
inline constexpr double kBytesPerCoordinate = 160.0;  ///< of each particle
inline constexpr double kBytesPerPair = 80.0;

/// False when they are too long in all, and reported. Texts that are more than a word count as
/// expressions; `[scene]` holds none.
bool check_expressions(const Table& document, FaultList& faults);

/// Number of particles of each body, where it can be computed.
void count_particles(std::vector<BodyDraft>& bodies, std::optional<int> dimension,
                     FaultList& faults);

/// Adds up the pairs that forces will hold.
class PairCount {
 public:
  /// False when these are too many, and reported.
  bool add(ForceDraft& force, const SceneOutline& outline, FaultList& faults);

 private:
  std::uint64_t total_ = 0;
};

}  // namespace tomlin
