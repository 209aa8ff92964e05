#include "framework/study/sweep/point_checkpoint.hpp"

#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "framework/output/output_file.hpp"

namespace tomlin {
namespace {

/// Name under which the run itself is kept; other runs have other names.
constexpr const char* kRunOfPoint = "run";

}  // namespace

PointCheckpoint::PointCheckpoint(std::filesystem::path file, std::string owner, double every)
    : file_(std::move(file)),
      every_(every),
      store_(file_, std::move(owner), StoreFile::Before::read),
      state_(store_.kept(kRunOfPoint)) {}

void PointCheckpoint::checkpoint(const RunState& state) { keep(kRunOfPoint, state.to_bytes()); }

std::vector<std::byte> PointCheckpoint::kept(const std::string& name) const {
  const auto found = unwritten_.find(name);
  return found == unwritten_.end() ? store_.kept(name) : found->second;
}

void PointCheckpoint::keep(const std::string& name, std::vector<std::byte> bytes) {
  unwritten_[name] = std::move(bytes);
  const std::chrono::duration<double> since = std::chrono::steady_clock::now() - last_written_;
  if (since.count() >= every_) write();
}

void PointCheckpoint::write() {
  if (unwritten_.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(file_.parent_path(), error);
  for (auto& [name, bytes] : unwritten_) store_.keep(name, std::move(bytes));
  unwritten_.clear();
  last_written_ = std::chrono::steady_clock::now();
}

std::filesystem::path PointCheckpoint::file_of(const std::filesystem::path& folder,
                                               std::size_t point) {
  return folder / fmt::format("{}.store", point);
}

void PointCheckpoint::remove(const std::filesystem::path& file) {
  std::error_code error;
  std::filesystem::remove(file, error);
  std::filesystem::remove(unfinished(file), error);
}

}  // namespace tomlin
