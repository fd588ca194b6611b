# One library per layer; which layer may include which is checked by scripts/check-layers.

function(volcal_compile_options target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor)
  if(VOLCAL_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

# volcal_add_library(NAME DIR...): every .cpp below the directories, so that a plug-in needs no edit here.
function(volcal_add_library name)
  set(sources)
  foreach(directory IN LISTS ARGN)
    file(GLOB_RECURSE found CONFIGURE_DEPENDS ${directory}/*.cpp)
    list(APPEND sources ${found})
  endforeach()
  if(NOT sources)
    add_library(volcal_${name} INTERFACE)
    return()
  endif()
  add_library(volcal_${name} STATIC ${sources})
  add_library(volcal::${name} ALIAS volcal_${name})
  set_target_properties(volcal_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(volcal_${name} PUBLIC cxx_std_20)
  target_include_directories(volcal_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  volcal_compile_options(volcal_${name})
endfunction()
