#include "passes/combine_inertia.hpp"

#include "ir/rotation.hpp"

namespace dalembert::passes {

ir::Inertia moved(const ir::Inertia& inertia, const Eigen::Isometry3d& placement) {
  return {inertia.mass, placement.linear() * inertia.com + placement.translation(),
          ir::rotated(inertia.inertia, placement.linear())};
}

ir::Inertia combined(const std::vector<ir::Inertia>& parts) {
  int with_mass = 0;
  ir::Inertia whole;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  // Σ m c
  for (const ir::Inertia& part : parts) {
    whole.inertia += part.inertia;
    if (part.mass == 0) continue;
    ++with_mass;
    whole.mass += part.mass;
    whole.com = part.com;
    moment += part.mass * part.com;
  }
  if (with_mass < 2 || whole.mass == 0) return whole;
  whole.com = moment / whole.mass;
  for (const ir::Inertia& part : parts) {  // Steiner: − m [d][d] = m (dᵀd 1 − d dᵀ)
    const Eigen::Vector3d d = part.com - whole.com;
    if (part.mass != 0) whole.inertia += part.mass * (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose());
  }
  return whole;
}

}  // namespace dalembert::passes
