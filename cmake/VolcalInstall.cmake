# Installs the libraries, their public headers under include/volcal/{model,identify,sim}, those that these need
# under include/volcal-internal, the program, and a package for find_package(volcal), which defines
# volcal::volcal and one target per layer. What the program writes of itself is in VolcalReference.cmake.

include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/volcal)

get_property(layers GLOBAL PROPERTY VOLCAL_LAYERS)
list(REMOVE_ITEM layers volcal_workbench)  # a part of the program: who builds on the library needs no server
install(TARGETS ${layers} volcal_volcal
        EXPORT volcal_targets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT volcal_targets NAMESPACE volcal:: FILE volcal-targets.cmake DESTINATION ${package_dir})
if(TARGET volcal_cli)
  install(TARGETS volcal_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

# Which headers the public ones need is found when they are installed, so that the list alone is kept by hand.
install(CODE "
  set(SOURCE \"${PROJECT_SOURCE_DIR}\")
  set(INCLUDE \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}\")
  set(INTERNAL \"\${INCLUDE}/volcal-internal\")
  include(\"${PROJECT_SOURCE_DIR}/cmake/install_headers.cmake\")")
install(FILES LICENSE NOTICE DESTINATION ${CMAKE_INSTALL_DOCDIR})

configure_package_config_file(cmake/volcal-config.cmake.in ${PROJECT_BINARY_DIR}/volcal-config.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/volcal-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/volcal-config.cmake ${PROJECT_BINARY_DIR}/volcal-config-version.cmake
        cmake/VolcalBlas.cmake DESTINATION ${package_dir})
