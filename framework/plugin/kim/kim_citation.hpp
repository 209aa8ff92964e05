#pragma once

#include <string>
#include <string_view>

namespace tomlin::kim {

/// The work that a model is from, by its `kimspec.edn`: authors, journal, volume, pages, year and
/// DOI of the citation that it calls the primary one, else of the first. Empty where there is none.
std::string citation_of(std::string_view kimspec);

}  // namespace tomlin::kim
