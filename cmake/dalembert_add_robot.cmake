# dalembert_add_robot(TARGET URDF file [SCENE file] [NAME name] [TASKS] [BATCH] [NATIVE] [NO_SELF_TEST] [OPTIONS option...])
#
# Adds the static library TARGET: the dynamics of one robot in one use, generated while building and again whenever the URDF, what
# a .xacro or .sdf includes, the scene or the generator changes (and compiled again only when the generated code itself does). Link
# it like any other library:
#
#     dalembert_add_robot(my_robot URDF my_robot.urdf OPTIONS --base fixed)
#     target_link_libraries(my_controller PRIVATE my_robot)
#
#     #include "my_robot/dynamics.hpp"       // namespace my_robot
#
#   NAME     folder, namespace and C prefix of the code; TARGET if not given. Robots of one name in one program are kept apart in
#            C++, as long as no file includes both; by c_api.h they are not: there they need two names.
#   TASKS    emit the oneTBB task graph as well (NAME/tasks.hpp). The only case in which oneTBB is needed.
#   BATCH    emit functions of many states at once as well (NAME/batch.hpp; NAME/batch_tasks.hpp, for which a program that includes
#            it links oneTBB). Without it the scene's key `batch` is taken to be false.
#   NATIVE   optimise the code for the processor that compiles it, whatever the build type: -O3 -march=native. With AVX and FMA
#            a humanoid's is two to three times as fast as plain x86-64 code, an arm's 1.1 to 1.6 times (g++ 12); it runs on
#            no older processor. The interface to it stays the same. The variable DALEMBERT_NATIVE_LEVEL says another level
#            than -O3, for builds in which speed does not matter.
#   NO_SELF_TEST  don't run the code's self-test (NAME/self_test.hpp) after building it. By default a small program does, as
#            part of the build and before anything that links TARGET: a compiler or flags that spoil the code stop the build,
#            with the element that is wrong. Not run when cross-compiling without CMAKE_CROSSCOMPILING_EMULATOR; to be left out
#            as well where flags choose a processor newer than the one that builds.
#   OPTIONS  further options of `dalembert generate`, such as --base fixed --outputs mass_matrix,gravity
#
# URDF and SCENE must be there when CMake is run, unless they are made by an add_custom_command() above.
#
# Works the same inside this project's own tree and after find_package(dalembert).

include(CheckCXXCompilerFlag)
include("${CMAKE_CURRENT_LIST_DIR}/dalembert_check_compiler.cmake")

# Of whoever calls, an older one would have ninja take depfiles for those of other rules.
cmake_policy(PUSH)
cmake_policy(SET CMP0116 NEW)

function(dalembert_add_robot target)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "TASKS;BATCH;NATIVE;NO_SELF_TEST" "URDF;SCENE;NAME" "OPTIONS")
  if(NOT CMAKE_CXX_COMPILER_LOADED)
    message(FATAL_ERROR "dalembert_add_robot(${target}): generated code is C++, and this project has no such language; "
                        "add CXX to the languages of project(), or call enable_language(CXX)")
  endif()
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "dalembert_add_robot(${target}): unknown argument '${ARG_UNPARSED_ARGUMENTS}'; "
                        "options of the generator go behind OPTIONS")
  endif()
  # cmake_parse_arguments() makes no difference between an empty value and a keyword that is not there.
  foreach(keyword URDF SCENE NAME)
    if("${keyword}" IN_LIST ARGN AND "${ARG_${keyword}}" STREQUAL "")
      message(FATAL_ERROR "dalembert_add_robot(${target}): ${keyword} has no value; is a variable behind it not set? "
                          "Give one, or leave ${keyword} out")
    endif()
  endforeach()
  # What has a keyword of its own, or cannot be had by this way.
  foreach(option IN LISTS ARG_OPTIONS)
    string(REGEX REPLACE "=.*" "" option "${option}")
    if(option MATCHES "^--(batch|parallel|name|scene)$")
      string(REPLACE "parallel" "tasks" keyword "${CMAKE_MATCH_1}")
      string(TOUPPER "${keyword}" keyword)
      message(FATAL_ERROR "dalembert_add_robot(${target}): OPTIONS has ${option}; the keyword ${keyword} is for that")
    elseif(option MATCHES "^(-o|--out|--package|--language|--depfile)$")
      message(FATAL_ERROR "dalembert_add_robot(${target}): OPTIONS has ${option}; leave it out: the library is made of what stands in the build folder")
    endif()
  endforeach()
  if(NOT ARG_URDF)
    message(FATAL_ERROR "dalembert_add_robot(${target}): no robot; add URDF <file>")
  endif()
  if(NOT ARG_NAME)
    string(MAKE_C_IDENTIFIER "${target}" ARG_NAME)
  endif()

  set(inputs "")
  set(command generate)
  foreach(input URDF SCENE)
    if(ARG_${input})
      get_filename_component(file "${ARG_${input}}" ABSOLUTE BASE_DIR "${CMAKE_CURRENT_SOURCE_DIR}")
      get_source_file_property(is_made "${file}" GENERATED)
      if(NOT EXISTS "${file}" AND NOT is_made)
        message(FATAL_ERROR "dalembert_add_robot(${target}): there is no ${input} ${file}; name a file that is there, or one that "
                            "a command of this folder makes: relative names begin at ${CMAKE_CURRENT_SOURCE_DIR}")
      endif()
      list(APPEND inputs "${file}")
      set(${input} "${file}")
    endif()
  endforeach()
  set(include_dir "${CMAKE_CURRENT_BINARY_DIR}/dalembert/${target}")
  set(output_dir "${include_dir}/${ARG_NAME}")
  list(APPEND command "${URDF}" -o "${output_dir}" --name "${ARG_NAME}")
  if(SCENE)
    list(APPEND command --scene "${SCENE}")
  endif()

  set(files dynamics.hpp dynamics.cpp c_api.h c_api.cpp self_test.hpp self_test.cpp)
  if(ARG_TASKS)
    find_package(TBB REQUIRED)
    list(APPEND files tasks.hpp tasks.cpp)
    list(APPEND command --parallel tasks)
  else()
    list(APPEND command --parallel serial)
  endif()
  if(ARG_BATCH)
    list(APPEND files batch.hpp batch.cpp batch_tasks.hpp)
    list(APPEND command --batch true)
  else()
    list(APPEND command --batch false)
  endif()
  list(TRANSFORM files PREPEND "${output_dir}/")

  # The generator leaves a file alone whose contents stay the same: the stamp carries the time, the sources are by-products.
  set(stamp "${include_dir}/${ARG_NAME}.stamp")
  add_custom_command(
    OUTPUT "${stamp}"
    BYPRODUCTS ${files}
    COMMAND dalembert::dalembert ${command} --depfile "${stamp}.d" ${ARG_OPTIONS}
    COMMAND ${CMAKE_COMMAND} -E touch "${stamp}"
    DEPENDS ${inputs} $<TARGET_FILE:dalembert::dalembert>
    DEPFILE "${stamp}.d"
    COMMENT "Generating the dynamics of ${ARG_NAME}"
    VERBATIM)

  add_library(${target} STATIC ${files} "${stamp}")
  # Whoever installs a library of his own that links this one has no use for a path into the build folder.
  target_include_directories(${target} PUBLIC "$<BUILD_INTERFACE:${include_dir}>")
  # Several files define what they alone need to see of the C interface's workspace.
  set_target_properties(${target} PROPERTIES UNITY_BUILD OFF)
  target_link_libraries(${target} PUBLIC dalembert::runtime)
  set(options "")
  if(ARG_NATIVE)
    _dalembert_native_flags(options)
  endif()
  target_compile_options(${target} PRIVATE ${options})
  dalembert_check_compiler(${options})
  if(ARG_TASKS)
    target_link_libraries(${target} PUBLIC TBB::tbb)
  endif()
  if(NOT ARG_NO_SELF_TEST AND (NOT CMAKE_CROSSCOMPILING OR CMAKE_CROSSCOMPILING_EMULATOR))
    _dalembert_run_self_test(${target} ${ARG_NAME} "${include_dir}")
  endif()
endfunction()

cmake_policy(POP)

# What NATIVE stands for, into the variable of that name.
function(_dalembert_native_flags name)
  set(flags -O3)
  if(DALEMBERT_NATIVE_LEVEL)
    set(flags ${DALEMBERT_NATIVE_LEVEL})
  endif()
  check_cxx_compiler_flag(-march=native DALEMBERT_HAS_MARCH_NATIVE)
  if(DALEMBERT_HAS_MARCH_NATIVE)
    list(APPEND flags -march=native)
  endif()
  set(${name} ${flags} PARENT_SCOPE)
endfunction()

# Adds the program TARGET_self_test, which is run as soon as it is linked. Whatever links TARGET waits for that through the
# empty library TARGET_tested. The program itself takes TARGET as a file, or it would wait for itself.
function(_dalembert_run_self_test target name include_dir)
  set(code "// Written by dalembert_add_robot().
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include \"${name}/self_test.hpp\"

int main() {
  std::signal(SIGILL, [](int) {
    std::fputs(\"${name}: this processor does not know all instructions the code was compiled to; \"
               \"where that is meant, add NO_SELF_TEST to dalembert_add_robot(${target})\\n\", stderr);
    std::_Exit(3);
  });
  dalembert::SelfTestReport report;
  if (${name}::self_test(&report)) return 0;
  char text[512];
  dalembert::describe(report, text, sizeof text);
  std::fprintf(stderr, \"${name}: the self-test fails: %s\\n\"
               \"The compiler has made wrong code: try another version of it, another -march, less optimisation, and no \"
               \"-ffast-math.\\n\", text);
  return 1;
}
")
  file(CONFIGURE OUTPUT "${include_dir}/run_self_test.cpp" CONTENT "${code}" @ONLY)
  add_executable(${target}_self_test "${include_dir}/run_self_test.cpp")
  set_target_properties(${target}_self_test PROPERTIES
    RUNTIME_OUTPUT_DIRECTORY "${include_dir}" LINK_DEPENDS "$<TARGET_FILE:${target}>")
  target_include_directories(${target}_self_test PRIVATE "${include_dir}")
  target_link_libraries(${target}_self_test PRIVATE "$<TARGET_FILE:${target}>" dalembert::runtime)
  target_link_options(${target}_self_test PRIVATE "$<TARGET_PROPERTY:${target},INTERFACE_LINK_OPTIONS>")
  add_dependencies(${target}_self_test ${target})
  add_custom_command(TARGET ${target}_self_test POST_BUILD COMMAND ${target}_self_test
                     COMMENT "Testing the dynamics of ${name}" VERBATIM)
  add_library(${target}_tested INTERFACE)
  add_dependencies(${target}_tested ${target}_self_test)
  target_link_libraries(${target} INTERFACE $<BUILD_INTERFACE:${target}_tested>)
endfunction()
