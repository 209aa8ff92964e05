#pragma once

#include <string>
#include <vector>

#include "framework/cli/described.hpp"
#include "framework/core/records/registry.hpp"

/// The reference in Markdown, made of what components and the scene language say of themselves.
namespace tomlin {

struct ReferencePage {
  std::string file;  ///< below the folder that the pages are written to
  std::string text;
};

/// One page for each kind of component, one for the tables of a scene, one for results, one for
/// diagnostics.
std::vector<ReferencePage> reference_pages(const Registry& registry);

/// One component: a section of its page.
std::string component_section(const Described& component);

/// All quantities that a run may report.
std::string results_section();

/// One table of a scene that is no component, likewise.
std::string table_section(const SceneTable& table);

}  // namespace tomlin
