# The robots every test runs on, chosen by topology; make_robots.py writes those in this folder and says what each is for.
#
# DALEMBERT_TEST_ROBOTS        their names, which are C identifiers
# DALEMBERT_TEST_ROBOT_<name>  the URDF's path
# dalembert_test_robots        library of headers: `#include "robots.hpp"` lists names and paths as dalembert::test_robots,
#                              "read_robot.hpp" reads one as commands do

set(DALEMBERT_TEST_ROBOTS
    pendulum double_pendulum chain_7 planar_chain_10 skew_chain_10 skew_axes
    two_branches_at_base three_branches_at_base branch_below_base two_levels_of_branching unequal_limbs
    prismatic_mix gantry gantry_arms continuous_joints
    rotated_fixed_links offset_inertias frames_without_inertia massless_intermediate
    mirror_pair grippers quadruped hexapod humanoid hand humanoid_29 humanoid_39 humanoid_55
    chain_50 tree_5x20)
foreach(robot IN LISTS DALEMBERT_TEST_ROBOTS)
  set(DALEMBERT_TEST_ROBOT_${robot} "${CMAKE_CURRENT_LIST_DIR}/${robot}.urdf")
endforeach()

# Real robots: ours, and Debian's (package dart-doc), which join when they are there.
set(data /usr/share/doc/dart/data)
foreach(robot_and_file "mahru=${PROJECT_SOURCE_DIR}/examples/mahru/mahru.urdf" "drchubo=${data}/urdf/drchubo/drchubo.urdf"
        "atlas=${data}/sdf/atlas/atlas_v3_no_head.urdf" "wam=${data}/urdf/wam/wam.urdf" "kr5=${data}/urdf/KR5/KR5 sixx R650.urdf")
  string(REGEX MATCH "^([a-z0-9]+)=(.*)$" match "${robot_and_file}")
  if(EXISTS "${CMAKE_MATCH_2}")
    list(APPEND DALEMBERT_TEST_ROBOTS ${CMAKE_MATCH_1})
    set(DALEMBERT_TEST_ROBOT_${CMAKE_MATCH_1} "${CMAKE_MATCH_2}")
  else()
    message(WARNING "Tests run without the robot '${CMAKE_MATCH_1}': ${CMAKE_MATCH_2} is missing (Debian's robots are in the package dart-doc)")
  endif()
endforeach()

set(table "")
foreach(robot IN LISTS DALEMBERT_TEST_ROBOTS)
  string(APPEND table "    {\"${robot}\", \"${DALEMBERT_TEST_ROBOT_${robot}}\"},\n")
endforeach()
file(CONFIGURE OUTPUT "${CMAKE_CURRENT_BINARY_DIR}/robots/robots.hpp" CONTENT [[
// Written by tests/robots/robots.cmake.
#pragma once

#include <ostream>

namespace dalembert {

struct TestRobot {
  const char* name;
  const char* urdf;
};
inline void PrintTo(const TestRobot& robot, std::ostream* out) { *out << robot.name; }

inline constexpr TestRobot test_robots[] = {
@table@};

}  // namespace dalembert
]] @ONLY)
add_library(dalembert_test_robots INTERFACE)
target_include_directories(dalembert_test_robots INTERFACE "${CMAKE_CURRENT_BINARY_DIR}/robots" "${CMAKE_CURRENT_LIST_DIR}")
