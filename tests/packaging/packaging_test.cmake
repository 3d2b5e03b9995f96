# Installs BUILD, then builds a copy of PROJECT with find_package(dalembert) and runs it. Then changes the robot, and expects the
# build to generate, compile and link again, and the program to notice. All paths contain a space.
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

run_well("install" ${CMAKE_COMMAND} --install "${BUILD}" --prefix "${WORK}/prefix")
file(COPY "${PROJECT}/" DESTINATION "${WORK}/project")
run_well("configure" ${CMAKE_COMMAND} -S "${WORK}/project" -B "${WORK}/build" -G "${GENERATOR}" "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}"
         "-DCMAKE_PREFIX_PATH=${WORK}/prefix" -DCMAKE_BUILD_TYPE=Release)
run_well("build" ${CMAKE_COMMAND} --build "${WORK}/build")
run_well("run" "${WORK}/build/two_robots")

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
