/// Whatever bytes a shared library holds, what is read of it before it is loaded is a note or a
/// reason: never both, never neither.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "framework/plugin/elf_note.hpp"
#include "framework/plugin/note.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const tomlin::ElfNote elf = tomlin::read_elf_note(std::as_bytes(std::span(data, size)));
  if (elf.text.empty() == elf.why.empty()) std::abort();
  if (const auto note = tomlin::parse_note(elf.text)) {
    (void)tomlin::mismatch(*note, tomlin::own_note());
  }
  return 0;
}
