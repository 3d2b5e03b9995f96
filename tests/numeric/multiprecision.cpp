#include "multiprecision.hpp"

#include <Eigen/Geometry>

#include "reference/generic_model.hpp"

namespace dalembert::generic {
DALEMBERT_GENERIC_ENGINE(template, dalembert::testing::Multi);
}  // namespace dalembert::generic

namespace dalembert::testing {

generic::Model<Multi> exact_model(const ir::KinematicTree& tree, const Eigen::Vector3d& gravity) {
  generic::Model<Multi> model = to_generic<Multi>(tree, gravity);
  for (generic::Body<Multi>& body : model.bodies) {
    body.axis.normalize();
    Vector3<Multi> x = body.rotation.col(0).normalized(), y = body.rotation.col(1);
    y = (y - x * x.dot(y)).normalized();
    body.rotation << x, y, x.cross(y);
  }
  return model;
}

VectorX<Multi> exact_position(const ir::KinematicTree& tree, const Eigen::VectorXd& q) {
  VectorX<Multi> exact = q.cast<Multi>();
  for (const int first : tree.quaternions()) exact.segment<4>(first).normalize();
  return exact;
}

}  // namespace dalembert::testing
