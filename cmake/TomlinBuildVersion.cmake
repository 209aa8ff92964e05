# cmake -DLIST=sources.txt -DFOLDER=DIR -DRELEASE=0.1.0 -DOUTPUT=build_version.cpp
# -P TomlinBuildVersion.cmake: the version of the program with a hash of its sources.
file(STRINGS ${LIST} sources)
set(hashes "")
foreach(source IN LISTS sources)
  file(SHA256 ${FOLDER}/${source} hash)
  string(APPEND hashes "${source} ${hash}\n")
endforeach()
string(SHA256 build "${hashes}")
string(SUBSTRING ${build} 0 16 build)
file(WRITE ${OUTPUT} "#include \"framework/cli/build_version.hpp\"

// Made by CMake from all sources that results depend on.
const char* tomlin::build_version() { return \"${RELEASE}+${build}\"; }
")
