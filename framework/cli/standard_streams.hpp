#pragma once

namespace tomlin {

/// Opens something that cannot be written to under the numbers of standard input, output and error
/// that are closed (`>&-`), so that no file of a run is mistaken for one of them.
void occupy_closed_standard_streams();

}  // namespace tomlin
