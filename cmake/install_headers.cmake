# Installs the public headers of public_headers.txt below INCLUDE/volcal, and the headers that they include in turn
# below INTERNAL/volcal: cmake -D SOURCE=... -D INCLUDE=... -D INTERNAL=... -P install_headers.cmake

cmake_policy(VERSION 3.25)
file(STRINGS ${SOURCE}/cmake/public_headers.txt public REGEX "^[^#]")

# volcal_includes(OUT HEADER): headers of the project that a header includes, below its root.
function(volcal_includes out header)
  file(STRINGS ${SOURCE}/${header} lines REGEX "^#include \"volcal/")
  set(found)
  foreach(line IN LISTS lines)
    string(REGEX REPLACE "^#include \"volcal/([^\"]+)\".*" "\\1" name "${line}")
    list(APPEND found ${name})
  endforeach()
  set(${out} ${found} PARENT_SCOPE)
endfunction()

set(needed)
set(open ${public})
while(open)
  list(POP_FRONT open header)
  if(NOT EXISTS ${SOURCE}/${header})
    message(FATAL_ERROR "public_headers.txt: there is no ${header}")
  endif()
  list(APPEND needed ${header})
  volcal_includes(next ${header})
  list(REMOVE_ITEM next ${needed} ${open})
  list(APPEND open ${next})
endwhile()

foreach(header IN LISTS needed)
  get_filename_component(folder ${header} DIRECTORY)
  if(header IN_LIST public)
    file(INSTALL ${SOURCE}/${header} DESTINATION ${INCLUDE}/volcal/${folder})
  else()
    file(INSTALL ${SOURCE}/${header} DESTINATION ${INTERNAL}/volcal/${folder})
  endif()
endforeach()
