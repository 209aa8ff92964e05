/// Whatever bytes a journal or a checkpoint holds, its reader takes it or throws DamagedFile: it
/// neither crashes nor asks for more memory than the file could fill. The first byte says whether
/// checksums are put right before, since no guess would ever pass them.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <sys/mman.h>
#include <unistd.h>

#include "framework/output/checkpoint.hpp"
#include "framework/output/checksum.hpp"
#include "framework/output/journal.hpp"

namespace {

using namespace tomlin;

/// Gives every record that lies within the bytes the checksum that it should have.
void mend(std::vector<std::byte>& bytes) {
  std::uint64_t checksum = kFirstChecksum;
  std::size_t at = 0;
  while (bytes.size() - at >= kRecordHead + kRecordChecksum) {
    std::uint64_t length = 0;
    std::memcpy(&length, bytes.data() + at + kRecordHead - sizeof length, sizeof length);
    if (length > bytes.size() - at - kRecordHead - kRecordChecksum) return;
    checksum = checksum_of(std::span(bytes).subspan(at, kRecordHead + length), checksum);
    std::memcpy(bytes.data() + at + kRecordHead + length, &checksum, sizeof checksum);
    at += kRecordHead + length + kRecordChecksum;
  }
}

/// Holds the reader to what it said would come.
class Checked : public RunSink {
 public:
  void begin(const RunLayout& layout) override { row_ = layout.row(); }
  void sample(const std::vector<double>& row) override {
    if (row.size() != row_) std::abort();
  }
  void event(const Event& event) override {
    if (std::string(to_string(event.kind)).empty()) std::abort();
  }

 private:
  std::size_t row_ = 0;
};

void read_as_journal(std::span<const std::byte> bytes) {
  const Descriptor file(::memfd_create("journal", MFD_CLOEXEC));
  if (!file.open() || write_all(file, bytes) != 0) std::abort();
  try {
    JournalReader journal("/proc/self/fd/" + std::to_string(file.number()));
    Checked checked;
    journal.play(checked);
  } catch (const DamagedFile&) {
  }
}

void read_as_checkpoint(std::span<const std::byte> bytes) {
  try {
    const Checkpoint checkpoint = parse_checkpoint("checkpoint", bytes);
    if (checkpoint.state.size() > bytes.size()) std::abort();
  } catch (const DamagedFile&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto given = std::as_bytes(std::span(data, size)).subspan(1);
  std::vector<std::byte> bytes(given.begin(), given.end());
  if (data[0] % 2 == 1) mend(bytes);
  read_as_journal(bytes);
  read_as_checkpoint(bytes);
  return 0;
}
