#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "framework/plot/quantities.hpp"
#include "framework/plot/sample_table.hpp"

namespace tomlin {

/// The numbers of several series of a table, which is read once.
class SeriesReader {
 public:
  void add(const Series& series);
  /// After all have been added. Throws InputError.
  void read(const SampleTable& table);
  /// One for each sample, of a series that has been added.
  std::vector<double> values(const Series& series) const;

 private:
  std::vector<std::size_t> columns_;  ///< each once
  std::vector<std::vector<double>> numbers_;
};

/// A column that must be there. Throws InputError.
Series column_series(const SampleTable& table, const std::string& name);

}  // namespace tomlin
