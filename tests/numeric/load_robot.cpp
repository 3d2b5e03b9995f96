#include "load_robot.hpp"

#include "frontend/urdf_reader.hpp"
#include "joint_kinds.hpp"
#include "passes/build_tree.hpp"

namespace dalembert::testing {

ir::KinematicTree load_robot(const TestRobot& robot, bool floating_base) {
  ir::Scene scene;
  scene.base = floating_base ? ir::Base::floating : ir::Base::fixed;
  Diagnostics warnings;
  if (std::string(robot.name) == kinds_robot.name) {
    const KindsRobot made = joint_kinds_robot("mixed");
    scene.joints = made.joints;
    return passes::build_tree(made.robot, scene, warnings);
  }
  return passes::build_tree(frontend::read_urdf(robot.urdf, warnings), scene, warnings);
}

}  // namespace dalembert::testing
