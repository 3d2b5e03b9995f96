# What `cmake --install` puts where, and the package that find_package(dalembert) finds.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/dalembert)

install(TARGETS dalembert dalembert_runtime EXPORT dalembert_targets)
if(TARGET dalembert_sdf)
  install(TARGETS dalembert_sdf LIBRARY DESTINATION lib/dalembert/readers)  # where the generator looks; a folder higher, CPack calls ldconfig
endif()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/runtime/include/dalembert DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
# Pages as they link to each other: README, docs and examples.
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs ${PROJECT_SOURCE_DIR}/examples DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(EXPORT dalembert_targets NAMESPACE dalembert:: DESTINATION ${package_dir})

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/dalembert-config.cmake.in
  ${PROJECT_BINARY_DIR}/dalembert-config.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/dalembert-config-version.cmake COMPATIBILITY SameMinorVersion)
# The same of this build, as it stands: -Ddalembert_DIR=<this build folder>.
export(EXPORT dalembert_targets NAMESPACE dalembert:: FILE "${PROJECT_BINARY_DIR}/dalembert_targets.cmake")
foreach(file dalembert_add_robot.cmake dalembert_check_compiler.cmake)
  configure_file(${CMAKE_CURRENT_LIST_DIR}/${file} ${PROJECT_BINARY_DIR}/${file} COPYONLY)
endforeach()
install(FILES ${PROJECT_BINARY_DIR}/dalembert-config.cmake ${PROJECT_BINARY_DIR}/dalembert-config-version.cmake
              ${CMAKE_CURRENT_LIST_DIR}/dalembert_add_robot.cmake ${CMAKE_CURRENT_LIST_DIR}/dalembert_check_compiler.cmake
        DESTINATION ${package_dir})
