#pragma once

namespace tomlin {

/// "0.1.0+0123456789abcdef": the version and a hash of the sources. Rows, journals and checkpoints
/// are continued and merged by programs of the same sources only.
const char* build_version();

}  // namespace tomlin
