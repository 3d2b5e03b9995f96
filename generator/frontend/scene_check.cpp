#include "frontend/scene_check.hpp"

namespace dalembert::frontend {

ir::Base default_base(const ir::RobotDescription& robot) {
  if (robot.links[static_cast<size_t>(robot.root)].name == "world") return ir::Base::fixed;
  std::vector<int> welded{robot.root};
  for (size_t i = 0; i < welded.size(); ++i) {
    const size_t link = static_cast<size_t>(welded[i]);
    if (robot.links[link].inertia) return ir::Base::floating;
    for (int j : robot.children[link])
      if (const ir::Joint& joint = robot.joints[static_cast<size_t>(j)]; joint.type == ir::JointType::fixed)
        welded.push_back(joint.child);
  }
  return ir::Base::fixed;
}

}  // namespace dalembert::frontend
