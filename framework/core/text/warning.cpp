#include "framework/core/text/warning.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

namespace tomlin {

std::string to_string(const Warning& warning) {
  return fmt::format("{} [{}]", warning.text, id_of(warning.code));
}

std::vector<std::string> texts_of(const std::vector<Warning>& warnings) {
  std::vector<std::string> texts;
  std::transform(warnings.begin(), warnings.end(), std::back_inserter(texts),
                 [](const Warning& warning) { return warning.text; });
  return texts;
}

std::vector<std::string_view> codes_of(const std::vector<Warning>& warnings) {
  std::vector<std::string_view> codes;
  std::transform(warnings.begin(), warnings.end(), std::back_inserter(codes),
                 [](const Warning& warning) { return id_of(warning.code); });
  return codes;
}

}  // namespace tomlin
