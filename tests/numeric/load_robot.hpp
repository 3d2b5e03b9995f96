// Test robots as the compiler's tree: the real front end on the real file.
#pragma once

#include <iterator>
#include <vector>

#include "ir/kinematic_tree.hpp"
#include "robots.hpp"

namespace dalembert::testing {

// Gravity every test uses: no component is zero, so that none is forgotten. m/s², world axes.
inline const Eigen::Vector3d test_gravity{0.7, -1.3, -9.81};

// The mixed robot of joint_kinds.hpp.
inline constexpr TestRobot kinds_robot{"kinds_mixed", ""};
inline std::vector<TestRobot> test_robots_and_kinds() {
  std::vector<TestRobot> all(std::begin(test_robots), std::end(test_robots));
  all.push_back(kinds_robot);
  return all;
}

// Throws InputError when the URDF cannot be read.
ir::KinematicTree load_robot(const TestRobot& robot, bool floating_base);

}  // namespace dalembert::testing
