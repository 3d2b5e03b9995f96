#include "ir/implicit_joints.hpp"

namespace dalembert::ir {

std::vector<ImplicitJoint> implicit_joints(const KinematicTree& tree) {
  std::vector<ImplicitJoint> joints;
  const std::vector<int> coordinates = tree.coordinates();
  for (std::size_t k = 0; k < tree.bodies.size(); ++k) {
    const Body& body = tree.bodies[k];
    if (!body.independent() || (body.damping == 0 && body.spring.k == 0)) continue;
    joints.push_back({static_cast<int>(k), tree.base_coordinates() + coordinates[k], body.damping, body.spring.k});
  }
  return joints;
}

}  // namespace dalembert::ir
