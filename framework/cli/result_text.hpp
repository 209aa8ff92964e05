#pragma once

#include <string>

#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"

namespace tomlin {

/// The result of a run for people, in about ten lines; `where` says where all of it is.
std::string result_text(const Scene& scene, const RunResult& result, const std::string& where);

}  // namespace tomlin
