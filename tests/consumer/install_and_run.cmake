# Installs the build to a scratch prefix, then configures, builds and runs the consumer against it.

set(work ${BUILD}/consumer)
file(REMOVE_RECURSE ${work})

function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${work}/prefix)
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${work}/build -G ${GENERATOR}
    -D CMAKE_PREFIX_PATH=${work}/prefix -D CMAKE_BUILD_TYPE=${BUILD_TYPE}
    -D CMAKE_CXX_COMPILER=${COMPILER} "-DCMAKE_CXX_FLAGS=${FLAGS}")
run(${CMAKE_COMMAND} --build ${work}/build)
set(campaign ${CMAKE_CURRENT_LIST_DIR}/../../datasets/examples/structure-0)
run(${work}/build/consumer ${campaign}/campaign.toml ${campaign}/truth/campaign.toml ${work}/result)
if(NOT EXISTS ${work}/result/error_tables.csv)
  message(FATAL_ERROR "consumer: no error tables")
endif()
