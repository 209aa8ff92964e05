#include "framework/cli/printable.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <system_error>

#include <fmt/format.h>

#include "framework/cli/exit_status.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/core/text/utf8.hpp"

namespace tomlin {
namespace {

/// Ranges of characters that act instead of being shown (Unicode 15, categories Cc and Zl to Cf):
/// controls, and marks that change the direction or the end of a line.
struct Range {
  std::uint32_t first;
  std::uint32_t last;
};
constexpr Range kActing[] = {{0x00, 0x08},     {0x0B, 0x1F},     {0x7F, 0x9F},    {0x61C, 0x61C},
                             {0x200E, 0x200F}, {0x2028, 0x202E}, {0x2066, 0x2069}};

bool acts(std::uint32_t character) {
  return std::any_of(std::begin(kActing), std::end(kActing), [=](const Range& range) {
    return range.first <= character && character <= range.last;
  });
}

/// Returns the character that starts a text in UTF-8, and in `length` how many bytes it has.
std::uint32_t first_character(std::string_view text, std::size_t& length) {
  const auto byte = [text](std::size_t i) -> std::uint32_t {
    return static_cast<unsigned char>(text[i]);
  };
  const std::uint32_t first = byte(0);
  length = first < 0x80U ? 1 : first >= 0xF0U ? 4 : first >= 0xE0U ? 3 : 2;
  if (length == 1) return first;
  std::uint32_t character = first & (0xFFU >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) character = (character << 6U) | (byte(i) & 0x3FU);
  return character;
}

}  // namespace

std::string printable(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    std::string_view valid = text.substr(0, valid_utf8_prefix(text));
    text.remove_prefix(valid.size());
    while (!valid.empty()) {
      std::size_t length = 0;
      const std::uint32_t character = first_character(valid, length);
      if (acts(character)) {
        result += fmt::format("\\u{:04X}", character);
      } else {
        result += valid.substr(0, length);
      }
      valid.remove_prefix(length);
    }
    if (text.empty()) break;
    result += '?';
    text.remove_prefix(1);
  }
  return result;
}

void print_error_line(std::string_view text) {
  std::fputs((printable(text) + "\n").c_str(), stderr);
}

int print_result(const std::string& given) {
  const std::string text = printable(given);
  const bool printed =
      std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  // A reader that went away, as `head` does, has seen what it wanted.
  if (printed || errno == EPIPE) return kExitDone;
  const std::string reason = std::generic_category().message(errno);
  print_error_line(to_string(Fault(FaultCode::file_cannot_write, {"tomlin"}, "", "",
                                   "cannot write to standard output: " + reason)));
  return kExitFailed;
}

}  // namespace tomlin
