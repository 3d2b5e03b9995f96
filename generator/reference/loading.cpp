#include "reference/loading.hpp"

#include "passes/combine_inertia.hpp"

namespace dalembert::reference {

ir::Inertia make_payload(const ir::KinematicTree& tree, int index) {
  double mass = tree.base.mass;
  for (const ir::Body& body : tree.bodies) mass += body.inertia.mass;
  mass *= 0.5 / (tree.joints() + 1);
  const double m = mass > 0 ? mass / (1 + index) : 1;
  ir::Inertia payload{m, {0.05, -0.03, 0.07}, Eigen::Matrix3d()};
  payload.inertia << 5.1e-3, 3e-4, -2e-4, 3e-4, 6.3e-3, 4e-4, -2e-4, 4e-4, 4.7e-3;
  payload.inertia *= m;
  return payload;
}

void load(const ir::Loading& loading, ir::KinematicTree& tree, ir::Scene& scene) {
  if (loading.gravity) scene.gravity = *loading.gravity;
  for (std::size_t i = 0; i < loading.payloads.size(); ++i) {
    const ir::LinkPlacement* const placed = tree.find_link(scene.payloads[i]);
    ir::Inertia& carrier = placed->body < 0 ? tree.base : tree.bodies[static_cast<std::size_t>(placed->body)].inertia;
    carrier = passes::combined({carrier, passes::moved(loading.payloads[i], placed->placement)});
  }
}

}  // namespace dalembert::reference
