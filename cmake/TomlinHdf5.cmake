# HDF5's C library without MPI, as tomlin::hdf5. CMake's own module wants a C compiler, which
# projects in C++ need not ask for.
find_path(TOMLIN_HDF5_INCLUDE hdf5.h PATH_SUFFIXES hdf5/serial)
find_library(TOMLIN_HDF5_LIBRARY NAMES hdf5_serial hdf5)
# Dimension scales.
find_library(TOMLIN_HDF5_HL_LIBRARY NAMES hdf5_serial_hl hdf5_hl)
mark_as_advanced(TOMLIN_HDF5_INCLUDE TOMLIN_HDF5_LIBRARY TOMLIN_HDF5_HL_LIBRARY)
if(TOMLIN_HDF5_INCLUDE AND TOMLIN_HDF5_LIBRARY AND TOMLIN_HDF5_HL_LIBRARY
   AND NOT TARGET tomlin::hdf5)
  add_library(tomlin::hdf5 INTERFACE IMPORTED)
  target_include_directories(tomlin::hdf5 INTERFACE ${TOMLIN_HDF5_INCLUDE})
  target_link_libraries(tomlin::hdf5 INTERFACE ${TOMLIN_HDF5_HL_LIBRARY} ${TOMLIN_HDF5_LIBRARY})
endif()
