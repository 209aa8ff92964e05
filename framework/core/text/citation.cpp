#include "framework/core/text/citation.hpp"

#include <algorithm>

namespace tomlin {
namespace {

constexpr std::string_view kBetweenWorks = "; ";
constexpr std::string_view kDoi = "doi:";
constexpr std::string_view kAfterDoi = ", ";

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view spaces = " \t\r\n";
  const auto begin = text.find_first_not_of(spaces);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(spaces) - begin + 1);
}

Citation citation(std::string_view text) {
  const auto doi = text.find(kDoi);
  const auto end = doi == std::string_view::npos ? doi : text.find(kAfterDoi, doi);
  if (end == std::string_view::npos) return {std::string(text), ""};
  return {std::string(text.substr(0, end)),
          std::string(trimmed(text.substr(end + kAfterDoi.size())))};
}

}  // namespace

std::vector<Citation> citations(std::string_view source) {
  std::vector<Citation> result;
  while (!source.empty()) {
    const auto end = std::min(source.find(kBetweenWorks), source.size());
    if (const auto work = trimmed(source.substr(0, end)); !work.empty()) {
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
  for (char& c : identity) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return identity;
}

}  // namespace tomlin
