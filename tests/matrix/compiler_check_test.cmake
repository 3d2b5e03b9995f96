# Configures a project that asks dalembert_check_compiler() about this compiler as it is on a plain target, and with a memcpy that
# does what g++ 12.2 does with constants where there is AVX-512: a warning is due in the second case alone, unless the project says
# that it knows.
file(REMOVE_RECURSE "${WORK}")
file(WRITE "${WORK}/CMakeLists.txt" "cmake_minimum_required(VERSION 3.25)
project(compiler_check LANGUAGES CXX)
include(\"${MODULE}\")
dalembert_check_compiler(-O1)
dalembert_check_compiler(-O1)
")
file(WRITE "${WORK}/broken.hpp" [[
#include <cstring>
namespace std {
inline void* broken_memcpy(void* to, const void* from, size_t size) {
  memcpy(to, from, size);
  double* last = static_cast<double*>(to) + size / sizeof(double) - 4;
  last[3] = last[2] = last[0];
  return to;
}
}  // namespace std
#define memcpy broken_memcpy
]])
foreach(case "sound" "broken" "known")
  set(flags "-DPLAIN")
  if(NOT case STREQUAL "sound")
    set(flags "-include '${WORK}/broken.hpp'")
  endif()
  set(options "")
  if(case STREQUAL "known")
    set(options -DDALEMBERT_COMPILER_DEFECT_KNOWN=ON)
  endif()
  execute_process(COMMAND ${CMAKE_COMMAND} -S "${WORK}" -B "${WORK}/${case}" "-DCMAKE_CXX_COMPILER=${COMPILER}" "-DCMAKE_CXX_FLAGS=${flags}"
                          ${options}
                  OUTPUT_VARIABLE output ERROR_VARIABLE output COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "CMake Warning[^\n]*\n  The generated code is not affected" warnings "${output}")
  list(LENGTH warnings count)
  if((case STREQUAL "broken" AND NOT count EQUAL 1) OR (NOT case STREQUAL "broken" AND NOT count EQUAL 0))
    message(FATAL_ERROR "${case} memcpy: ${count} warnings\n${output}")
  endif()
endforeach()
