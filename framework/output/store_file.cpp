#include "framework/output/store_file.hpp"

#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "framework/output/checkpoint.hpp"
#include "framework/output/output_file.hpp"
#include "framework/output/record.hpp"

namespace tomlin {

StoreFile::StoreFile(const RunFolder& folder, const Scene& scene,
                     const std::string& program_version, Before before)
    : folder_(&folder),
      file_(folder.file(kStoreFile)),
      owner_(fmt::format("{} {:x}", program_version, scene_fingerprint(scene.effective_toml))) {
  for (const Library& library : scene.libraries) owner_ += " " + library.hash;
  if (before == Before::read) read();
}

StoreFile::StoreFile(std::filesystem::path file, std::string owner, double every)
    : file_(std::move(file)), owner_(std::move(owner)), every_(every) {
  read();
}

void StoreFile::read() try {
  std::error_code error;
  if (!std::filesystem::exists(std::filesystem::symlink_status(file_, error))) return;
  const std::string file = file_.string();
  const std::vector<std::byte> bytes = read_record_file(file);
  RecordReader record = only_record(file, bytes, RecordKind::store);
  if (record.text() != owner_) return;
  while (record.left() > 0) {
    std::string name = record.text();
    const auto content = record.bytes();
    all_[std::move(name)].assign(content.begin(), content.end());
  }
} catch (const DamagedFile&) {
  all_.clear();
}

std::vector<std::byte> StoreFile::kept(const std::string& name) const {
  const auto found = all_.find(name);
  return found == all_.end() ? std::vector<std::byte>() : found->second;
}

void StoreFile::keep(const std::string& name, std::vector<std::byte> bytes) {
  all_[name] = std::move(bytes);
  is_written_ = false;
  const std::chrono::duration<double> since = std::chrono::steady_clock::now() - last_written_;
  if (since.count() >= every_) write();
}

void StoreFile::write() {
  if (is_written_ || file_.empty()) return;
  if (folder_ != nullptr && !folder_->in_place()) return;
  RecordWriter record(RecordKind::store);
  record.text(owner_);
  for (const auto& [kept, content] : all_) {
    record.text(kept);
    record.bytes(content);
  }
  if (folder_ == nullptr) {
    std::error_code error;
    std::filesystem::create_directories(file_.parent_path(), error);
  }
  try {
    write_record_file(file_, record, OutputFile::Lasting::some_time_later);
    is_written_ = true;
  } catch (const OutputError&) {
    // The next one may get through.
  }
  last_written_ = std::chrono::steady_clock::now();
}

void StoreFile::remove() const {
  if (file_.empty()) return;
  std::error_code error;
  std::filesystem::remove(file_, error);
  std::filesystem::remove(unfinished(file_), error);
}

}  // namespace tomlin
