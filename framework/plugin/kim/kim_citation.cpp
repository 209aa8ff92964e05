#include "framework/plugin/kim/kim_citation.hpp"

#include <cctype>
#include <cstddef>
#include <map>
#include <vector>

namespace tomlin::kim {
namespace {

/// Text of a string of TeX, without braces.
std::string plain(const std::string& text) {
  std::string kept;
  for (const char c : text) {
    if (c == '{' || c == '}' || (c == '-' && !kept.empty() && kept.back() == '-')) continue;
    kept += c;
  }
  return kept;
}

/// A word or a string in quotes from `at` on, which is left behind it.
std::string next_token(std::string_view text, std::size_t& at) {
  std::string token;
  if (text[at] != '"') {
    constexpr std::string_view kEnds = " \t\r\n,{}[]\"";
    while (at < text.size() && kEnds.find(text[at]) == std::string_view::npos) token += text[at++];
    return token;
  }
  for (++at; at < text.size() && text[at] != '"'; ++at) {
    if (text[at] == '\\' && at + 1 < text.size()) ++at;
    token += text[at];
  }
  ++at;
  return token;
}

std::string in_words(std::map<std::string, std::string>& work) {
  std::string all = plain(work["author"]);
  const auto add = [&](const std::string& before, const std::string& what,
                       const std::string& after = "") {
    if (!what.empty()) all += before + plain(what) + after;
  };
  add(", ", work["journal"]);
  add(" ", work["volume"]);
  add(", ", work["pages"]);
  add(" (", work["year"], ")");
  add(", doi:", work["doi"]);
  return all;
}

}  // namespace

std::string citation_of(std::string_view kimspec) {
  constexpr std::string_view kKey = "\"source-citations\"";
  const std::size_t found = kimspec.find(kKey);
  if (found == std::string_view::npos) return {};
  std::string first;
  std::vector<std::string> tokens;  // of one citation: keys and values in turn
  for (std::size_t at = found + kKey.size(); at < kimspec.size();) {
    const char c = kimspec[at];
    if (c == ']') break;
    if (c == '}') {
      std::map<std::string, std::string> work;
      for (std::size_t k = 0; k + 1 < tokens.size(); k += 2) work[tokens[k]] = tokens[k + 1];
      const bool primary = work.count("recordprimary") > 0;
      std::string words = in_words(work);
      if (primary) return words;
      if (first.empty()) first = std::move(words);
      tokens.clear();
      ++at;
    } else if (c == '{' || c == '[' || c == ',' || std::isspace(static_cast<unsigned char>(c))) {
      ++at;
    } else {
      tokens.push_back(next_token(kimspec, at));
    }
  }
  return first;
}

}  // namespace tomlin::kim
