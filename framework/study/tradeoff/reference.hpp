#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "framework/study/tradeoff/measurer.hpp"

namespace tomlin {

/// The value that all others are held against, and how far it can be trusted.
struct Reference {
  std::string method;  ///< the scheme that found it
  Resolution resolution = Resolution::tolerance;
  double resolution_value = 0.0;
  double value = 0.0;
  double natural = 1.0;  ///< what has the observable's dimension in the scene's own units
  /// Estimated: the last move when the scheme was tightened, or its difference to the second
  /// scheme or to quadruple precision where that is larger.
  double error = 0.0;
  double move = 0.0;  ///< the last one alone
  /// Whether it stopped moving. Otherwise the budget was over, or it moves for another reason.
  bool settled = false;
  bool finest = false;  ///< tightened as far as the numbers allow
  std::uint64_t cost = 0;
  double seconds = 0.0;

  std::string second;                    ///< the other scheme; empty: there is none
  std::optional<double> second_differs;  ///< by so much, at its tightest
  bool second_agrees = false;            ///< to well below the tolerance
  bool second_settled = false;           ///< the difference is not the second's own error
  std::string quadruple;  ///< the scheme that was compared with itself in quadruple precision
  std::optional<double> quadruple_differs;
  double quadruple_part = 0.0;  ///< of the run
  std::string unchecked;        ///< why there was no run in quadruple
};

/// Errors relative to the reference; where that is zero to the last digits of what the scene's own
/// units have for it, relative to that. A value that is neither larger than its own error nor zero
/// is not resolved: nothing can be held against it.
struct ErrorScale {
  bool relative = true;
  bool resolved = true;
  double size = 1.0;  ///< what an error is divided by
};
ErrorScale error_scale(const Reference& reference);

/// Finds the reference by the adaptive scheme that gets to small errors soonest on this scene,
/// tightened until its moves are a small part of `tolerance`; holds it against a scheme of another
/// family, and against itself in quadruple precision on a shortened run. Uses about half the budget
/// at most. Nothing when no scheme finishes within it: `why` then tells how far they got. Throws
/// InputError when the observable is undefined.
std::optional<Reference> find_reference(const Variants& variants,
                                        const std::vector<Method>& methods, Measurer& measurer,
                                        double tolerance, std::string& why);

}  // namespace tomlin
