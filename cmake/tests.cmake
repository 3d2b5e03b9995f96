# dalembert_add_gtest(TARGET [THREADS] [PREFIX prefix] [PROPERTIES name value...])   the tests of a program, as its sources name them
#
# THREADS: something in it runs on several, and the preset tsan has it.
#
# A test of many parameters is one of CTest's: a process for each of 4,000 would begin, and read a robot, as often. Which parameter
# fails is in the output. In the long run (DALEMBERT_LONG_TESTS) tests find that word in their environment and take all their cases.
function(dalembert_add_gtest target)
  cmake_parse_arguments(ARG "THREADS" "PREFIX" "PROPERTIES" ${ARGN})
  if(ARG_THREADS)
    add_dependencies(threaded_tests ${target})
  endif()
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${source})
    file(READ ${source} text)
    string(REGEX MATCHALL "(^|\n)(TYPED_TEST|TEST|TEST_F|TEST_P)\\([A-Za-z_0-9]+, *[A-Za-z_0-9]+\\)" tests "${text}")
    foreach(test IN LISTS tests)
      string(REGEX MATCH "([A-Z_]+)\\(([A-Za-z_0-9]+), *([A-Za-z_0-9]+)\\)" test "${test}")
      set(name ${ARG_PREFIX}${CMAKE_MATCH_2}.${CMAKE_MATCH_3})
      set(skipped SKIP_REGULAR_EXPRESSION "\\[  SKIPPED \\]")
      if(CMAKE_MATCH_1 STREQUAL "TEST_P")
        set(filter "*/${CMAKE_MATCH_2}.${CMAKE_MATCH_3}/*")
        set(skipped "")  # some of its parameters
      elseif(CMAKE_MATCH_1 STREQUAL "TYPED_TEST")
        set(filter "${CMAKE_MATCH_2}/*.${CMAKE_MATCH_3}")
        set(skipped "")
      else()
        set(filter "${CMAKE_MATCH_2}.${CMAKE_MATCH_3}")
      endif()
      add_test(NAME ${name} COMMAND ${target} --gtest_brief=1 --gtest_filter=${filter})
      set_tests_properties(${name} PROPERTIES FAIL_REGULAR_EXPRESSION "] 0 tests from 0 " ${skipped} ${ARG_PROPERTIES})
      if(ARG_THREADS)
        set_property(TEST ${name} APPEND PROPERTY LABELS threads)
      endif()
      if(DALEMBERT_LONG_TESTS)
        set_property(TEST ${name} APPEND PROPERTY ENVIRONMENT DALEMBERT_LONG_TESTS=1)
      endif()
    endforeach()
  endforeach()
endfunction()

# dalembert_for_the_long_run(TARGET...)   not built beside everything else, but for the tests that sh tests/run.sh has no time for
function(dalembert_for_the_long_run)
  if(NOT DALEMBERT_LONG_TESTS)
    set_target_properties(${ARGN} PROPERTIES EXCLUDE_FROM_ALL ON)
  endif()
endfunction()

# dalembert_python_environment(RESULT)   what Python needs to load this build's module. An interpreter that is not sanitized itself
# needs the sanitizer's library first.
function(dalembert_python_environment result)
  set(environment "PYTHONPATH=${PROJECT_BINARY_DIR}/python" "PYTHONDONTWRITEBYTECODE=1")
  if(CMAKE_CXX_FLAGS MATCHES "fsanitize=[a-z,]*address")
    foreach(library asan stdc++)
      execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=lib${library}.so OUTPUT_VARIABLE file
                      OUTPUT_STRIP_TRAILING_WHITESPACE)
      list(APPEND files ${file})
    endforeach()
    list(JOIN files " " files)
    list(APPEND environment "LD_PRELOAD=${files}" "ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1")
  endif()
  set(${result} "${environment}" PARENT_SCOPE)
endfunction()
