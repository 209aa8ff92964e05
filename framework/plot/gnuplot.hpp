#pragma once

#include <stdexcept>
#include <string>

namespace tomlin {

/// gnuplot did not draw a figure; the message has what it said.
class GnuplotError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Names another gnuplot than the one in PATH.
inline constexpr const char* kGnuplotVariable = "TOMLIN_GNUPLOT";

/// Has gnuplot carry out a script, without a shell and without its user's settings, and returns
/// what it writes to its standard output. Throws InputError when there is no gnuplot, GnuplotError
/// when it fails.
std::string run_gnuplot(const std::string& script);

}  // namespace tomlin
