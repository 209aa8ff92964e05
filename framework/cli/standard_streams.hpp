#pragma once

namespace tomlin {

/// Where standard input, output or error are closed (`>&-`) their numbers are taken by something
/// that nothing can be written to, so that no file of a run is mistaken for one of them.
void occupy_closed_standard_streams();

}  // namespace tomlin
