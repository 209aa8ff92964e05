# cpack: a Debian package of the program with its pages and scenes, one of the library, one of the
# Python module where it is built, and an archive of the sources. `./dev package` makes all.

# What has to be built for them, which is not the tests.
add_custom_target(packaged DEPENDS tomlin ${targets})

set(CPACK_PACKAGE_NAME tomlin)
set(CPACK_PACKAGE_VENDOR "the developers of tomlin")
set(CPACK_PACKAGE_CONTACT "the developers of tomlin")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "models of nanoscale friction")
set(CPACK_STRIP_FILES ON)

set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME tomlin)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS python3-tomlin)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION
    "Tips, chains and rings on periodic surfaces, assembled from forces in TOML scenes.")

if(TARGET tomlin_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
  add_dependencies(packaged python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-tomlin)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "tomlin (= ${PROJECT_VERSION}), python3, python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS python3-matplotlib)
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION
      "The Python module, in /usr/lib/tomlin/python, which draws the figures of tomlin plot.")
endif()

if(TARGET tomlin_kim)
  list(APPEND CPACK_COMPONENTS_ALL kim)
  add_dependencies(packaged tomlin_kim)
  set(CPACK_DEBIAN_KIM_PACKAGE_NAME tomlin-kim)
  set(CPACK_DEBIAN_KIM_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_KIM_PACKAGE_DEPENDS "tomlin (= ${PROJECT_VERSION})")
  set(CPACK_DEBIAN_KIM_PACKAGE_SUGGESTS openkim-models)
  set(CPACK_COMPONENT_KIM_DESCRIPTION "Interatomic potentials by the KIM API.")
endif()

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libtomlin-dev)
string(JOIN ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
       "tomlin (= ${PROJECT_VERSION})" cmake g++ libeigen3-dev libboost-dev libhwy-dev
       librandom123-dev libtomlplusplus-dev nlohmann-json3-dev libspdlog-dev libhdf5-dev
       libxxhash-dev)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Libraries and headers for programs and plugins.")

set(CPACK_SOURCE_GENERATOR TXZ)
set(CPACK_SOURCE_PACKAGE_FILE_NAME tomlin-${PROJECT_VERSION})
set(CPACK_SOURCE_IGNORE_FILES "/[.]git/" "/build(-[a-z]+)?/" "[.]out/" "/__pycache__/")

include(CPack)
