# The Python module `volcal` (python/), for the system's Python: the interpreter of Debian, whose numpy it uses, and not
# another that stands before it on the path. VOLCAL_PYTHON=AUTO builds it where pybind11 and Python's headers are found.
# Defines the target volcal_python and VOLCAL_PYTHON_EXECUTABLE; the package, importable, is in <build>/python.

if(VOLCAL_PYTHON STREQUAL "OFF" OR CMAKE_CROSSCOMPILING)
  return()
endif()

find_program(VOLCAL_PYTHON_EXECUTABLE NAMES python3 PATHS /usr/bin NO_DEFAULT_PATH DOC "The system's Python")
find_path(VOLCAL_PYBIND11_INCLUDE_DIR pybind11/pybind11.h DOC "pybind11 2.10")
if(VOLCAL_PYTHON_EXECUTABLE)
  execute_process(
    COMMAND ${VOLCAL_PYTHON_EXECUTABLE} -c
            "from sysconfig import *; print(get_path('include'), get_config_var('EXT_SUFFIX'), get_python_version(), sep=';')"
    OUTPUT_VARIABLE python_facts OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  list(GET python_facts 0 python_include)
  list(GET python_facts 1 python_suffix)
  list(GET python_facts 2 python_version)
endif()
if(NOT VOLCAL_PYTHON_EXECUTABLE OR NOT VOLCAL_PYBIND11_INCLUDE_DIR OR NOT EXISTS "${python_include}/Python.h")
  set(python_missing "pybind11 or the headers of /usr/bin/python3 are missing: run scripts/install-dependencies python, "
                     "or install the packages pybind11-dev and python3-dev")
  if(VOLCAL_PYTHON STREQUAL "ON")
    message(FATAL_ERROR ${python_missing})
  endif()
  message(STATUS "No Python module; " ${python_missing})
  return()
endif()

volcal_find_sources(python_sources python)
add_library(volcal_python MODULE ${python_sources})
set_target_properties(volcal_python PROPERTIES
  PREFIX "" OUTPUT_NAME _volcal SUFFIX "${python_suffix}"
  CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
  LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/python/volcal)
volcal_compile_options(volcal_python)
volcal_optimise_little(volcal_python)
volcal_silence_strings(volcal_python)
volcal_unity_build(volcal_python)
target_compile_definitions(volcal_python PRIVATE VOLCAL_VERSION="${PROJECT_VERSION}")
target_include_directories(volcal_python SYSTEM PRIVATE ${VOLCAL_PYBIND11_INCLUDE_DIR} ${python_include})
# Of what it links it exports nothing: other modules of the process may hold other versions.
target_link_options(volcal_python PRIVATE LINKER:--exclude-libs,ALL)
target_link_libraries(volcal_python PRIVATE volcal_session volcal_report nlohmann_json::nlohmann_json fmt::fmt)

set(python_package __init__.py __init__.pyi py.typed)
foreach(file IN LISTS python_package)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/python/volcal/${file})
  configure_file(python/volcal/${file} ${PROJECT_BINARY_DIR}/python/volcal/${file} COPYONLY)
endforeach()

# Where the system's Python looks below /usr and below /usr/local.
set(VOLCAL_PYTHON_DIR lib/python${python_version}/dist-packages CACHE STRING "Folder of Python packages, below the prefix")
# A build of volcal_cli alone is installed without the module.
set(python_built ${PROJECT_BINARY_DIR}/python/volcal)
install(CODE "
  if(EXISTS \"${python_built}/_volcal${python_suffix}\")
    file(INSTALL DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${VOLCAL_PYTHON_DIR}/volcal\" TYPE FILE
         FILES \"${python_built}/_volcal${python_suffix}\" \"${python_built}/__init__.py\"
               \"${python_built}/__init__.pyi\" \"${python_built}/py.typed\")
  endif()")
