# Ceres names the BLAS that it was configured with, on Debian ATLAS beside the system's choice; a program would use
# whichever the linker meets first. volcal_one_blas(TARGET) puts the BLAS and LAPACK that were found in their place.
function(volcal_one_blas target)
  get_target_property(libraries ${target} INTERFACE_LINK_LIBRARIES)
  list(FILTER libraries EXCLUDE REGEX "lib(f77blas|atlas|blas|lapack|openblas)\\.(so|a)")
  list(APPEND libraries ${LAPACK_LIBRARIES} ${BLAS_LIBRARIES})
  set_target_properties(${target} PROPERTIES INTERFACE_LINK_LIBRARIES "${libraries}")
endfunction()
