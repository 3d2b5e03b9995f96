# dalembert_add_robot(TARGET URDF file [SCENE file] [NAME name] [TASKS] [NATIVE] [OPTIONS option...])
#
# Adds the static library TARGET: the dynamics of one robot in one use, generated while building and again whenever the URDF, the
# scene or the generator changes (and compiled again only when the generated code itself does). Link it like any other library:
#
#     dalembert_add_robot(my_robot URDF my_robot.urdf OPTIONS --base fixed)
#     target_link_libraries(my_controller PRIVATE my_robot)
#
#     #include "my_robot/dynamics.hpp"       // namespace my_robot
#
#   NAME     folder, namespace and C prefix of the code; TARGET if not given. Two robots in one program need two names.
#   TASKS    emit the oneTBB task graph as well (NAME/tasks.hpp). The only case in which oneTBB is needed.
#   NATIVE   optimise the code for the processor that compiles it, whatever the build type: -O3 -march=native. With AVX and FMA
#            it is about two and a half times as fast as plain x86-64 code; it runs on no older processor. The interface to it
#            stays the same.
#   OPTIONS  further options of `dalembert generate`, such as --base fixed --outputs mass_matrix,gravity
#
# Works the same inside this project's own tree and after find_package(dalembert).

include(CheckCXXCompilerFlag)
include("${CMAKE_CURRENT_LIST_DIR}/dalembert_check_compiler.cmake")

function(dalembert_add_robot target)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "TASKS;NATIVE" "URDF;SCENE;NAME" "OPTIONS")
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "dalembert_add_robot(${target}): unknown argument '${ARG_UNPARSED_ARGUMENTS}'; "
                        "options of the generator go behind OPTIONS")
  endif()
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
  list(TRANSFORM files PREPEND "${output_dir}/")

  # The generator leaves a file alone whose contents stay the same: the stamp carries the time, the sources are by-products.
  set(stamp "${include_dir}/${ARG_NAME}.stamp")
  add_custom_command(
    OUTPUT "${stamp}"
    BYPRODUCTS ${files}
    COMMAND dalembert::dalembert ${command} ${ARG_OPTIONS}
    COMMAND ${CMAKE_COMMAND} -E touch "${stamp}"
    DEPENDS ${inputs} $<TARGET_FILE:dalembert::dalembert>
    COMMENT "Generating the dynamics of ${ARG_NAME}"
    VERBATIM)

  add_library(${target} STATIC ${files} "${stamp}")
  target_include_directories(${target} PUBLIC "${include_dir}")
  target_link_libraries(${target} PUBLIC dalembert::runtime)
  set(options "")
  if(ARG_NATIVE)
    check_cxx_compiler_flag(-march=native DALEMBERT_HAS_MARCH_NATIVE)
    set(options -O3)
    if(DALEMBERT_HAS_MARCH_NATIVE)
      list(APPEND options -march=native)
    endif()
  endif()
  target_compile_options(${target} PRIVATE ${options})
  dalembert_check_compiler(${options})
  if(ARG_TASKS)
    target_link_libraries(${target} PUBLIC TBB::tbb)
  endif()
endfunction()
