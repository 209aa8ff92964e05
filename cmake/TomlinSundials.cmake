# CVODE of SUNDIALS with what it needs on one machine, as tomlin::cvode, for tests that hold the
# integrators against it. The package's own configuration file looks for PETSc and MPI as well.
find_path(TOMLIN_CVODE_INCLUDE cvode/cvode.h)
set(TOMLIN_CVODE_PARTS "")
foreach(part cvode nvecserial sunmatrixdense sunlinsoldense)
  find_library(TOMLIN_CVODE_${part} sundials_${part})
  mark_as_advanced(TOMLIN_CVODE_${part})
  list(APPEND TOMLIN_CVODE_PARTS ${TOMLIN_CVODE_${part}})
endforeach()
mark_as_advanced(TOMLIN_CVODE_INCLUDE)
if(TOMLIN_CVODE_INCLUDE AND NOT "${TOMLIN_CVODE_PARTS}" MATCHES "NOTFOUND"
   AND NOT TARGET tomlin::cvode)
  add_library(tomlin::cvode INTERFACE IMPORTED)
  target_include_directories(tomlin::cvode INTERFACE ${TOMLIN_CVODE_INCLUDE})
  target_link_libraries(tomlin::cvode INTERFACE ${TOMLIN_CVODE_PARTS})
  target_compile_definitions(tomlin::cvode INTERFACE TOMLIN_HAS_CVODE)
endif()
