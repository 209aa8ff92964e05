#include "framework/output/checkpoint.hpp"

#include <algorithm>

#include "framework/output/checksum.hpp"

namespace tomlin {
namespace {

constexpr std::uint32_t kCheckpointFormat = 1;

}  // namespace

std::string without_plugin_paths(std::string_view effective_toml) {
  // The effective scene has them on its first line, before all tables.
  constexpr std::string_view kPlugins = "plugins = [";
  if (!effective_toml.starts_with(kPlugins)) return std::string(effective_toml);
  const std::size_t end = std::min(effective_toml.find('\n'), effective_toml.size());
  return std::string(kPlugins) + "...]" + std::string(effective_toml.substr(end));
}

std::uint64_t scene_fingerprint(std::string_view effective_toml) {
  const std::string compared = without_plugin_paths(effective_toml);
  return checksum_of(std::as_bytes(std::span(compared)), 0);
}

void write_checkpoint(const std::filesystem::path& file, const Checkpoint& checkpoint,
                      OutputFile::Lasting lasting) {
  RecordWriter record(RecordKind::checkpoint);
  record.number(kCheckpointFormat);
  record.text(checkpoint.program_version);
  record.number(checkpoint.scene);
  record.number(checkpoint.journal.bytes);
  record.number(checkpoint.journal.checksum);
  record.number(checkpoint.journal.rows);
  record.number(checkpoint.journal.events);
  record.bytes(checkpoint.state);
  for (const Checkpoint::Plugin& plugin : checkpoint.plugins) {
    record.text(plugin.path);
    record.text(plugin.hash);
  }
  write_record_file(file, record, lasting);
  if (lasting == OutputFile::Lasting::with_its_name) synchronise_folder_of(file);
}

Checkpoint read_checkpoint(const std::filesystem::path& file) {
  return parse_checkpoint(file.string(), read_record_file(file));
}

Checkpoint parse_checkpoint(const std::string& file, std::span<const std::byte> bytes) {
  RecordReader record = only_record(file, bytes, RecordKind::checkpoint);
  record.require_format(kCheckpointFormat);
  Checkpoint checkpoint;
  checkpoint.program_version = record.text();
  checkpoint.scene = record.number<std::uint64_t>();
  checkpoint.journal.bytes = record.number<std::uint64_t>();
  checkpoint.journal.checksum = record.number<std::uint64_t>();
  checkpoint.journal.rows = record.number<std::uint64_t>();
  checkpoint.journal.events = record.number<std::uint64_t>();
  const auto state = record.bytes();
  checkpoint.state.assign(state.begin(), state.end());
  while (record.left() > 0) {
    Checkpoint::Plugin plugin;
    plugin.path = record.text();
    plugin.hash = record.text();
    checkpoint.plugins.push_back(std::move(plugin));
  }
  return checkpoint;
}

}  // namespace tomlin
