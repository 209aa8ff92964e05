#include "framework/cli/sections.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>

#include <fmt/format.h>

namespace tomlin {

void Sections::section(std::string title) { sections_.push_back({std::move(title), {}}); }

void Sections::row(std::string label, std::string content) {
  sections_.back().rows.emplace_back(std::move(label), std::move(content));
}

std::string Sections::text() const {
  std::size_t width = 0;
  for (const Section& section : sections_) {
    for (const auto& [label, content] : section.rows) width = std::max(width, label.size());
  }
  std::string text;
  for (const Section& section : sections_) {
    if (section.rows.empty()) continue;
    if (!text.empty()) text += "\n";
    text += section.title + "\n";
    for (const auto& [label, content] : section.rows) {
      fmt::format_to(std::back_inserter(text), "  {:<{}}  {}\n", label, width, content);
    }
  }
  return text;
}

}  // namespace tomlin
