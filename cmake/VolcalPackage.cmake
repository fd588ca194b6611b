# A Debian package by CPack, of everything that is installed; scripts/package builds it.

set(VOLCAL_PACKAGE_MAINTAINER "The volcal authors <maintainers@volcal.invalid>" CACHE STRING
    "Who answers for the package: NAME <ADDRESS>")
mark_as_advanced(VOLCAL_PACKAGE_MAINTAINER)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME volcal)
set(CPACK_PACKAGE_VENDOR "The volcal authors")
set(CPACK_PACKAGE_CONTACT "${VOLCAL_PACKAGE_MAINTAINER}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "identify the geometric errors of machine tools")
set(CPACK_PACKAGE_DESCRIPTION "volcal takes the readings of indirect measurements (lengths of a laser
tracer, circles of a ball-bar, diagonals, straightness, angles, probed
points), finds the 21 geometric errors of a machine tool behind them with
their uncertainty, names what the measurement cannot see, and writes the
tables that a controller needs. This package has the program, its manual
pages, the C++ library and the Python module.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# What a program of one's own needs beside the library, to compile and to link.
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "g++, libceres-dev, libsuitesparse-dev, libeigen3-dev, libtomlplusplus-dev, "
    "nlohmann-json3-dev, libfmt-dev, libfast-float-dev, libmuparser-dev, libopenblas-dev, libzip-dev, pkg-config, chromium")
list(JOIN CPACK_DEBIAN_PACKAGE_SUGGESTS "" CPACK_DEBIAN_PACKAGE_SUGGESTS)
if(TARGET volcal_python)
  string(REGEX MATCH "^([0-9]+)\\.([0-9]+)" python_minor "${python_version}")
  math(EXPR python_next "${CMAKE_MATCH_2} + 1")
  set(CPACK_DEBIAN_PACKAGE_DEPENDS
      "python3 (>= ${python_minor}), python3 (<< ${CMAKE_MATCH_1}.${python_next}), python3-numpy")
endif()
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/debian_files.cmake)
set(CPACK_VOLCAL_SOURCE ${PROJECT_SOURCE_DIR})
set(CPACK_VOLCAL_BUILD ${PROJECT_BINARY_DIR})
include(CPack)
