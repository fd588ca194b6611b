# The pages of the report and of the workbench: bundled from npm packages when the program is built and kept inside the
# library. npm fetches them where it is installed; else they are fetched one by one, as the lock file names them. Without
# Node, or when the packages cannot be fetched, the program is built without its pages and says so.

set(VOLCAL_REPORT AUTO CACHE STRING "Build the HTML report: AUTO (when its packages can be fetched), ON, OFF")
set_property(CACHE VOLCAL_REPORT PROPERTY STRINGS AUTO ON OFF)

# Reports that the page cannot be built: an error when it was asked for.
function(volcal_report_unavailable reason)
  if(VOLCAL_REPORT STREQUAL "AUTO")
    message(WARNING "No report.html: ${reason}. Results are complete without it. To get the report, install "
                    "nodejs, make sure that the npm registry can be reached, and configure again.")
  else()
    message(FATAL_ERROR "No report.html: ${reason}")
  endif()
endfunction()

include(VolcalPackages)

# volcal_add_page(TARGET NAME SOURCE VARIABLE SOURCES): bundles a page into WORK/NAME.html, which SOURCE, a file of TARGET,
# takes in by the macro VARIABLE.
function(volcal_add_page target name source variable)
  set(web ${PROJECT_SOURCE_DIR}/identify/report/web)
  set(work ${PROJECT_BINARY_DIR}/report)
  set(page ${work}/${name}.html)
  file(GLOB_RECURSE inputs CONFIGURE_DEPENDS ${web}/src/* ${PROJECT_SOURCE_DIR}/identify/workbench/web/src/*)
  add_custom_command(
    OUTPUT ${page}
    COMMAND ${VOLCAL_NODE} ${web}/build.mjs --page ${name} ${work}/node_modules ${page}
    DEPENDS ${inputs} ${web}/build.mjs ${web}/library.mjs ${work}/packages.sha256
    COMMENT "Bundling the page of the ${name}"
    VERBATIM)
  set_source_files_properties(${PROJECT_SOURCE_DIR}/${source} PROPERTIES
    COMPILE_DEFINITIONS "${variable}=\"${page}\""
    OBJECT_DEPENDS ${page} SKIP_PRECOMPILE_HEADERS ON SKIP_UNITY_BUILD_INCLUSION ON)
  # A generated file belongs to the target that uses it.
  target_sources(${target} PRIVATE ${page})
endfunction()

# volcal_add_pages(REPORT WORKBENCH): embeds the pages into these libraries.
function(volcal_add_pages report workbench)
  if(NOT VOLCAL_REPORT)
    return()
  endif()
  if(NOT VOLCAL_NODE)
    volcal_report_unavailable("nodejs is not installed")
    return()
  endif()

  # Packages live in the build directory; they are fetched again only when the lock file changes.
  set(source ${PROJECT_SOURCE_DIR}/identify/report/web)
  set(work ${PROJECT_BINARY_DIR}/report)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${source}/package-lock.json)
  file(SHA256 ${source}/package-lock.json lock_hash)
  set(fetched "")
  if(EXISTS ${work}/packages.sha256)
    file(READ ${work}/packages.sha256 fetched)
  endif()
  if(NOT fetched STREQUAL lock_hash)
    file(COPY ${source}/package.json ${source}/package-lock.json ${source}/.npmrc DESTINATION ${work})
    message(STATUS "Fetching the packages of the report")
    volcal_fetch_packages(problem ${work})
    if(problem)
      volcal_report_unavailable("${problem}")
      return()
    endif()
    file(WRITE ${work}/packages.sha256 ${lock_hash})
  endif()

  volcal_add_page(${report} report identify/report/template_data.cpp VOLCAL_REPORT_TEMPLATE)
  volcal_add_page(${workbench} workbench identify/workbench/page.cpp VOLCAL_WORKBENCH_PAGE)
endfunction()
