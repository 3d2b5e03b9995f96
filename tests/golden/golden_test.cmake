# Generates again what is committed and compares.
include("${CMAKE_CURRENT_LIST_DIR}/compare_folders.cmake")

file(REMOVE_RECURSE "${WORK}")
execute_process(COMMAND "${DALEMBERT}" ${COMMAND} -o "${WORK}" COMMAND_ERROR_IS_FATAL ANY)
compare_folders("${COMMITTED}" "${WORK}"
                "If the change is meant, update what is committed:\n  cmake --build --preset release --target regenerate")
