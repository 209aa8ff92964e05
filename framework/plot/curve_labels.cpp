#include "framework/plot/curve_labels.hpp"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

namespace tomlin {
namespace {

/// Do the runs that have this parameter give it different values of its own?
bool differs(const std::vector<StoredRun>& runs, const std::string& parameter) {
  const StoredRun* first = nullptr;
  bool other_value = false;
  bool other_text = false;
  for (const StoredRun& run : runs) {
    const double* value = parameter_of(run, parameter);
    if (value == nullptr) continue;
    if (first == nullptr) first = &run;
    other_value = other_value || *value != *parameter_of(*first, parameter);
    const auto text = run.written.find(parameter);
    const auto first_text = first->written.find(parameter);
    other_text = other_text || text == run.written.end() || first_text == first->written.end() ||
                 text->second != first_text->second;
  }
  return other_value && other_text;
}

/// Gives every label that is empty or not the only one of its kind another text.
template <class Text>
void replace_ambiguous(std::vector<std::string>& labels, const std::vector<StoredRun>& runs,
                       Text text) {
  const std::vector<std::string> before = labels;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const bool unique = std::count(before.begin(), before.end(), before[i]) == 1;
    if (!unique || before[i].empty()) labels[i] = text(runs[i]);
  }
}

}  // namespace

const double* parameter_of(const StoredRun& run, const std::string& parameter) {
  for (const auto& [name, value] : run.parameters) {
    if (name == parameter) return &value;
  }
  return nullptr;
}

std::vector<std::string> differing_parameters(const std::vector<StoredRun>& runs) {
  std::vector<std::string> names;
  for (const StoredRun& run : runs) {
    for (const auto& [name, value] : run.parameters) {
      const bool known = std::find(names.begin(), names.end(), name) != names.end();
      if (!known && differs(runs, name)) names.push_back(name);
    }
  }
  return names;
}

std::string label_of(const StoredRun& run, const std::vector<std::string>& parameters) {
  std::vector<std::string> parts;
  for (const std::string& name : parameters) {
    if (const double* value = parameter_of(run, name)) {
      parts.push_back(fmt::format("{} = {:.6g}", name, *value));
    }
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::vector<StoredRun> in_order_of_parameters(std::vector<StoredRun> runs) {
  const std::vector<std::string> names = differing_parameters(runs);
  const auto before = [&names](const StoredRun& a, const StoredRun& b) {
    for (const std::string& name : names) {
      const double* one = parameter_of(a, name);
      const double* other = parameter_of(b, name);
      // A run without the parameter comes first.
      if (one == nullptr || other == nullptr) {
        if (one != other) return one == nullptr;
      } else if (*one != *other) {
        return *one < *other;
      }
    }
    return false;
  };
  std::stable_sort(runs.begin(), runs.end(), before);
  return runs;
}

std::vector<std::string> curve_labels(const std::vector<StoredRun>& runs) {
  std::vector<std::string> labels(runs.size());
  if (runs.size() < 2) return labels;
  const std::vector<std::string> names = differing_parameters(runs);
  for (std::size_t i = 0; i < runs.size(); ++i) labels[i] = label_of(runs[i], names);
  replace_ambiguous(labels, runs, [](const StoredRun& run) { return run.name; });
  replace_ambiguous(labels, runs, [](const StoredRun& run) { return run.folder; });
  return labels;
}

}  // namespace tomlin
