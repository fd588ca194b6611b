# Installs the build to a scratch prefix, then configures, builds and runs the consumers against it. They include
# public headers alone.

set(work ${BUILD}/consumer)
file(REMOVE_RECURSE ${work})

function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${work}/prefix)
file(GLOB sources ${CMAKE_CURRENT_LIST_DIR}/*.cpp ${CMAKE_CURRENT_LIST_DIR}/*.h)
foreach(source IN LISTS sources)
  file(STRINGS ${source} lines REGEX "^#include \"volcal/")
  foreach(line IN LISTS lines)
    string(REGEX REPLACE "^#include \"(volcal/[^\"]+)\".*" "\\1" header "${line}")
    if(NOT EXISTS ${work}/prefix/include/${header})
      message(FATAL_ERROR "consumer: ${source} includes ${header}, which is no public header")
    endif()
  endforeach()
endforeach()
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${work}/build -G ${GENERATOR}
    -D CMAKE_PREFIX_PATH=${work}/prefix -D CMAKE_BUILD_TYPE=${BUILD_TYPE}
    -D CMAKE_CXX_COMPILER=${COMPILER} "-DCMAKE_CXX_FLAGS=${FLAGS}")
run(${CMAKE_COMMAND} --build ${work}/build)
set(datasets ${CMAKE_CURRENT_LIST_DIR}/../../datasets)
set(campaign ${datasets}/examples/structure-0)
run(${work}/build/with_own_effect ${datasets}/hidden/21/campaign.toml ${CMAKE_CURRENT_LIST_DIR}/play.toml)
run(${work}/build/consumer ${campaign}/campaign.toml ${campaign}/truth/campaign.toml ${work}/result)
if(NOT EXISTS ${work}/result/error_tables.csv)
  message(FATAL_ERROR "consumer: no error tables")
endif()
run(${work}/build/with_own_format ${work}/result)
