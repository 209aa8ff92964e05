# MPI::MPI_CXX, where MPI is installed with its headers. Where mpirun is installed without them, as many
# packages bring it, the compiler's wrapper names a folder that does not exist, and FindMPI ends in an
# error. The wrapper is therefore asked for mpi.h first.
option(TOMLIN_MPI "build the module for sweeps under mpirun, where MPI is installed" ON)

set(MPI_CXX_FOUND FALSE)
if(TOMLIN_MPI)
  set(mpi_wrapper ${MPI_CXX_COMPILER})
  if(NOT mpi_wrapper)
    find_program(mpi_wrapper NAMES mpicxx mpic++ mpicxx.openmpi mpicxx.mpich NO_CACHE)
  endif()
  set(mpi_without_headers 0)
  if(mpi_wrapper)
    execute_process(COMMAND ${mpi_wrapper} -x c++ -E -include mpi.h /dev/null
                    RESULT_VARIABLE mpi_without_headers OUTPUT_QUIET ERROR_QUIET)
  endif()
  if(mpi_without_headers EQUAL 0)
    set(MPI_CXX_SKIP_MPICXX ON)
    find_package(MPI COMPONENTS CXX)
  endif()
endif()
