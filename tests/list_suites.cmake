# Writes the ctest entries of a test program, one for every suite, into OUTPUT:
#   cmake -D PROGRAM=... -D FOLDER=... -D "LONG=FOLDER SUITE SECONDS SHARDS;..." -D ENVIRONMENT=... -D RESULTS=... -D OUTPUT=... -P list_suites.cmake
# Each entry leaves the outcome of its cases as RESULTS/ENTRY.xml, which scripts/count-tests reads.

cmake_policy(VERSION 3.25)
execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listed RESULT_VARIABLE failed TIMEOUT 120)
if(failed)
  message(FATAL_ERROR "${PROGRAM} --gtest_list_tests ended with ${failed}")
endif()
string(REGEX MATCHALL "(^|\n)[^ \n][^ \n]*\\.( |\n)" suites "${listed}")
list(TRANSFORM suites REPLACE "\n| " "")
list(TRANSFORM suites REPLACE "\\.$" "")

# volcal_entry(NAME SUITE COST [VARIABLE=VALUE...])
function(volcal_entry name suite cost)
  set(labels ${FOLDER} unit)
  if(suite MATCHES "Study")
    set(labels ${FOLDER} study)
  endif()
  string(REPLACE "/" "_" file ${name})
  string(APPEND entries "add_test([=[${name}]=] \"${PROGRAM}\" \"--gtest_filter=${suite}.*\" "
                        "\"--gtest_output=xml:${RESULTS}/${file}.xml\")\n"
                        "set_tests_properties([=[${name}]=] PROPERTIES COST ${cost} LABELS \"${labels}\" "
                        "ENVIRONMENT \"${ENVIRONMENT};${ARGN}\"")
  if(FOLDER STREQUAL "linuxcnc")  # two rs274 at once crash each other: they share memory
    string(APPEND entries " RESOURCE_LOCK linuxcnc")
  endif()
  set(entries "${entries})\n" PARENT_SCOPE)
endfunction()

set(entries "")
foreach(suite IN LISTS suites)
  set(name ${FOLDER}.${suite})
  set(long ${LONG})
  list(FILTER long INCLUDE REGEX "^${FOLDER} ${suite} ")
  if(long MATCHES "^[^ ]+ [^ ]+ ([0-9]+) ([0-9]+)$")
    set(seconds ${CMAKE_MATCH_1})
    set(shards ${CMAKE_MATCH_2})
    list(REMOVE_ITEM LONG ${long})
    math(EXPR cost "(${seconds} + ${shards} - 1) / ${shards}")
    if(shards GREATER 1)
      foreach(shard RANGE 1 ${shards})
        math(EXPR index "${shard} - 1")
        volcal_entry(${name}.${shard}of${shards} ${suite} ${cost}
                     GTEST_TOTAL_SHARDS=${shards} GTEST_SHARD_INDEX=${index})
      endforeach()
    else()
      volcal_entry(${name} ${suite} ${cost})
    endif()
  else()
    volcal_entry(${name} ${suite} 1)
  endif()
endforeach()
if(LONG)
  message(FATAL_ERROR "tests/long_suites.txt: no suite of its name, or not FOLDER SUITE SECONDS SHARDS: ${LONG}")
endif()
file(WRITE ${OUTPUT} "${entries}")
