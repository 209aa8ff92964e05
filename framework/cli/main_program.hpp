#pragma once

namespace tomlin {

/// The program `tomlin`; what it returns is its exit status. Throws nothing.
int program(int argc, const char* const* argv) noexcept;

}  // namespace tomlin
