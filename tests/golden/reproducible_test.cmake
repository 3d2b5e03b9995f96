# The same input gives the same bytes: whatever the folder, the working directory, the way the input's path is written, the
# language, the time zone and the user; and no path of this machine is in them.
include("${CMAKE_CURRENT_LIST_DIR}/compare_folders.cmake")

file(REMOVE_RECURSE "${WORK}")
file(MAKE_DIRECTORY "${WORK}/elsewhere")
file(COPY "${URDF}" DESTINATION "${WORK}/elsewhere")

execute_process(COMMAND "${DALEMBERT}" generate "${URDF}" -o "${WORK}/first" COMMAND_ERROR_IS_FATAL ANY)

execute_process(COMMAND ${CMAKE_COMMAND} -E env TZ=Asia/Seoul LANG=de_DE.UTF-8 LC_ALL=de_DE.UTF-8 USER=someone HOME=/nowhere
                        "${DALEMBERT}" generate mahru.urdf -o ../second/mahru
                WORKING_DIRECTORY "${WORK}/elsewhere" COMMAND_ERROR_IS_FATAL ANY)
compare_folders("${WORK}/first" "${WORK}/second/mahru" "The output depends on where or when it is made.")

file(GLOB files "${WORK}/first/*")
cmake_path(GET URDF PARENT_PATH folder)
cmake_host_system_information(RESULT host QUERY HOSTNAME)
foreach(file IN LISTS files)
  file(READ "${file}" text)
  foreach(trace IN ITEMS "${folder}" "${WORK}")
    string(FIND "${text}" "${trace}" at)
    if(NOT at EQUAL -1)
      message(FATAL_ERROR "${file} names the folder '${trace}'")
    endif()
  endforeach()
  if(text MATCHES "(^|[^A-Za-z0-9_])${host}([^A-Za-z0-9_]|$)")
    message(FATAL_ERROR "${file} names this machine, '${host}'")
  endif()
endforeach()
