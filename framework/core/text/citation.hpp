#pragma once

#include <string>
#include <string_view>
#include <vector>

/// Works that a source names, so that they can be cited.
namespace tomlin {

/// A work, and where in it what is taken from it stands.
struct Citation {
  std::string work;     ///< "A. Sircar and P. K. Patra, ..., doi:10.48550/arXiv.1912.00232"
  std::string passage;  ///< "eqs. (4) to (6)"; may be empty
};

/// The works of a source, which is written "WORK, doi:..., PASSAGE; WORK, doi:...". What follows a
/// DOI is the passage; a work without a DOI is taken whole.
std::vector<Citation> citations(std::string_view source);

/// Identity of a work: its DOI, in small letters as DOIs are compared, or else its text.
std::string identity_of(const Citation& citation);

}  // namespace tomlin
