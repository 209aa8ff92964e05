#pragma once

#include <stdexcept>
#include <string>

namespace tomlin::test {

/// The text with its first `old_text` replaced; a test that changes nothing is no test.
inline std::string replaced(std::string text, const std::string& old_text,
                            const std::string& new_text) {
  const auto at = text.find(old_text);
  if (at == std::string::npos) throw std::invalid_argument("the text has no " + old_text);
  return text.replace(at, old_text.size(), new_text);
}

}  // namespace tomlin::test
