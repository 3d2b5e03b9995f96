// C_ik = G_k·J_i, C_ki = F_k·J̇_i + H_k·J_i (Shin, Park and Park 2016, eq. 31-39).
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

void describe_coriolis_matrix(Builder& b, int array) {
  const Poses p = poses(b);
  const ForceRoles f = forces(b);
  ir::Pairs c;
  c.array = array;
  c.equation = "C_ik = G_k.J_i, C_ki = F_k.dJ_i + H_k.J_i";
  c.above = {{f.bias, 0, p.joint_linear, 0}, {f.bias, 3, p.joint_angular, 0}};
  c.below = {{f.inertia, 0, p.joint_rate, 0}, {f.inertia, 3, p.joint_rate, 3}, {f.transposed, 0, p.joint_angular, 0}};
  b.pairs(c);
}

}  // namespace dalembert::passes
