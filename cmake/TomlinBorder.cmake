# cmake -DHEADERS="a;b" -DRELEASE=0.1.0 -DOUTPUT=border.hpp -P TomlinBorder.cmake: a header with the
# hash of all headers whose types cross the border between the program and a plugin.
set(hashes "")
foreach(header IN LISTS HEADERS)
  get_filename_component(name ${header} NAME)
  file(SHA256 ${header} hash)
  string(APPEND hashes "${name} ${hash}\n")
endforeach()
string(SHA256 border "${hashes}")
string(SUBSTRING ${border} 0 16 border)
file(WRITE ${OUTPUT} "#pragma once

// Made by CMake from the headers of framework/core, whose types cross the border to plugins.
#define TOMLIN_BORDER \"${border}\"
#define TOMLIN_RELEASE \"${RELEASE}\"
")
