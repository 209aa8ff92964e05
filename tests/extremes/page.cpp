#include "tests/extremes/page.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tests/extremes/scenes.hpp"

namespace tomlin::test {
namespace {

/// To the digits that the tolerance leaves standing: rounding in the last place does not show.
std::string shown(double value, double tolerance) {
  constexpr int kMostDigits = 15;
  const double size = std::abs(value);
  if (size <= tolerance) return "0";
  if (tolerance == 0.0) return fmt::format("{}", value);
  const int digits = static_cast<int>(std::floor(std::log10(size / tolerance)));
  return fmt::format("{:.{}g}", value, std::clamp(digits, 1, kMostDigits));
}

/// In one cell of a table.
std::string cell(std::string text) {
  std::string safe;
  for (const char c : text) {
    if (c == '|') safe += '\\';
    safe += c == '\n' ? ' ' : c;
  }
  while (!safe.empty() && safe.back() == ' ') safe.pop_back();
  return safe;
}

/// Returns the first of all faults, without its position in the file.
std::string first_fault(const std::string& message) {
  const std::string line = message.substr(0, message.find('\n'));
  const std::size_t error = line.find("error: ");
  return error == std::string::npos ? line : line.substr(error + std::string("error: ").size());
}

std::string settings_of(const ExtremeCase& extreme) {
  std::string text = extreme.scene;
  for (const Setting& setting : extreme.settings) {
    text += fmt::format(" `{}={}`", setting.path, setting.value);
  }
  return text;
}

std::string values_of(const ExtremeCase& extreme, const Observed* observed) {
  std::string text;
  for (std::size_t k = 0; k < extreme.values.size(); ++k) {
    const Value& value = extreme.values[k];
    if (k > 0) text += "; ";
    text += value.path;
    if (observed != nullptr) text += " = " + shown(observed->values.at(k), value.tolerance);
    text +=
        value.tolerance == 0.0 ? ", to the last bit" : fmt::format(", to {:.1g}", value.tolerance);
    text += " (" + value.reason + ")";
  }
  return text;
}

std::string comes_of(const ExtremeCase& extreme, const Observed* observed) {
  if (extreme.outcome != Outcome::finished) {
    const char* how = extreme.outcome == Outcome::refused ? "refused: " : "fails: ";
    return how + (observed == nullptr ? "" : first_fault(observed->message));
  }
  std::string text = values_of(extreme, observed);
  if (!extreme.warnings.empty() && observed != nullptr) {
    text += fmt::format(". Warns: {}", fmt::join(texts_of(observed->warnings), " "));
  }
  if (extreme.slow) text += " (slow)";
  return text;
}

}  // namespace

std::string page_preface() {
  std::string text =
      "# The extremes\n\n"
      "What becomes of scenes far from the usual. Each row is run by `ctest -L extremes`, the way "
      "`tomlin run` does it; rows marked slow by `ctest -L slow`. A run either finishes with the "
      "right number, or is refused or fails with a cause. Its files never contain NaN or "
      "infinity; a row that says nothing of warnings has none; and none takes longer than "
      "its guard of seconds.\n\n"
      "This page is written by the tests, `extremes_tests --write-page tests/EXTREMES.md`, and "
      "they "
      "fail when it is not theirs. Numbers show the digits that the tolerance leaves standing.\n\n"
      "The scenes, each with the settings of a row:\n";
  for (const NamedScene& scene : base_scenes()) {
    text += fmt::format("\n**{}**: {}\n\n```toml\n{}```\n", scene.name, scene.summary, scene.text);
  }
  return text;
}

std::string page_section(const Subject& subject, const std::vector<const Observed*>& observed) {
  std::string text = fmt::format("\n## {}\n\n", subject.title);
  text += "| what is extreme | scene, settings | what comes of it |\n|---|---|---|\n";
  for (std::size_t k = 0; k < subject.cases.size(); ++k) {
    const ExtremeCase& extreme = subject.cases[k];
    text += fmt::format("| {} | {} | {} |\n", cell(extreme.extreme), cell(settings_of(extreme)),
                        cell(comes_of(extreme, observed.at(k))));
  }
  return text;
}

}  // namespace tomlin::test
