#include "framework/core/text/fault.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/utf8.hpp"

namespace tomlin {
namespace {

std::string joined(const std::vector<Fault>& faults) {
  std::string text;
  for (const Fault& fault : faults) {
    if (!text.empty()) text += '\n';
    text += to_string(fault);
  }
  return text;
}

/// Words that are longer than any name or path, as of a file that was given for a name, are cut.
std::string with_short_words(std::string text) {
  constexpr std::size_t kLongestBytes = 1000;
  constexpr std::size_t kShownBytes = 60;
  for (std::size_t begin = 0; begin < text.size();) {
    std::size_t end = std::min(text.find(' ', begin), text.size());
    if (end - begin > kLongestBytes) {
      std::size_t cut = begin + kShownBytes;
      while (is_utf8_continuation(text[cut])) --cut;
      text.replace(cut, end - cut, "...");
      end = cut + 3;
    }
    begin = end + 1;
  }
  return text;
}

/// The line of a fault without a key, with a caret below the column; empty where it has none.
std::string marked_line(const Fault& fault) {
  if (!fault.key.empty() || fault.value.empty() || fault.location.column < 1) return "";
  std::string blanks;
  int column = 1;
  for (const char c : fault.value) {
    if (is_utf8_continuation(c)) continue;
    if (column++ == fault.location.column) break;
    blanks += c == '\t' ? '\t' : ' ';
  }
  return fmt::format("\n  {}\n  {}^", fault.value, blanks);
}

}  // namespace

std::string to_string(const Fault& fault) {
  std::string text = with_short_words(fault.location.file);
  if (fault.location.line > 0) {
    text += ':' + std::to_string(fault.location.line) + ':' + std::to_string(fault.location.column);
  }
  text += ": error: ";
  if (!fault.key.empty()) {
    text += fault.key;
    if (!fault.value.empty()) text += " = " + fault.value;
    text += ": ";
  }
  text += fault.why;
  if (!fault.admissible.empty()) text += "; expected: " + fault.admissible;
  if (!fault.nearest.empty()) text += "; did you mean \"" + fault.nearest + "\"?";
  text += fmt::format(" [{}]", id_of(fault.code));
  return with_short_words(std::move(text)) + marked_line(fault);
}

InputError::InputError(std::vector<Fault> faults)
    : std::runtime_error(joined(faults)), faults_(std::move(faults)) {}

void refuse_input(FaultCode code, std::string file, std::string key, std::string why,
                  std::string admissible, std::string nearest) {
  throw InputError({Fault(code, {.file = std::move(file)}, std::move(key), "", std::move(why),
                          std::move(admissible), std::move(nearest))});
}

}  // namespace tomlin
