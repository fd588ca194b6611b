# Run by CPack before it packs: what Debian wants of files that are installed elsewhere as they are.

set(root ${CPACK_TEMPORARY_INSTALL_DIRECTORY}${CPACK_PACKAGING_INSTALL_PREFIX})
set(documents ${root}/share/doc/volcal)

function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

if(EXISTS ${root}/share/zsh/site-functions)
  file(RENAME ${root}/share/zsh/site-functions ${root}/share/zsh/vendor-completions)
endif()

file(GLOB modules ${root}/lib/python3*/dist-packages/volcal/*.so)
if(modules)
  run(strip --strip-unneeded ${modules})
endif()

# The licence stands in copyright, which names /usr/share/common-licenses.
file(REMOVE ${documents}/LICENSE)
configure_file(${CPACK_VOLCAL_SOURCE}/cmake/debian_copyright.in ${documents}/copyright @ONLY)

set(epoch $ENV{SOURCE_DATE_EPOCH})
if(NOT epoch)
  string(TIMESTAMP epoch %s UTC)
endif()
execute_process(COMMAND date -u -R -d @${epoch} OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE
                COMMAND_ERROR_IS_FATAL ANY)
file(WRITE ${documents}/changelog.Debian
     "volcal (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium\n\n"
     "  * Built from the sources by CPack; changes are in changelog.gz.\n\n"
     " -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
file(COPY_FILE ${CPACK_VOLCAL_SOURCE}/CHANGELOG.md ${documents}/changelog)
if(EXISTS ${CPACK_VOLCAL_BUILD}/volcal.spdx.json)
  file(COPY_FILE ${CPACK_VOLCAL_BUILD}/volcal.spdx.json ${documents}/volcal.spdx.json)
endif()

file(GLOB pages ${root}/share/man/man1/*.1)
run(gzip -9nf ${documents}/changelog ${documents}/changelog.Debian ${pages})

file(GLOB_RECURSE files LIST_DIRECTORIES false ${root}/share/* ${root}/include/*)
foreach(file IN LISTS files)
  file(CHMOD ${file} PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
endforeach()
