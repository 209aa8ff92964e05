#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "framework/output/store_file.hpp"
#include "framework/run/run.hpp"

namespace tomlin {

/// Stores what the run of one point resumes from: its checkpoints, and what it keeps of the choice
/// of its integrator and of runs beside it. Nothing is written before the run has lasted as long as
/// checkpoints are apart or is stopped, so that short points leave no file.
class PointCheckpoint : public RunSink, public RunStore {
 public:
  /// Only the owner that wrote the file can read its contents. `every` is in seconds.
  PointCheckpoint(std::filesystem::path file, std::string owner, double every);

  /// The state that an earlier process has reached; empty if there is none.
  const std::vector<std::byte>& state() const { return state_; }
  /// For a run that was stopped.
  void write();

  static std::filesystem::path file_of(const std::filesystem::path& folder, std::size_t point);
  /// Removes the file of a point that has a row, and what a kill has left unfinished of it.
  static void remove(const std::filesystem::path& file);

  void begin(const RunLayout& layout) override { (void)layout; }
  void sample(const std::vector<double>& row) override { (void)row; }
  void checkpoint(const RunState& state) override;
  bool wants_samples() const override { return false; }

  std::vector<std::byte> kept(const std::string& name) const override;
  void keep(const std::string& name, std::vector<std::byte> bytes) override;

 private:
  std::filesystem::path file_;
  double every_;
  StoreFile store_;
  std::vector<std::byte> state_;
  std::map<std::string, std::vector<std::byte>> unwritten_;
  std::chrono::steady_clock::time_point last_written_ = std::chrono::steady_clock::now();
};

}  // namespace tomlin
