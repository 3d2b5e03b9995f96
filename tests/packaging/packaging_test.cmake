# Installs BUILD, then builds a copy of PROJECT with find_package(dalembert) and runs it. Then changes the robot, and expects the
# build to generate, compile and link again, and the program to notice. Last with a compiler that makes wrong code, which the
# robots' self-tests must notice before the program is linked. All paths contain a space.
file(REMOVE_RECURSE "${WORK}")

function(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  message(STATUS "${what}\n${output}")
  set(result ${result} PARENT_SCOPE)
  set(output "${output}" PARENT_SCOPE)
endfunction()
function(run_well what)
  run("${what}" ${ARGN})
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${what}: failed (${result})")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

# A project of one file, which configuring should refuse by these words.
function(refused folder lines words)
  file(WRITE "${WORK}/${folder}/CMakeLists.txt" "cmake_minimum_required(VERSION 3.25)\n${lines}")
  run("configure ${folder}" ${CMAKE_COMMAND} -S "${WORK}/${folder}" -B "${WORK}/${folder}/build" -G "${GENERATOR}"
      "-DCMAKE_PREFIX_PATH=${WORK}/prefix")
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  if(result EQUAL 0 OR NOT output MATCHES "${words}")
    message(FATAL_ERROR "${folder} should be refused by '${words}'")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

run_well("install" ${CMAKE_COMMAND} --install "${BUILD}" --prefix "${WORK}/prefix")
if(NOT EXISTS "${WORK}/prefix/share/doc/dalembert/docs/scene.md")  # which errors cite
  message(FATAL_ERROR "the pages should be installed")
endif()
file(COPY "${PROJECT}/" DESTINATION "${WORK}/project")
run_well("configure" ${CMAKE_COMMAND} -S "${WORK}/project" -B "${WORK}/build" -G "${GENERATOR}" "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}"
         "-DCMAKE_PREFIX_PATH=${WORK}/prefix" -DCMAKE_BUILD_TYPE=Release)
run_well("build" ${CMAKE_COMMAND} --build "${WORK}/build")
run_well("run" "${WORK}/build/two_robots")

# The self-test has run, and nothing of it is in a program that does not call it.
file(GLOB_RECURSE tests "${WORK}/build/*_self_test")
list(FILTER tests EXCLUDE REGEX "CMakeFiles")
list(LENGTH tests count)
if(NOT count EQUAL 2)
  message(FATAL_ERROR "the self-tests of two robots should be there: ${tests}")
endif()
run_well("symbols of the program" nm -C "${WORK}/build/two_robots")
if(NOT output MATCHES "arm::code_[0-9a-f]+::evaluate" OR output MATCHES "self_test|SelfTest")
  message(FATAL_ERROR "the program should have evaluate() and nothing of the self-test")
endif()
list(GET tests 0 first)
run_well("symbols of a self-test" nm -C "${first}")
if(NOT output MATCHES "::self_test")
  message(FATAL_ERROR "${first} should have the self-test")
endif()

# A variable that is not set, quoted and not.
foreach(empty "\"\${unset}\"" "\${unset}")
  refused(empty "project(empty LANGUAGES CXX)
find_package(dalembert REQUIRED)
dalembert_add_robot(arm URDF arm.urdf SCENE ${empty} NAME arm)
" "SCENE has no value")
endforeach()

# What has a keyword is no option beside it.
foreach(options "--batch=true|OPTIONS has --batch; the keyword BATCH is for that" "--parallel tasks|the keyword TASKS"
        "-o elsewhere|OPTIONS has -o; leave it out")
  string(REPLACE "|" ";" options "${options}")
  list(POP_FRONT options option)
  refused(twice "project(twice LANGUAGES CXX)
find_package(dalembert REQUIRED)
dalembert_add_robot(arm URDF arm.urdf OPTIONS --base fixed ${option})
" "${options}")
endforeach()

# A robot that is not there is missed before anything is built, one that is made while building is not.
refused(missing [[project(missing LANGUAGES CXX)
find_package(dalembert REQUIRED)
add_custom_command(OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/made.urdf COMMAND xacro made.xacro -o made.urdf)
dalembert_add_robot(made URDF ${CMAKE_CURRENT_BINARY_DIR}/made.urdf)
dalembert_add_robot(gripper URDF robots/gripper.urdf)
]] "dalembert_add_robot\\(gripper\\): there is no URDF ${WORK}/missing/robots/gripper.urdf;")
if(output MATCHES "robot\\(made\\)")
  message(FATAL_ERROR "a URDF that a command makes should not be missed")
endif()

# Generated code is C++.
set(urdf "${WORK}/project/cart_pole.urdf")
refused(of_c "project(of_c LANGUAGES C)
find_package(dalembert REQUIRED)
dalembert_add_robot(arm URDF \"${urdf}\")
" "add CXX to the languages of project")

# A robot in a library that others find installed, several files a compilation.
file(WRITE "${WORK}/exported/controller.cpp" "#include \"arm/dynamics.hpp\"\nint joints() { return arm::nv; }\n")
file(WRITE "${WORK}/exported/CMakeLists.txt" "cmake_minimum_required(VERSION 3.25)
project(exported LANGUAGES CXX)
set(CMAKE_UNITY_BUILD ON)
find_package(dalembert REQUIRED)
dalembert_add_robot(arm URDF \"${urdf}\" BATCH NO_SELF_TEST)
add_library(controller STATIC controller.cpp)
target_link_libraries(controller PUBLIC arm)
install(TARGETS controller arm EXPORT exported)
install(EXPORT exported DESTINATION lib/cmake/exported)
")
run_well("configure a library with a robot" ${CMAKE_COMMAND} -S "${WORK}/exported" -B "${WORK}/exported/build" -G "${GENERATOR}"
         "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}" "-DCMAKE_PREFIX_PATH=${WORK}/prefix")
run_well("build it" ${CMAKE_COMMAND} --build "${WORK}/exported/build")
run_well("install it" ${CMAKE_COMMAND} --install "${WORK}/exported/build" --prefix "${WORK}/exported/prefix")

# Without installing: from the build folder.
file(WRITE "${WORK}/from_build/main.cpp" "#include \"arm/dynamics.hpp\"\nint main() { return arm::nv - 2; }\n")
file(WRITE "${WORK}/from_build/CMakeLists.txt" "cmake_minimum_required(VERSION 3.25)
project(from_build LANGUAGES CXX)
find_package(dalembert REQUIRED)
dalembert_add_robot(arm URDF \"${urdf}\" OPTIONS --base fixed)
add_executable(from_build main.cpp)
target_link_libraries(from_build PRIVATE arm)
")
run_well("configure on the build folder" ${CMAKE_COMMAND} -S "${WORK}/from_build" -B "${WORK}/from_build/build" -G "${GENERATOR}"
         "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}" "-Ddalembert_DIR=${BUILD}")
run_well("build on it" ${CMAKE_COMMAND} --build "${WORK}/from_build/build")
run_well("run that" "${WORK}/from_build/build/from_build")

# A robot that xacro expands, by a program that stands in for it: what is included is followed.
set(folder "${WORK}/from_xacro")
file(WRITE "${folder}/bin/xacro" "#!/bin/sh
if test \"$1\" = --deps; then printf %s '${folder}/mass.xacro'; exit; fi
exec sed \"s/MASS/$(cat '${folder}/mass.xacro')/\" \"$1\"
")
file(CHMOD "${folder}/bin/xacro" PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
file(WRITE "${folder}/mass.xacro" "3")
file(WRITE "${folder}/arm.urdf.xacro" "<robot name=\"arm\"><link name=\"a\"/><link name=\"b\"><inertial><mass value=\"MASS\"/>
<inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link>
<joint name=\"j\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/><axis xyz=\"0 0 1\"/></joint></robot>")
file(WRITE "${folder}/CMakeLists.txt" "cmake_minimum_required(VERSION 3.16)
project(from_xacro LANGUAGES CXX)
find_package(dalembert REQUIRED)
dalembert_add_robot(arm URDF arm.urdf.xacro NO_SELF_TEST OPTIONS --base fixed)
add_custom_target(code DEPENDS \"\${CMAKE_CURRENT_BINARY_DIR}/dalembert/arm/arm.stamp\")
")
set(ENV{PATH} "${folder}/bin:$ENV{PATH}")
run_well("configure what xacro expands" ${CMAKE_COMMAND} -S "${folder}" -B "${folder}/build" -G "${GENERATOR}"
         "-DCMAKE_PREFIX_PATH=${WORK}/prefix")
foreach(expected "Generating" "" "Generating" "")
  run_well("generate from what xacro expands" ${CMAKE_COMMAND} --build "${folder}/build" --target code)
  string(REGEX MATCH "Generating" done "${output}")
  if(NOT done STREQUAL expected)
    message(FATAL_ERROR "'${done}' instead of '${expected}'")
  endif()
  file(STRINGS "${folder}/build/dalembert/arm/arm/dynamics.hpp" banner LIMIT_COUNT 1)
  string(REPLACE ";" "" banner "${banner}")
  list(APPEND banners "${banner}")
  if(done STREQUAL "")
    file(WRITE "${folder}/mass.xacro" "4")
  endif()
endforeach()
list(REMOVE_DUPLICATES banners)
list(LENGTH banners count)
if(NOT count EQUAL 2)
  message(FATAL_ERROR "the included file changed, and the code did not: ${banners}")
endif()

run_well("build again" ${CMAKE_COMMAND} --build "${WORK}/build")
if(output MATCHES "Generating|Building")
  message(FATAL_ERROR "nothing changed, and yet something was built again")
endif()

file(READ "${WORK}/project/cart_pole.urdf" urdf)
string(REPLACE "<mass value=\"3\"/>" "<mass value=\"4\"/>" urdf "${urdf}")
file(WRITE "${WORK}/project/cart_pole.urdf" "${urdf}")
run_well("build with a heavier cart" ${CMAKE_COMMAND} --build "${WORK}/build")
run("run with a heavier cart" "${WORK}/build/two_robots")
if(result EQUAL 0 OR NOT output MATCHES "mass on the rail 5 kg")
  message(FATAL_ERROR "the URDF changed and the program did not")
endif()

# A compiler that turns a sum of the arm's dynamics into a difference.
file(WRITE "${WORK}/compiler" "#!/bin/sh
case \"$*\" in */arm/dynamics.cpp*)
  sed -i '0,/\\(Scalar .* = .*\\) + /s//\\1 - /' '${WORK}/wrong/dalembert/arm/arm/dynamics.cpp';;
esac
exec \"$@\"
")
file(CHMOD "${WORK}/compiler" PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
set(build "${WORK}/wrong")
function(configure_wrong)
  run_well("configure with a compiler that makes wrong code" ${CMAKE_COMMAND} -S "${WORK}/project" -B "${build}" -G "${GENERATOR}"
           "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}" "-DCMAKE_PREFIX_PATH=${WORK}/prefix" -DCMAKE_BUILD_TYPE=Debug
           "-DCMAKE_CXX_COMPILER_LAUNCHER=${WORK}/compiler")
endfunction()
configure_wrong()
run("build with it" ${CMAKE_COMMAND} --build "${build}" --target two_robots)
if(result EQUAL 0 OR NOT output MATCHES "arm: the self-test fails: [a-z_]+\\([0-9]+, [0-9]+\\) at state")
  message(FATAL_ERROR "the compiler makes wrong code, and the build does not say so")
endif()
if(EXISTS "${build}/two_robots")
  message(FATAL_ERROR "the self-test failed, and yet the program was linked")
endif()

file(READ "${WORK}/project/CMakeLists.txt" lists)
string(REPLACE "arm.urdf NATIVE" "arm.urdf NATIVE NO_SELF_TEST" lists "${lists}")
file(WRITE "${WORK}/project/CMakeLists.txt" "${lists}")
configure_wrong()
run("build with it, unnoticed" ${CMAKE_COMMAND} --build "${build}" --target two_robots)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "NO_SELF_TEST, and yet it was run")
endif()
