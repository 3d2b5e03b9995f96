# dalembert_precompiled(NAME HEADERS header... LINK target... [OPTIONS option...])   what many files include, as a precompiled header
# dalembert_use_precompiled(TARGET NAME)   read it before TARGET's sources, which are compiled with the same OPTIONS
#
# Debug builds (the presets dev and tsan) do without: there a file that does not include what it needs fails to compile, and
# OPTIONS give way to the sanitizers'.
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/empty.cpp CONTENT "")

function(dalembert_precompiled name)
  cmake_parse_arguments(ARG "" "" "HEADERS;LINK;OPTIONS" ${ARGN})
  if(CMAKE_BUILD_TYPE STREQUAL "Debug")
    return()
  endif()
  add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/empty.cpp)
  target_compile_features(${name} PRIVATE cxx_std_20)
  target_link_libraries(${name} PRIVATE ${ARG_LINK} dalembert_warnings)
  target_compile_options(${name} PRIVATE ${ARG_OPTIONS})
  set_target_properties(${name} PROPERTIES DALEMBERT_OPTIONS "${ARG_OPTIONS}")
  target_precompile_headers(${name} PRIVATE ${ARG_HEADERS})
endfunction()

function(dalembert_use_precompiled target name)
  if(CMAKE_BUILD_TYPE STREQUAL "Debug")
    return()
  endif()
  target_precompile_headers(${target} REUSE_FROM ${name})
  target_compile_options(${target} PRIVATE $<TARGET_PROPERTY:${name},DALEMBERT_OPTIONS>)
  # Read from there, GCC 12's <string> is no system's header any more, and it sees copies of 2^63 bytes in it.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow -Wno-array-bounds>)
endfunction()

# dalembert_read_eigen_precompiled(DIRECTORY...)   the targets there and below that have no precompiled header of their own: tests
#                                                  and examples, whose emitted code is many small files
#
# A target whose sources define EIGEN_... before they include Eigen, or have flags that it was not compiled with, or whose objects are
# looked into, has the property DALEMBERT_EIGEN_AS_IT_IS.
function(dalembert_read_eigen_precompiled)
  get_property(flags GLOBAL PROPERTY DALEMBERT_PRECOMPILED_EIGEN)
  if(CMAKE_BUILD_TYPE STREQUAL "Debug" OR NOT CMAKE_CXX_COMPILER_ID MATCHES "^(GNU|Clang)$" OR NOT flags)
    return()
  endif()
  foreach(directory IN LISTS ARGN)
    get_property(targets DIRECTORY ${directory} PROPERTY BUILDSYSTEM_TARGETS)
    foreach(target IN LISTS targets)
      get_target_property(type ${target} TYPE)
      get_target_property(own ${target} PRECOMPILE_HEADERS)
      get_target_property(reused ${target} PRECOMPILE_HEADERS_REUSE_FROM)
      get_target_property(as_it_is ${target} DALEMBERT_EIGEN_AS_IT_IS)
      if(type MATCHES "^(EXECUTABLE|(STATIC|OBJECT)_LIBRARY)$" AND NOT own AND NOT reused AND NOT as_it_is)
        target_compile_options(${target} PRIVATE "$<$<COMPILE_LANGUAGE:CXX>:SHELL:${flags}>")
        add_dependencies(${target} precompiled_eigen)
      endif()
    endforeach()
    get_property(subdirectories DIRECTORY ${directory} PROPERTY SUBDIRECTORIES)
    if(subdirectories)
      dalembert_read_eigen_precompiled(${subdirectories})
    endif()
  endforeach()
endfunction()
