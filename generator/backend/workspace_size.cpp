#include "backend/workspace_size.hpp"

namespace dalembert::backend {

std::size_t workspace_bytes(const std::vector<ir::OutputArray>& arrays, const ir::Scene& scene, const ir::Plan& plan,
                            const ir::RolledProgram& rolled) {
  const std::size_t scalar = scene.scalar == ir::ScalarType::float32 ? 4 : 8;
  std::size_t bytes = 0;
  const auto align = [&] { bytes = (bytes + 63) / 64 * 64; };
  for (const ir::OutputArray& a : arrays) {
    align();
    bytes += scalar * static_cast<std::size_t>(a.rows) * static_cast<std::size_t>(a.columns);
  }
  if (scene.gravity_kind == ir::GravityKind::run_time) bytes += 3 * scalar;
  bytes += scene.payloads.size() * 10 * scalar;  // mass, centre of mass, inertia
  align();
  // Kept: a row of slots per component of a role, and one for the angles whose sines are kept.
  bool angles = false;
  const auto row = [&](int components) {
    bytes += scalar * static_cast<std::size_t>(components) * static_cast<std::size_t>(plan.slots + 8);
    align();
  };
  for (const ir::Role& role : rolled.roles) {
    if (role.name.empty()) continue;
    row(role.components);
    angles = angles || role.name == "sine" || role.name == "cosine" || role.name == "pose_sine";
  }
  if (angles) row(1);
  return bytes;
}

}  // namespace dalembert::backend
