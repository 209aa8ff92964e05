# CVODE of SUNDIALS with what it needs on one machine, as tomlin::cvode, for tests that hold the
# integrators against it. The package's own configuration file looks for PETSc and hypre as well.
include(CheckCXXSourceCompiles)

find_path(TOMLIN_CVODE_INCLUDE cvode/cvode.h)
set(TOMLIN_CVODE_PARTS "")
foreach(part cvode nvecserial sunmatrixdense sunlinsoldense)
  find_library(TOMLIN_CVODE_${part} sundials_${part})
  mark_as_advanced(TOMLIN_CVODE_${part})
  list(APPEND TOMLIN_CVODE_PARTS ${TOMLIN_CVODE_${part}})
endforeach()
find_library(TOMLIN_CVODE_core sundials_core) # a library of its own since SUNDIALS 7
if(TOMLIN_CVODE_core)
  list(APPEND TOMLIN_CVODE_PARTS ${TOMLIN_CVODE_core})
endif()
mark_as_advanced(TOMLIN_CVODE_INCLUDE TOMLIN_CVODE_core)

if(TOMLIN_CVODE_INCLUDE AND NOT "${TOMLIN_CVODE_PARTS}" MATCHES "NOTFOUND"
   AND NOT TARGET tomlin::cvode)
  # The headers of SUNDIALS 7 include those of MPI, where it was built with MPI.
  set(CMAKE_REQUIRED_INCLUDES ${TOMLIN_CVODE_INCLUDE})
  check_cxx_source_compiles("#include <cvode/cvode.h>
int main() { return 0; }" TOMLIN_CVODE_WITHOUT_MPI)
  unset(CMAKE_REQUIRED_INCLUDES)
  if(NOT TOMLIN_CVODE_WITHOUT_MPI)
    find_package(MPI QUIET COMPONENTS CXX)
  endif()
  if(TOMLIN_CVODE_WITHOUT_MPI OR TARGET MPI::MPI_CXX)
    add_library(tomlin::cvode INTERFACE IMPORTED)
    target_include_directories(tomlin::cvode INTERFACE ${TOMLIN_CVODE_INCLUDE})
    target_link_libraries(tomlin::cvode INTERFACE ${TOMLIN_CVODE_PARTS}
                          $<$<NOT:$<BOOL:${TOMLIN_CVODE_WITHOUT_MPI}>>:MPI::MPI_CXX>)
    target_compile_definitions(tomlin::cvode INTERFACE TOMLIN_HAS_CVODE)
  endif()
endif()
