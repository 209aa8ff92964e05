#include "framework/core/text/citation.hpp"

#include <algorithm>

#include "framework/core/text/ascii.hpp"

namespace tomlin {
namespace {

constexpr std::string_view kBetweenWorks = "; ";
constexpr std::string_view kDoi = "doi:";
constexpr std::string_view kAfterDoi = ", ";
constexpr std::string_view kWhiteSpace = " \t\r\n";

Citation citation(std::string_view text) {
  const auto doi = text.find(kDoi);
  const auto end = doi == std::string_view::npos ? doi : text.find(kAfterDoi, doi);
  if (end == std::string_view::npos) return {std::string(text), ""};
  return {std::string(text.substr(0, end)),
          std::string(trimmed(text.substr(end + kAfterDoi.size()), kWhiteSpace))};
}

}  // namespace

std::vector<Citation> citations(std::string_view source) {
  std::vector<Citation> result;
  while (!source.empty()) {
    const auto end = std::min(source.find(kBetweenWorks), source.size());
    if (const auto work = trimmed(source.substr(0, end), kWhiteSpace); !work.empty()) {
      result.push_back(citation(work));
    }
    source.remove_prefix(std::min(end + kBetweenWorks.size(), source.size()));
  }
  return result;
}

std::string identity_of(const Citation& citation) {
  const auto doi = citation.work.find(kDoi);
  if (doi == std::string::npos) return citation.work;
  std::string identity = citation.work.substr(doi);
  for (char& c : identity) c = in_lower_case(c);
  return identity;
}

}  // namespace tomlin
