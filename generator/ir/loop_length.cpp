#include "ir/loop_length.hpp"

#include <algorithm>

#include "ir/kinematic_tree.hpp"

namespace dalembert::ir {

double loop_length(const KinematicTree& tree, const Loop& loop) {
  if (loop.length) return *loop.length;
  Eigen::Vector3d points[2];
  for (std::size_t i = 0; i < 2; ++i) {
    const LinkPlacement* const link = tree.find_link(loop.links[i]);
    points[i] = link->placement * loop.at[i].translation();
    for (int k = link->body; k >= 0; k = tree.bodies[static_cast<std::size_t>(k)].parent) {
      const Body& body = tree.bodies[static_cast<std::size_t>(k)];
      if (body.driven())  // whose driver is at zero
        points[i] = body.axis * (body.slide_per_unit() * body.offset) +
                    Eigen::AngleAxisd(body.turns() ? body.offset : 0, body.axis) * points[i];
      points[i] = body.placement * points[i];
    }
  }
  return (points[1] - points[0]).norm();
}

}  // namespace dalembert::ir
