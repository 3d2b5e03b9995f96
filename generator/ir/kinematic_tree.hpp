// The tree the dynamics is computed on: fixed, locked and cut joints are gone, bodies stand in depth-first order.
//
// Invariants: bodies[k].parent < k (-1 is the base); a subtree is the contiguous range [k, k + subtree_size); coordinate k of
// the joints belongs to body k. The base's inertia matters only when it floats.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "ir/robot_description.hpp"
#include "ir/scene.hpp"

namespace dalembert::ir {

struct Body {
  std::string name;        // the moving joint's child link
  std::string joint;       // the joint that moves it
  JointType type = JointType::revolute;  // revolute, continuous or prismatic
  int parent = -1;         // body index, -1: the base
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();  // body frame in the parent body's frame at q = 0
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();              // unit, in the body frame
  Inertia inertia;         // fused, in the body frame
  int subtree_size = 1;    // bodies in the subtree, this one included

  double armature = 0, damping = 0, friction = 0;  // as the scene asks; zero when it does not

  bool prismatic() const { return type == JointType::prismatic; }
};

// Where a link of the URDF ended up.
struct LinkPlacement {
  std::string link;
  int body = -1;  // -1: the base
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();  // link frame in the body's frame
};

struct KinematicTree {
  std::string robot;       // the URDF's robot name
  std::string base_link;
  bool floating_base = false;
  Inertia base;            // fused, in the base link's frame
  std::vector<Body> bodies;
  std::vector<LinkPlacement> links;  // every link kept, in depth-first order

  int joints() const { return static_cast<int>(bodies.size()); }
  int nq() const { return joints() + (floating_base ? 7 : 0); }
  int nv() const { return joints() + (floating_base ? 6 : 0); }
  bool is_ancestor_or_self(int ancestor, int body) const {
    return ancestor < 0 || (ancestor <= body && body < ancestor + bodies[static_cast<size_t>(ancestor)].subtree_size);
  }
};

}  // namespace dalembert::ir
