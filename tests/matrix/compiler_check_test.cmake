# Configures a project that asks dalembert_check_compiler() about this compiler as it is on a plain target, and with a memcpy that
# does what g++ 12.2 does with constants where there is AVX-512: a warning is due in the second case alone.
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
foreach(case "sound" "broken")
  set(flags "-DPLAIN")
  if(case STREQUAL "broken")
    set(flags "-include '${WORK}/broken.hpp'")
  endif()
  execute_process(COMMAND ${CMAKE_COMMAND} -S "${WORK}" -B "${WORK}/${case}" "-DCMAKE_CXX_COMPILER=${COMPILER}" "-DCMAKE_CXX_FLAGS=${flags}"
                  OUTPUT_VARIABLE output ERROR_VARIABLE output COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "This compiler" warnings "${output}")
  list(LENGTH warnings count)
  if((case STREQUAL "broken" AND NOT count EQUAL 1) OR (case STREQUAL "sound" AND NOT count EQUAL 0))
    message(FATAL_ERROR "${case} memcpy: ${count} warnings\n${output}")
  endif()
endforeach()
