# `cpack` in the build folder makes the Debian package: generator, headers, the Python package, manual page, completion, pages.
set(manual ${CMAKE_CURRENT_BINARY_DIR}/dalembert.1.gz)
set(completion ${CMAKE_CURRENT_BINARY_DIR}/completion/dalembert)
add_custom_command(OUTPUT ${manual} ${completion}
  COMMAND dalembert::dalembert manual > ${CMAKE_CURRENT_BINARY_DIR}/dalembert.1
  COMMAND gzip -9nf ${CMAKE_CURRENT_BINARY_DIR}/dalembert.1
  COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_CURRENT_BINARY_DIR}/completion
  COMMAND dalembert::dalembert completion > ${completion}
  DEPENDS dalembert::dalembert VERBATIM)
add_custom_target(dalembert_manual ALL DEPENDS ${manual} ${completion})
install(FILES ${manual} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${completion} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${PROJECT_SOURCE_DIR}/CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR})

# What Debian wants of every package: who may copy it, and what changed, in Debian's own form.
file(STRINGS ${PROJECT_SOURCE_DIR}/CHANGELOG.md releases REGEX "^## ${PROJECT_VERSION} \\(")
if(NOT releases MATCHES "\\(([0-9]+)-([0-9]+)-([0-9]+)\\)")
  message(FATAL_ERROR "CHANGELOG.md has no '## ${PROJECT_VERSION} (date)'")
endif()
set(maintainer "the dalembert authors <maintainers@dalembert.invalid>")
execute_process(COMMAND date -u -R -d "${CMAKE_MATCH_1}-${CMAKE_MATCH_2}-${CMAKE_MATCH_3}" OUTPUT_VARIABLE date
                OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
set(debian ${CMAKE_CURRENT_BINARY_DIR}/debian)
file(WRITE ${debian}/changelog
     "dalembert (${PROJECT_VERSION}-1) unstable; urgency=medium\n\n  * What changed stands in CHANGELOG.md.\n\n -- ${maintainer}  ${date}\n")
execute_process(COMMAND gzip -9nkf ${debian}/changelog)
file(RENAME ${debian}/changelog.gz ${debian}/changelog.Debian.gz)
file(READ ${PROJECT_SOURCE_DIR}/LICENSE license)
string(REGEX REPLACE "\n\n" "\n.\n" license "${license}")
string(REGEX REPLACE "\n" "\n " license "${license}")
string(STRIP "${license}" license)
file(WRITE ${debian}/copyright
     "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\nUpstream-Name: dalembert\n\nFiles: *\nCopyright: 2026, the dalembert authors\nLicense: BSD-3-Clause\n ${license}\n")
install(FILES ${debian}/changelog.Debian.gz ${debian}/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME dalembert)
set(CPACK_PACKAGE_VENDOR "the dalembert authors")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${maintainer}")
set(CPACK_DEBIAN_PACKAGE_SECTION devel)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "g++, libeigen3-dev")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "cmake, libtbb-dev, python3-torch")
if(DALEMBERT_PYTHON_INTERPRETER)
  execute_process(COMMAND ${DALEMBERT_PYTHON_INTERPRETER} -c "import sys; print('python3 (>= %d.%d), python3 (<< %d.%d), python3-numpy' % (sys.version_info[:2] + (sys.version_info[0], sys.version_info[1] + 1)))"
                  OUTPUT_VARIABLE python_depends OUTPUT_STRIP_TRAILING_WHITESPACE)
  execute_process(COMMAND dpkg-query -W -f "\${Provides}" python3-numpy OUTPUT_VARIABLE provides ERROR_QUIET RESULT_VARIABLE ignored)
  string(REGEX MATCH "python3-numpy-abi[0-9]+" numpy_abi "${provides}")
  if(numpy_abi)
    string(APPEND python_depends ", ${numpy_abi}")
  endif()
  string(APPEND CPACK_DEBIAN_PACKAGE_DEPENDS ", ${python_depends}")
endif()
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "dynamics compiler for robots")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "A robot's description goes in, URDF or SDF; C++ for that one robot and
the one use there is for it comes out: inertia, bias, inverse and forward
dynamics with derivatives, Jacobians, contacts; without heap, lock or
exception. With the runtime's headers, a CMake function, and a Python
package that compiles robots when they are loaded.")
include(CPack)
