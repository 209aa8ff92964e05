#pragma once

#include <string>

#include "framework/scene/scene.hpp"
#include "framework/study/tradeoff/tradeoff.hpp"

/// The result of a tradeoff for people and for programs.
namespace tomlin {

/// The text to print: the reference, a table, what was left out, the recommendation.
std::string tradeoff_text(const Scene& scene, const Tradeoff& tradeoff, const std::string& where);

/// One row per point, 17 digits.
std::string tradeoff_csv(const Tradeoff& tradeoff);

std::string tradeoff_json(const Scene& scene, const Tradeoff& tradeoff);

}  // namespace tomlin
