# Ceres names the BLAS that it was configured with, on Debian ATLAS beside the system's choice; a program would use
# whichever the linker meets first. volcal_one_blas(TARGET) puts the BLAS and LAPACK that were found in their place.
function(volcal_one_blas target)
  get_target_property(libraries ${target} INTERFACE_LINK_LIBRARIES)
  list(FILTER libraries EXCLUDE REGEX "lib(f77blas|atlas|blas|lapack|openblas)\\.(so|a)")
  list(APPEND libraries ${LAPACK_LIBRARIES} ${BLAS_LIBRARIES})
  set_target_properties(${target} PROPERTIES INTERFACE_LINK_LIBRARIES "${libraries}")
endfunction()

# Sets VARIABLE to what OPENBLAS_CORETYPE should be on this machine (identify/numeric/blas_core.h), often nothing:
# tests and benchmarks run with it, as the program starts itself again with it.
function(volcal_better_blas_core variable)
  if(NOT DEFINED CACHE{VOLCAL_BETTER_BLAS_CORE})
    try_run(run compiled
      SOURCES ${PROJECT_SOURCE_DIR}/cmake/better_blas_core.cpp ${PROJECT_SOURCE_DIR}/identify/numeric/blas_core.cpp
      CMAKE_FLAGS "-DINCLUDE_DIRECTORIES=${PROJECT_SOURCE_DIR}/include"
      LINK_LIBRARIES ${BLAS_LIBRARIES} ${CMAKE_DL_LIBS}
      CXX_STANDARD 20
      RUN_OUTPUT_VARIABLE core
      COMPILE_OUTPUT_VARIABLE said)
    if(NOT compiled)
      message(FATAL_ERROR "cmake/better_blas_core.cpp does not compile: ${said}")
    endif()
    if(NOT run EQUAL 0)
      set(core "")
    endif()
    set(VOLCAL_BETTER_BLAS_CORE "${core}" CACHE INTERNAL "OPENBLAS_CORETYPE where OpenBLAS does not know the processor")
  endif()
  set(${variable} "${VOLCAL_BETTER_BLAS_CORE}" PARENT_SCOPE)
endfunction()
