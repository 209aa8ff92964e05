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
    dimension_ = static_cast<std::size_t>(layout.dimension);
  }
  void sample(const std::vector<double>& row) override {
    for (std::size_t k = 0; k < columns_.size(); ++k) columns_[k].push_back(row[k]);
    positions_.emplace_back(row.begin() + static_cast<std::ptrdiff_t>(columns_.size()), row.end());
  }

  const std::vector<double>& operator[](const std::string& name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found == names_.end()) throw std::logic_error("there is no column " + name);
    return columns_[static_cast<std::size_t>(found - names_.begin())];
  }

  /// Position of a particle in a sample, with `[output] trajectory`.
  double position(std::size_t sample, std::size_t particle, std::size_t axis) const {
    return positions_.at(sample).at(particle * dimension_ + axis);
  }

 private:
  std::vector<std::string> names_;
  std::vector<std::vector<double>> columns_;
  std::vector<std::vector<double>> positions_;  ///< [sample][particle, axis]
  std::size_t dimension_ = 0;
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
