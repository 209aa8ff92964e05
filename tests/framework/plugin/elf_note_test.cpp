#include "framework/plugin/elf_note.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>
#include <random>

#include <elf.h>
#include <gtest/gtest.h>

#include "framework/plugin/note.hpp"
#include "tests/framework/plugin/plugin_files.hpp"
#include "tests/support/paths.hpp"

namespace tomlin::test {
namespace {

/// In a block of exactly that size, so that a sanitizer sees a byte too far.
ElfNote read(const std::string& file) {
  const auto exact = std::make_unique<std::byte[]>(file.size());  // NOLINT: no capacity
  std::memcpy(exact.get(), file.data(), file.size());
  return read_elf_note({exact.get(), file.size()});
}

std::string morse() { return content(plugin("morse")); }

/// Returns the end of the notes: bytes behind it have no part in reading them.
std::size_t end_of_notes(const std::string& file) {
  Elf64_Ehdr head;
  std::memcpy(&head, file.data(), sizeof head);
  std::size_t end = head.e_phoff + head.e_phnum * sizeof(Elf64_Phdr);
  for (std::size_t k = 0; k < head.e_phnum; ++k) {
    Elf64_Phdr segment;
    std::memcpy(&segment, file.data() + head.e_phoff + k * sizeof segment, sizeof segment);
    if (segment.p_type != PT_NOTE) continue;
    end = std::max<std::size_t>(end, segment.p_offset + segment.p_filesz);
  }
  return end;
}

TEST(ElfNote, TellsWhatAPluginIs) {
  const ElfNote note = read(morse());
  ASSERT_EQ(note.why, "");
  const auto parsed = parse_note(note.text);
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->number_types, (std::vector<std::string>{"double", "quadruple"}));
  EXPECT_EQ(parsed->instruction_sets.front(), "baseline");
  EXPECT_EQ(mismatch(*parsed, own_note()), "");
  const auto less = parse_note(read(content(plugin("faulty"))).text);
  ASSERT_TRUE(less);
  EXPECT_EQ(less->number_types, std::vector<std::string>{"double"});
  EXPECT_EQ(mismatch(*less, own_note()), "") << "less is no mismatch";
}

TEST(ElfNote, OtherFilesHaveNone) {
  EXPECT_EQ(read("").why, "not a shared library");
  EXPECT_EQ(read("[[body]]\n").why, "not a shared library");
  EXPECT_EQ(read(content(paths::program)).text, "");
  EXPECT_NE(read(content(plugin("no_note"))).why.find("not a plugin of tomlin"), std::string::npos);
  std::string other = morse();
  other[EI_CLASS] = ELFCLASS32;
  EXPECT_EQ(read(other).why, "a library for another kind of machine");
  other = morse();
  other[EI_DATA] = ELFDATA2MSB;
  EXPECT_EQ(read(other).why, "a library for another kind of machine");
  other = morse();
  other[offsetof(Elf64_Ehdr, e_machine)] ^= 0x40;
  EXPECT_EQ(read(other).why, "a library for another kind of machine");
}

/// Cut off anywhere there is a reason, or the note as it was; and nothing else happens.
TEST(ElfNote, EveryTruncation) {
  const std::string whole = morse();
  const std::string text = read(whole).text;
  const std::size_t end = end_of_notes(whole);
  for (std::size_t size = 0; size < end; ++size) {
    const ElfNote note = read(whole.substr(0, size));
    EXPECT_TRUE(note.text.empty() || note.text == text) << size;
    EXPECT_NE(note.text.empty(), note.why.empty()) << size;
  }
  EXPECT_EQ(read(whole.substr(0, end)).text, text);
}

/// Every byte that the reader looks at, with every bit of it turned over.
TEST(ElfNote, EveryFlippedBit) {
  const std::string whole = morse();
  std::string file = whole.substr(0, end_of_notes(whole));
  for (std::size_t at = 0; at < file.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      file[at] = static_cast<char>(file[at] ^ (1 << bit));
      const ElfNote note = read(file);
      EXPECT_NE(note.text.empty(), note.why.empty()) << at;
      file[at] = static_cast<char>(file[at] ^ (1 << bit));
    }
  }
}

/// Sizes and positions that wrap round, at random.
TEST(ElfNote, WildNumbers) {
  const std::string whole = morse();
  const std::string start = whole.substr(0, end_of_notes(whole));
  constexpr int kFiles = 20000;
  for (const unsigned seed : {1U, 2U, 3U}) {
    std::mt19937_64 random(seed);
    for (int k = 0; k < kFiles; ++k) {
      std::string file = start;
      for (int change = 0; change < 3; ++change) {
        const std::uint64_t wild[] = {~std::uint64_t{0}, std::uint64_t{1} << 63, random(),
                                      file.size() - random() % 64};
        const std::size_t at = random() % (file.size() - 8);
        std::memcpy(file.data() + at, &wild[random() % 4], random() % 2 == 0 ? 4 : 8);
      }
      const ElfNote note = read(file);
      EXPECT_NE(note.text.empty(), note.why.empty()) << seed << ' ' << k;
    }
  }
}

TEST(PluginNote, WhatIsMissingIsNoNote) {
  const std::string text = read(morse()).text;
  EXPECT_TRUE(parse_note(text));
  for (const char* key :
       {"api=", "release=", "abi=", "compiler=", "border=", "numbers=", "sets="}) {
    EXPECT_FALSE(parse_note(patched(text, key, std::string(std::strlen(key), '-')))) << key;
  }
  EXPECT_FALSE(parse_note(patched(text, "api=1", "api=x")));
  EXPECT_FALSE(parse_note(""));
}

TEST(PluginNote, AMismatchSaysWhichSideHasWhat) {
  const PluginNote own = own_note();
  PluginNote other = own;
  other.api = 7;
  EXPECT_EQ(mismatch(other, own),
            "the library is registered by interface 7, the program loads by 1: build the library "
            "again, with the tomlin that loads it");
  other = own;
  other.abi = "libc++ 1";
  other.compiler = "clang 99.0";
  EXPECT_NE(mismatch(other, own)
                .find("built with libc++ 1 (clang 99.0), the program with " + own.abi + " (" +
                      own.compiler + ")"),
            std::string::npos);
  other = own;
  other.release = "0.0.1";
  EXPECT_NE(mismatch(other, own)
                .find("the library was built with tomlin 0.0.1, the program is tomlin " +
                      own.release + ": build"),
            std::string::npos);
  other = own;
  other.border = "0123456789abcdef";
  EXPECT_NE(mismatch(other, own)
                .find("other headers of tomlin " + own.release +
                      " (0123456789abcdef) than the program (" + own.border + ")"),
            std::string::npos);
  other = own;
  other.compiler = "clang 99.0";
  EXPECT_EQ(mismatch(other, own), "") << "compilers that share an ABI get on";
}

}  // namespace
}  // namespace tomlin::test
