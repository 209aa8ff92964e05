#pragma once

#include <string>
#include <vector>

#include "tests/extremes/extreme_case.hpp"
#include "tests/extremes/observed.hpp"

namespace tomlin::test {

/// Returns the text of the page before its tables.
std::string page_preface();

/// A table of one subject; `observed` in the order of its cases, empty for a case not run.
std::string page_section(const Subject& subject, const std::vector<const Observed*>& observed);

}  // namespace tomlin::test
