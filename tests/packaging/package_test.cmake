# `dalembert generate --package`: what is generated configures, builds, passes its self-test, installs, and is found by a project that
# has nothing else of dalembert. Again over itself it changes nothing; over another's file it is refused.
file(REMOVE_RECURSE "${WORK}")

function(run what expected)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  message(STATUS "${what}\n${output}")
  if(NOT result EQUAL expected)
    message(FATAL_ERROR "${what}: exit status ${result}, expected ${expected}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

set(generate "${DALEMBERT}" generate "${ROBOT}" --base fixed --outputs mass_matrix,forward_dynamics --batch true --parallel tasks
    --name swinging --package)
run("generate" 0 ${generate} -o "${WORK}/package")
if(NOT output MATCHES "task graphs are left out of packages")
  message(FATAL_ERROR "what a package leaves out should be said")
endif()
foreach(file swinging/dynamics.hpp swinging/batch.cpp include/dalembert/arguments.hpp include/dalembert/integrators/motion.hpp CMakeLists.txt package.xml README.md)
  if(NOT EXISTS "${WORK}/package/${file}")
    message(FATAL_ERROR "there is no ${file}")
  endif()
endforeach()
file(READ "${WORK}/package/README.md" readme)
foreach(words "forward_dynamics(q, v, tau, workspace)" "| 0 | 0 | rad |" "A workspace has" "--package")
  string(FIND "${readme}" "${words}" at)
  if(at EQUAL -1)
    message(FATAL_ERROR "README.md does not say '${words}'")
  endif()
endforeach()
run("generate again" 0 ${generate} -o "${WORK}/package")
file(WRITE "${WORK}/taken/CMakeLists.txt" "# somebody's\n")
run("over another's file" 2 ${generate} -o "${WORK}/taken")

run("configure" 0 ${CMAKE_COMMAND} -S "${WORK}/package" -B "${WORK}/build" -G Ninja "-DCMAKE_INSTALL_PREFIX=${WORK}/prefix"
    "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}")
run("build" 0 ${CMAKE_COMMAND} --build "${WORK}/build")
run("test" 0 ${CMAKE_CTEST_COMMAND} --test-dir "${WORK}/build" --output-on-failure)
run("install" 0 ${CMAKE_COMMAND} --install "${WORK}/build")
file(WRITE "${WORK}/user/CMakeLists.txt" "cmake_minimum_required(VERSION 3.16)\nproject(user CXX)\nfind_package(swinging REQUIRED)\nadd_executable(user main.cpp)\ntarget_link_libraries(user swinging::swinging)\n")
file(WRITE "${WORK}/user/main.cpp" "#include <swinging/dynamics.hpp>\nint main() {\n  swinging::Workspace w;\n  swinging::VectorQ q;\n  swinging::VectorV v;\n  q.setZero();\n  v.setZero();\n  swinging::evaluate(q, v, w);\n  return swinging::mass_matrix(w)(0, 0) > 0 ? 0 : 1;\n}\n")
run("configure the user" 0 ${CMAKE_COMMAND} -S "${WORK}/user" -B "${WORK}/user/build" -G Ninja "-DCMAKE_PREFIX_PATH=${WORK}/prefix" "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}")
run("build the user" 0 ${CMAKE_COMMAND} --build "${WORK}/user/build")
run("run the user" 0 "${WORK}/user/build/user")

# --language c: a program in C that knows NAME.h alone, linked with the code behind it, where there are no exceptions.
run("generate for C" 0 "${DALEMBERT}" generate "${ROBOT}" --base fixed --outputs mass_matrix,forward_dynamics --batch true --name swinging
    --language c -o "${WORK}/c")
run("both" 2 ${generate} --language c -o "${WORK}/both")
file(READ "${WORK}/c/swinging.h" header)
string(FIND "${header}" "This header is all that is promised" at)
if(at EQUAL -1 OR NOT header MATCHES "--language c")
  message(FATAL_ERROR "swinging.h should say what is promised, and how it is made")
endif()
file(WRITE "${WORK}/c/host/host.c" "#include <stdio.h>
#include \"../swinging.h\"
int main(void) {
  const double q[swinging_q_size] = {0.1, 0.2}, v[swinging_v_size] = {0.3, 0.4}, tau[swinging_v_size] = {1, 2};
  double dv[2];
  int status = 7;
  swinging_forward_dynamics_batch_results results = {0};
  swinging_workspace* w = swinging_create();
  if (!w || swinging_nq() != 2 || swinging_v_index_link_02_joint != 1 || swinging_q_index_link_02_joint != 1 || !swinging_self_test(NULL)) return 1;
  swinging_forward_dynamics(q, v, tau, w);
  results.forward_dynamics = dv;
  if (swinging_batch_forward_dynamics(q, v, tau, 1, &results, &status, NULL) != 0 || status != -1) return 2;
  printf(\"%.15g %.15g\\n\", swinging_forward_dynamics_result(w)[0] / dv[0], swinging_forward_dynamics_result(w)[1] / dv[1]);
  swinging_destroy(w);
  return 0;
}
")
file(WRITE "${WORK}/c/host/CMakeLists.txt" "cmake_minimum_required(VERSION 3.16)
project(host C CXX)
file(GLOB code ../code/*.cpp)
add_executable(host host.c \${code})
set_source_files_properties(host.c PROPERTIES COMPILE_OPTIONS \"-std=c99;-Wall;-Wextra;-Wpedantic;-Werror\")
target_include_directories(host SYSTEM PRIVATE ${INCLUDE})
target_compile_options(host PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-std=c++17;-fno-exceptions;-fno-rtti>)
")
run("configure the host" 0 ${CMAKE_COMMAND} -S "${WORK}/c/host" -B "${WORK}/c/build" -G Ninja "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}" "-DCMAKE_C_FLAGS=${CXX_FLAGS}")
run("build the host" 0 ${CMAKE_COMMAND} --build "${WORK}/c/build")
run("run the host" 0 "${WORK}/c/build/host")
if(NOT output MATCHES "^(1|0\\.99999999999999[0-9]*|1\\.00000000000000[0-9]*) (1|0\\.99999999999999[0-9]*|1\\.00000000000000[0-9]*)\n$")
  message(FATAL_ERROR "one state and a batch of it should agree: ${output}")
endif()
