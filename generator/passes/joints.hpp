// What of joints' coordinates the equations read.
//
// A body's joint has one coordinate and moves about or along the z axis of its body's frame, or both; its motion column is
// [sliding z; turning z], from the parameters. The base's joint to the world is the root's: a position and a quaternion
// (7), a twist in the base's axes (6), whose motion columns are the identity; or none.
#pragma once

#include <string>
#include <vector>

#include "ir/algorithm.hpp"
#include "ir/kinematic_tree.hpp"
#include "passes/symbolic.hpp"

namespace dalembert::passes {

class Builder;

// An equation's right sides for joints that turn and for those that slide, each with what it is for: "n_z (revolute), ...".
std::string either_way(const std::string& turning, const std::string& sliding);

// The roles in which a joint's position enters the equations; `reference`: those of poses, at rest where the joint carries the
// frame of reference.
struct JointRoles {
  int sine = 0, cosine = 0, slide = 0;
};
JointRoles joint_roles(Builder& builder, bool reference);
int joint_position_role(Builder& builder);
int joint_rate_role(Builder& builder);
int joint_acceleration_role(Builder& builder);
int joint_effort_role(Builder& builder);

// A role that is the joint's coordinate, as a node: of any source but sweep. A driven joint's sine, cosine and slide are of its
// driver's position, scaled; its position, rate and acceleration are its driver's own, the scale being in its motion column.
// coordinates, positions: of the tree.
ir::NodeId coordinate_node(ir::Graph& graph, const ir::Role& role, const ir::KinematicTree& tree,
                           const std::vector<int>& coordinates, const std::vector<int>& positions, bool rates_zero, int body);

// The base's axes in the world, from the quaternion x y z w of unit length; component(i) is its i-th number.
template <class Component, class Constant>
Mat3 base_rotation(const Component& component, const Constant& constant) {
  const Sym x = component(0), y = component(1), z = component(2), w = component(3);
  const Sym one = constant(1), two = constant(2);
  const auto diagonal = [&](Sym a, Sym b) { return one - two * sum_of_products(a, a, b, b); };
  const auto sum = [&](Sym a, Sym b, Sym c, Sym d) { return two * sum_of_products(a, b, c, d); };
  const auto difference = [&](Sym a, Sym b, Sym c, Sym d) { return two * difference_of_products(a, b, c, d); };
  return {Vec3{diagonal(y, z), difference(x, y, z, w), sum(x, z, y, w)},
          Vec3{sum(x, y, z, w), diagonal(x, z), difference(y, z, x, w)},
          Vec3{difference(x, z, y, w), sum(y, z, x, w), diagonal(x, y)}};
}

}  // namespace dalembert::passes
