// M_ik = F_k·J_i (Shin, Park and Park 2016, eq. 31-36), and the armature of the joints on its diagonal.
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

void describe_mass_matrix(Builder& b, int array) {
  if (b.fills(array)) return;  // other quantities are made of M
  const Poses p = poses(b);
  const int force = forces(b).inertia;
  ir::Pairs m;
  m.array = array;
  m.equation = "M_ik = F_k.J_i";
  m.above = {{force, 0, p.joint_linear, 0}, {force, 3, p.joint_angular, 0}};
  m.symmetric = true;
  m.diagonal = b.armature();
  b.pairs(m);
}

}  // namespace dalembert::passes
