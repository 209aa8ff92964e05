# cmake --install: the program, the libraries with their headers, and what find_package(tomlin)
# needs to use them and to compile forces of one's own.

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(libraries options core bodies scene model run study output forcefields integrators library
              plugin_kit plugin)
list(TRANSFORM libraries PREPEND tomlin_ OUTPUT_VARIABLE targets)
foreach(library ${libraries})
  set_target_properties(tomlin_${library} PROPERTIES EXPORT_NAME ${library})
endforeach()
set_target_properties(tomlin_library PROPERTIES EXPORT_NAME tomlin)

# Headers name each other from the root of the tree, and keep their places below it.
set(header_folder ${CMAKE_INSTALL_INCLUDEDIR}/tomlin)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/tomlin)

# The program too, as tomlin::program, for the tests of others.
set_target_properties(tomlin PROPERTIES EXPORT_NAME program)
install(TARGETS tomlin EXPORT tomlin RUNTIME COMPONENT program)
# The program looks for it from its own folder.
if(TARGET tomlin_kim)
  install(TARGETS tomlin_kim LIBRARY DESTINATION lib/tomlin COMPONENT kim)
endif()
if(TARGET tomlin_python)
  install(DIRECTORY ${CMAKE_BINARY_DIR}/python DESTINATION lib/tomlin COMPONENT python OPTIONAL
          USE_SOURCE_PERMISSIONS PATTERN __pycache__ EXCLUDE)
endif()
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME development)
install(TARGETS ${targets} EXPORT tomlin INCLUDES DESTINATION ${header_folder})
install(EXPORT tomlin FILE tomlinTargets.cmake NAMESPACE tomlin:: DESTINATION ${package_folder})

install(DIRECTORY framework forcefields integrators DESTINATION ${header_folder}
        FILES_MATCHING PATTERN "*.hpp" PATTERN "cli" EXCLUDE PATTERN "kim" EXCLUDE
        PATTERN "python" EXCLUDE)
install(FILES ${CMAKE_BINARY_DIR}/border/framework/plugin/border.hpp
        DESTINATION ${header_folder}/framework/plugin)
configure_package_config_file(cmake/tomlinConfig.cmake.in
                              ${CMAKE_BINARY_DIR}/package/tomlinConfig.cmake
                              INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/package/tomlinConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/package/tomlinConfig.cmake
              ${CMAKE_BINARY_DIR}/package/tomlinConfigVersion.cmake
              cmake/TomlinHdf5.cmake cmake/TomlinKernels.cmake cmake/kernels.cpp.in
              cmake/TomlinPlugin.cmake cmake/plugin_note.cpp.in
        DESTINATION ${package_folder})

# The same from the build folder, for those who have not installed it: -Dtomlin_DIR=build/package.
export(EXPORT tomlin FILE ${CMAKE_BINARY_DIR}/package/tomlinTargets.cmake NAMESPACE tomlin::)
foreach(file TomlinHdf5.cmake TomlinKernels.cmake TomlinPlugin.cmake kernels.cpp.in
             plugin_note.cpp.in)
  configure_file(cmake/${file} ${CMAKE_BINARY_DIR}/package/${file} COPYONLY)
endforeach()

# The pages, laid out as they link to each other, with the scenes that they run.
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME program)
install(FILES LICENSE README.md CHANGELOG.md CITATION.cff CONTRIBUTING.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
foreach(folder framework framework/bodies framework/guide framework/plugin framework/plugin/kim
               framework/run framework/scene forcefields integrators tests)
  file(GLOB pages CONFIGURE_DEPENDS ${folder}/*.md)
  install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder})
endforeach()
install(DIRECTORY scenarios DESTINATION ${CMAKE_INSTALL_DOCDIR}
        FILES_MATCHING PATTERN "*.md" PATTERN "*.toml" PATTERN "*.svg")

if(PROJECT_IS_TOP_LEVEL)
  include(TomlinPackage)
endif()
