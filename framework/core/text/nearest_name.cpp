#include "framework/core/text/nearest_name.hpp"

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <utility>

#include "framework/core/text/ascii.hpp"

namespace tomlin {
namespace {

// Longer names are no names that anybody mistyped; keeps the quadratic search cheap.
constexpr std::size_t kLongestName = 128;
constexpr std::size_t kShortestAbbreviation = 3;
constexpr std::size_t kMostEdits = 4;

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = in_lower_case(c);
  return result;
}

// Optimal string alignment: no part is edited twice.
std::size_t edits_between(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before_last(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::swap(before_last, last);
    std::swap(last, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      }
    }
  }
  return row[b.size()];
}

// One edit turns any one-letter name into any other, so short names allow few edits.
bool is_close(const std::string& a, const std::string& b, std::size_t edits) {
  const std::size_t longer = std::max(a.size(), b.size());
  if (edits == 0) return true;
  if (longer == 1) return false;
  if (longer == 2) return edits == 1 && a.size() == 2 && b.size() == 2 && a[0] == b[1];
  return edits <= std::clamp<std::size_t>(longer / 3, 1, kMostEdits);
}

/// "bodies" of "body", "boxes" of "box".
bool is_plural(const std::string& many, const std::string& one) {
  if (one.size() < kShortestAbbreviation) return false;
  const bool y = one.back() == 'y' && many == one.substr(0, one.size() - 1) + "ies";
  return y || many == one + "s" || many == one + "es";
}

/// Whether the word is one of those that make up the name, as "mass" of "particle_mass".
bool is_word_of(const std::string& word, const std::string& name) {
  for (std::size_t at = name.find(word); at != std::string::npos; at = name.find(word, at + 1)) {
    const bool begins = at == 0 || name[at - 1] == '_';
    const std::size_t end = at + word.size();
    if (begins && (end == name.size() || name[end] == '_')) return true;
  }
  return false;
}

/// The only name that the word is a part of.
std::optional<std::string> only_name_with(const std::string& word,
                                          const std::vector<std::string>& valid_names) {
  const std::string* found = nullptr;
  for (const std::string& valid : valid_names) {
    if (valid.size() > kLongestName || !is_word_of(word, lower(valid))) continue;
    if (found != nullptr) return std::nullopt;
    found = &valid;
  }
  if (found == nullptr) return std::nullopt;
  return *found;
}

}  // namespace

std::optional<std::string> nearest_name(std::string_view name,
                                        const std::vector<std::string>& valid_names) {
  if (name.empty() || name.size() > kLongestName) return std::nullopt;
  const std::string wanted = lower(name);

  // Smaller is better: close names before abbreviations, then fewer edits, then the same case.
  using Score = std::tuple<bool, std::size_t, std::size_t>;
  std::optional<Score> best;
  const std::string* nearest = nullptr;
  for (const std::string& valid : valid_names) {
    if (valid.empty() || valid.size() > kLongestName) continue;
    const std::string candidate = lower(valid);
    const std::size_t edits = edits_between(wanted, candidate);
    const bool close = is_close(wanted, candidate, edits) || is_plural(wanted, candidate);
    const bool abbreviation =
        wanted.size() >= kShortestAbbreviation && candidate.starts_with(wanted);
    if (!close && !abbreviation) continue;
    std::size_t other_case = 0;
    for (std::size_t i = 0; i < std::min(name.size(), valid.size()); ++i) {
      if (name[i] != valid[i]) ++other_case;
    }
    const Score score{!close, edits, other_case};
    if (!best || score < *best) {
      best = score;
      nearest = &valid;
    }
  }
  if (nearest != nullptr) return *nearest;
  if (wanted.size() < kShortestAbbreviation) return std::nullopt;
  return only_name_with(wanted, valid_names);
}

}  // namespace tomlin
