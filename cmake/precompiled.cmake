# dalembert_precompiled(NAME HEADERS header... LINK target...)   what many files include, as a precompiled header
# dalembert_use_precompiled(TARGET NAME)                         read it before TARGET's sources
#
# Debug builds (the presets dev and tsan) do without: there a file that does not include what it needs fails to compile.
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/empty.cpp CONTENT "")

function(dalembert_precompiled name)
  cmake_parse_arguments(ARG "" "" "HEADERS;LINK" ${ARGN})
  if(CMAKE_BUILD_TYPE STREQUAL "Debug")
    return()
  endif()
  add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/empty.cpp)
  target_compile_features(${name} PRIVATE cxx_std_20)
  target_link_libraries(${name} PRIVATE ${ARG_LINK} dalembert_warnings)
  target_precompile_headers(${name} PRIVATE ${ARG_HEADERS})
endfunction()

function(dalembert_use_precompiled target name)
  if(CMAKE_BUILD_TYPE STREQUAL "Debug")
    return()
  endif()
  target_precompile_headers(${target} REUSE_FROM ${name})
  # Read from there, GCC 12's <string> is no system's header any more, and it sees copies of 2^63 bytes in it.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow -Wno-array-bounds>)
endfunction()
