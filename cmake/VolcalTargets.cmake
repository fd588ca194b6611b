# One library per layer. Which layer may include which: docs/layers.md, enforced by scripts/check-layers.

# Compiles through ccache where it is installed and no other launcher was asked for. What uses a precompiled header
# is cached only where ccache need not look for macros of it.
function(volcal_use_ccache)
  find_program(VOLCAL_CCACHE ccache DOC "Compiler cache, optional")
  if(PROJECT_IS_TOP_LEVEL AND VOLCAL_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${VOLCAL_CCACHE}
        PARENT_SCOPE)
  endif()
endfunction()

# Memory of a program by jemalloc, as identify/cli/allocator.cpp sets it.
function(volcal_use_jemalloc target)
  if(VOLCAL_JEMALLOC)
    target_link_libraries(${target} PRIVATE ${JEMALLOC_LIBRARY})
  endif()
endfunction()

function(volcal_compile_options target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                         -fno-math-errno -ffp-contract=off)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -Wno-maybe-uninitialized)  # false alarms in Eigen products
    target_compile_options(${target} PRIVATE -Wno-restrict)  # false alarms on std::string, GCC bug 105651
  endif()
  if(VOLCAL_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

# With VOLCAL_UNITY_BUILD neighbouring files of a target are compiled together, as many as VOLCAL_UNITY_SIZE and all groups
# of one size, so that the headers they share are read once and a template is instantiated once. Names in unnamed
# namespaces are therefore unique within a target (scripts/check-names). A file that renames what it includes
# (VOLCAL_VECTOR_LOOPS), or is for one instruction set, is compiled alone, and so is one that lists what is registered:
# another list can then take its place when a program is linked.
function(volcal_unity_build target)
  if(NOT VOLCAL_UNITY_BUILD)
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  set(together)
  foreach(source IN LISTS sources)
    file(STRINGS ${source} renames REGEX "^#define VOLCAL_VECTOR_LOOPS" LIMIT_COUNT 1)
    if(renames OR source MATCHES "_avx(2|512)\.cpp$")
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    else()
      list(APPEND together ${source})
    endif()
    file(STRINGS ${source} lists REGEX "^#define VOLCAL_[A-Z_]+\\(" LIMIT_COUNT 1)
    if(lists)
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    endif()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  list(LENGTH together count)
  math(EXPR groups "(${count} + ${VOLCAL_UNITY_SIZE} - 1) / ${VOLCAL_UNITY_SIZE}")
  set(number 0)
  foreach(source IN LISTS together)
    math(EXPR group "${number} * ${groups} / ${count}")
    math(EXPR number "${number} + 1")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP part_${group})
  endforeach()
endfunction()

# With VOLCAL_UNITY_BUILD, volcal_precompile(TARGET HEADER...) reads the headers once for TARGET, and
# volcal_use_precompiled(TARGET OF) lets TARGET read those of OF, whose options are the same. A file includes what it
# uses all the same. `-D CMAKE_DISABLE_PRECOMPILE_HEADERS=ON` does without, as the preset tidy, since clang-tidy cannot
# read what GCC precompiles.
function(volcal_precompile target)
  if(NOT VOLCAL_UNITY_BUILD)
    return()
  endif()
  target_precompile_headers(${target} PRIVATE ${ARGN})
  volcal_precompiled_options(${target})
endfunction()

function(volcal_precompiled_options target)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -fpch-preprocess)  # ccache asks for it
  endif()
endfunction()

# False alarms on std::string, GCC bug 105651, which are silent where its header is no precompiled one.
# scripts/check-clang looks for what is out of bounds all the same.
function(volcal_silence_strings target)
  if(VOLCAL_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)
  endif()
endfunction()

function(volcal_use_precompiled target of)
  target_precompile_headers(${target} REUSE_FROM ${of})
  volcal_precompiled_options(${target})
endfunction()

# Code that a Python module can link, with the calls inside a library as direct as in a program.
function(volcal_position_independent target)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_compile_options(${target} PRIVATE -fno-semantic-interposition)
endfunction()

function(volcal_optimise_little target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-Og>)
endfunction()

# Sources named *_avx2.cpp and *_avx512.cpp are compiled for these instruction sets (x86-64 only); the
# program chooses between them at run time. Everything else runs on any processor of the architecture.
# Such a file holds plain loops or intrinsics and includes no header with inline code that others share:
# the linker keeps one copy of an inline function, and it might keep the wrong one.
function(volcal_instruction_sets)
  foreach(source IN LISTS ARGN)
    if(source MATCHES "_avx2\\.cpp$")
      set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS "-mavx2;-mfma" SKIP_PRECOMPILE_HEADERS ON)
    elseif(source MATCHES "_avx512\\.cpp$")
      set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS "-mavx512f;-mavx512dq;-mfma"
                                                       SKIP_PRECOMPILE_HEADERS ON)
    endif()
  endforeach()
endfunction()

# volcal_find_sources(OUT DIR...): every .cpp below the directories, so that a plug-in needs no edit here.
# Variants for x86-64 instruction sets are left out on other processors.
function(volcal_find_sources out)
  set(sources)
  foreach(directory IN LISTS ARGN)
    file(GLOB_RECURSE found CONFIGURE_DEPENDS ${directory}/*.cpp)
    list(APPEND sources ${found})
  endforeach()
  list(FILTER sources EXCLUDE REGEX "/node_modules/")
  if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
    list(FILTER sources EXCLUDE REGEX "_avx(2|512)\\.cpp$")
  endif()
  set(${out} ${sources} PARENT_SCOPE)
endfunction()

# volcal_add_library(NAME [PRINTS] SOURCES DIR... [PUBLIC LIB...] [PRIVATE LIB...]): the layer's library volcal::NAME.
# PRINTS: it has no loop over numbers, and little optimisation does. A layer that has no source yet is an interface
# library with the same links.
function(volcal_add_library name)
  cmake_parse_arguments(PARSE_ARGV 1 layer "PRINTS" "" "SOURCES;PUBLIC;PRIVATE")
  set(target volcal_${name})
  volcal_find_sources(sources ${layer_SOURCES})
  if(sources)
    add_library(${target} STATIC ${sources})
    volcal_instruction_sets(${sources})
    volcal_compile_options(${target})
    volcal_position_independent(${target})
    volcal_unity_build(${target})
    target_link_libraries(${target} PUBLIC ${layer_PUBLIC} PRIVATE ${layer_PRIVATE})
    if(layer_PRINTS)
      volcal_optimise_little(${target})
    endif()
    set(scope PUBLIC)
  else()
    add_library(${target} INTERFACE)
    target_link_libraries(${target} INTERFACE ${layer_PUBLIC})
    set(scope INTERFACE)
  endif()
  target_compile_features(${target} ${scope} cxx_std_20)
  target_include_directories(${target} ${scope}
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/volcal-internal>)
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  add_library(volcal::${name} ALIAS ${target})
  set_property(GLOBAL APPEND PROPERTY VOLCAL_LAYERS ${target})
endfunction()
