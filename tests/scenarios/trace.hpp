#pragma once

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "framework/run/run.hpp"

namespace tomlin::test {

/// The samples of a run, in memory.
class Trace : public RunSink {
 public:
  void begin(const RunLayout& layout) override {
    for (const SampleColumn& column : layout.columns) names_.push_back(column.name);
    columns_.resize(layout.columns.size());
  }
  void sample(const std::vector<double>& values) override {
    for (std::size_t k = 0; k < values.size(); ++k) columns_[k].push_back(values[k]);
  }

  const std::vector<double>& operator[](const std::string& name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found == names_.end()) throw std::logic_error("there is no column " + name);
    return columns_[static_cast<std::size_t>(found - names_.begin())];
  }

 private:
  std::vector<std::string> names_;
  std::vector<std::vector<double>> columns_;
};

/// How far each slip went: advances of more than half a period while the driver moves a little.
inline std::vector<double> slips(const std::vector<double>& position, double period) {
  std::vector<double> lengths;
  for (std::size_t n = 1; n < position.size(); ++n) {
    const double advance = position[n] - position[n - 1];
    if (advance > 0.5 * period) lengths.push_back(advance / period);
  }
  return lengths;
}

}  // namespace tomlin::test
