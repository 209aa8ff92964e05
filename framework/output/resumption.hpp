#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "framework/output/descriptor.hpp"
#include "framework/output/journal.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"

namespace tomlin {

/// Ways in which a run can begin.
struct Resumption {
  enum class Kind {
    from_start,  ///< nothing is there yet, or nothing that must be kept
    go_on,       ///< from the state; the journal is kept up to the mark
    finished,    ///< there is nothing left to do
    failed,      ///< the run came to its end by failing, and would again
  };
  Kind kind = Kind::from_start;
  Descriptor journal;  ///< owned; not open where there is none
  JournalMark mark;
  RunLayout layout;              ///< of the run that was stopped
  std::vector<std::byte> state;  ///< see RunOptions::resume_from
  std::string failure;           ///< what a failed run said
};

/// Finds out how a run can begin in a folder, for --resume. Touches nothing. Throws InputError,
/// with the difference, where what the folder holds is damaged, incomplete, of another scene or of
/// another version of the program.
Resumption find_resumption(const RunFolder& folder, const Scene& scene,
                           const std::string& program_version);

/// Throws InputError with both contents if the checkpoint in a folder, or the summary of a run that
/// is over, reports that the run was begun with plugins of other content than these.
void require_same_libraries(const std::filesystem::path& folder,
                            const std::vector<Library>& libraries);

/// Takes away what a run that has come to its end has no use for; one that was killed at the last
/// moment may have left it. Throws OutputError.
void remove_leftovers(RunFolder& folder);

/// Begins from the start, whatever the folder holds, for --force. Throws InputError when another
/// program is writing to it.
Resumption start_again(const RunFolder& folder);

}  // namespace tomlin
