# dalembert_check_compiler(FLAG...)
#
# Warns, once, if the project's compiler with the project's flags and FLAG... is known to compile a copy of constants wrongly:
# g++ 12.2 for targets with AVX-512, or tuned for them, writes 32 or 64 bytes {a, a, 0, 0} of a constant array as {a, a, a, a}.
# Generated code has no such copies (tests/matrix); the code around it may. Says nothing when cross-compiling, where the program
# cannot run, or where the project says that it knows: DALEMBERT_COMPILER_DEFECT_KNOWN=ON.
option(DALEMBERT_COMPILER_DEFECT_KNOWN "No warning of a compiler that copies constant arrays wrongly" OFF)

function(dalembert_check_compiler)
  string(MAKE_C_IDENTIFIER "DALEMBERT_COPIES_CONSTANTS ${CMAKE_CXX_FLAGS} ${CMAKE_BUILD_TYPE} ${ARGN}" result)
  if(CMAKE_CROSSCOMPILING OR DALEMBERT_COMPILER_DEFECT_KNOWN)
    return()
  endif()
  if(NOT DEFINED ${result})
    # A static library is not run: the project may have set this for try_compile().
    set(CMAKE_TRY_COMPILE_TARGET_TYPE EXECUTABLE)
    set(CMAKE_TRY_COMPILE_CONFIGURATION "${CMAKE_BUILD_TYPE}")
    try_run(${result} compiled
      SOURCE_FROM_CONTENT copy_of_constants.cpp [[
#include <cstring>
alignas(64) static constexpr double table[12] = {0.042, 0.042, 0.042, 0.042, 0, 0, 0, 0, 0.03, 0.03, 0, 0};
__attribute__((noinline)) void copy(double* to) { std::memcpy(to, table, sizeof table); }
int main() {
  double to[12];
  double* volatile at = to;
  copy(at);
  for (int i = 0; i < 12; ++i)
    if (at[i] != table[i]) return 1;
  return 0;
}
]]
      COMPILE_DEFINITIONS ${ARGN})
  endif()
  get_property(said GLOBAL PROPERTY dalembert_compiler_said)
  if("${${result}}" STREQUAL "1" AND NOT said)
    set_property(GLOBAL PROPERTY dalembert_compiler_said TRUE)
    list(JOIN ARGN " " flags)
    string(STRIP "${CMAKE_CXX_FLAGS} ${flags}" flags)
    message(WARNING
      "The generated code is not affected: it copies no constants. Your own code may be: this compiler, ${CMAKE_CXX_COMPILER_ID} "
      "${CMAKE_CXX_COMPILER_VERSION} with '${flags}', compiles copies of constant arrays wrongly, and of 32 bytes {a, a, 0, 0} "
      "writes {a, a, a, a}. Add -mstore-max=128 to its flags, or use another version; -DDALEMBERT_COMPILER_DEFECT_KNOWN=ON says "
      "that you know, and this warning is gone.")
  endif()
endfunction()
