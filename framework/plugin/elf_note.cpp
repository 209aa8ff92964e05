#include "framework/plugin/elf_note.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>
#include <type_traits>

#include <elf.h>

#include "framework/plugin/entry.hpp"

namespace tomlin {
namespace {

constexpr std::size_t kLongestNote = 4096;
constexpr unsigned char kByteOrder =
    std::endian::native == std::endian::little ? ELFDATA2LSB : ELFDATA2MSB;
#if defined(__x86_64__)
constexpr int kMachine = EM_X86_64;
#elif defined(__aarch64__)
constexpr int kMachine = EM_AARCH64;
#elif defined(__riscv)
constexpr int kMachine = EM_RISCV;
#elif defined(__powerpc64__)
constexpr int kMachine = EM_PPC64;
#else
constexpr int kMachine = EM_NONE;  // not compared
#endif

/// Part of a file; nothing when it is not all there.
std::optional<std::span<const std::byte>> part(std::span<const std::byte> file, std::uint64_t begin,
                                               std::uint64_t size) {
  if (begin > file.size() || size > file.size() - begin) return std::nullopt;
  return file.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(size));
}

template <class Struct>
std::optional<Struct> read(std::span<const std::byte> file, std::uint64_t at) {
  static_assert(std::is_trivially_copyable_v<Struct>);
  const auto bytes = part(file, at, sizeof(Struct));
  if (!bytes) return std::nullopt;
  Struct result;
  std::memcpy(&result, bytes->data(), sizeof result);
  return result;
}

std::uint64_t rounded_up(std::uint64_t size, std::uint64_t alignment) {
  return (size + alignment - 1) / alignment * alignment;
}

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};  // NOLINT: as text
}

bool is_text(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

/// tomlin's note in a segment of notes; nothing when it is not among them.
std::optional<ElfNote> note_in(std::span<const std::byte> segment, std::uint64_t alignment) {
  std::uint64_t at = 0;
  while (const auto head = read<Elf64_Nhdr>(segment, at)) {
    const std::uint64_t name_at = at + sizeof(Elf64_Nhdr);
    const std::uint64_t text_at = name_at + rounded_up(head->n_namesz, alignment);
    const auto name = part(segment, name_at, head->n_namesz);
    const auto text = part(segment, text_at, head->n_descsz);
    if (!name || !text) return ElfNote{"", "the notes in it are cut off"};
    const std::string_view owner(kNoteOwner);
    const bool ours = name->size() == owner.size() + 1 && text_of(*name).starts_with(owner) &&
                      text_of(*name).back() == '\0' && head->n_type == kNoteType;
    if (ours) {
      if (text->empty() || text->size() > kLongestNote || !is_text(text_of(*text))) {
        return ElfNote{"", "tomlin's note in it is damaged"};
      }
      return ElfNote{std::string(text_of(*text)), ""};
    }
    at = text_at + rounded_up(head->n_descsz, alignment);
  }
  return std::nullopt;
}

}  // namespace

ElfNote read_elf_note(std::span<const std::byte> file) {
  const auto head = read<Elf64_Ehdr>(file, 0);
  if (!head || std::memcmp(head->e_ident, ELFMAG, SELFMAG) != 0) {
    return {"", "not a shared library"};
  }
  if (head->e_ident[EI_CLASS] != ELFCLASS64 || head->e_ident[EI_DATA] != kByteOrder ||
      (kMachine != EM_NONE && head->e_machine != kMachine)) {
    return {"", "a library for another kind of machine"};
  }
  if (head->e_type != ET_DYN) return {"", "not a shared library"};
  if (head->e_phentsize != sizeof(Elf64_Phdr)) return {"", "its table of segments is damaged"};
  for (std::uint64_t k = 0; k < head->e_phnum; ++k) {
    if (head->e_phoff > file.size()) return {"", "its table of segments is cut off"};
    const auto segment = read<Elf64_Phdr>(file, head->e_phoff + k * sizeof(Elf64_Phdr));
    if (!segment) return {"", "its table of segments is cut off"};
    if (segment->p_type != PT_NOTE) continue;
    const auto notes = part(file, segment->p_offset, segment->p_filesz);
    if (!notes) return {"", "the notes in it are cut off"};
    if (auto note = note_in(*notes, segment->p_align == 8 ? 8 : 4)) return *note;
  }
  return {"", "not a plugin of tomlin: it has no note that says so (see tomlin_add_plugin)"};
}

}  // namespace tomlin
