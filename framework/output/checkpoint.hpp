#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "framework/output/journal.hpp"
#include "framework/output/output_file.hpp"
#include "framework/output/record.hpp"

/// The checkpoint: all that a run needs to go on from one moment, in one checked record.
namespace tomlin {

struct Checkpoint {
  std::string program_version;
  std::uint64_t scene = 0;       ///< fingerprint of the effective scene
  JournalMark journal;           ///< where the journal stood at this moment
  std::vector<std::byte> state;  ///< RunState::to_bytes(): the same for every instruction set
  struct Plugin {
    std::string path;
    std::string hash;  ///< of its content, see Library
  };
  std::vector<Plugin> plugins;  ///< whose components the scene is made of
};

/// An effective scene without the paths of its plugins: where they lie is no part of what is run,
/// and their content is compared by its hash. As many lines as before.
std::string without_plugin_paths(std::string_view effective_toml);

/// "0.1.0" of "0.1.0+0123456789abcdef": what results say. Checkpoints and journals have all of it.
inline std::string release_of(const std::string& program_version) {
  return program_version.substr(0, program_version.find('+'));
}

/// Fingerprint of a scene's text in a checkpoint; the folder of its plugins does not matter.
std::uint64_t scene_fingerprint(std::string_view effective_toml);

/// Replaces the checkpoint of this name, whole or not at all. Throws OutputError.
void write_checkpoint(const std::filesystem::path& file, const Checkpoint& checkpoint,
                      OutputFile::Lasting lasting = OutputFile::Lasting::with_its_name);

/// Throws DamagedFile with the reason; takes no more memory than the file does.
Checkpoint read_checkpoint(const std::filesystem::path& file);

/// Reads the contents of a checkpoint file; `file` is for messages.
Checkpoint parse_checkpoint(const std::string& file, std::span<const std::byte> bytes);

}  // namespace tomlin
