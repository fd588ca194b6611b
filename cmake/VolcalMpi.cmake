# The draws of volcal montecarlo spread over the ranks of mpirun. One file knows MPI; it stands outside the unity build.
# Sets VOLCAL_WITH_MPI.

set(VOLCAL_MPI AUTO CACHE STRING "Spread the draws of volcal montecarlo over the ranks of mpirun: AUTO (where MPI is found), ON, OFF")
set_property(CACHE VOLCAL_MPI PROPERTY STRINGS AUTO ON OFF)

set(VOLCAL_WITH_MPI OFF)
if(VOLCAL_MPI STREQUAL "AUTO")
  find_program(VOLCAL_MPICC mpicc DOC "Tells whether MPI is installed")
  mark_as_advanced(VOLCAL_MPICC)
  if(VOLCAL_MPICC)
    enable_language(C)
    find_package(MPI QUIET COMPONENTS C)
    set(VOLCAL_WITH_MPI ${MPI_C_FOUND})
  endif()
elseif(VOLCAL_MPI)
  enable_language(C)
  find_package(MPI REQUIRED COMPONENTS C)
  set(VOLCAL_WITH_MPI ON)
endif()

# volcal_use_mpi(TARGET FILE): FILE of TARGET is compiled with MPI where there is one.
function(volcal_use_mpi target file)
  if(VOLCAL_WITH_MPI)
    list(TRANSFORM MPI_C_INCLUDE_DIRS PREPEND -isystem OUTPUT_VARIABLE includes)
    set_source_files_properties(${file} PROPERTIES
      COMPILE_DEFINITIONS "VOLCAL_HAVE_MPI;OMPI_SKIP_MPICXX;MPICH_SKIP_MPICXX" COMPILE_OPTIONS "${includes}")
    target_link_libraries(${target} PRIVATE ${MPI_C_LIBRARIES})
  endif()
endfunction()
