// The tree the dynamics is computed on: fixed, locked and cut joints are gone, bodies stand in depth-first order.
//
// Invariants: bodies[k].parent < k (-1 is the base); a subtree is the contiguous range [k, k + subtree_size). The base's
// inertia matters only when it floats.
//
// An elastic joint is two on the same axis: the one of the URDF's name moves the motor, a body without mass, and the one behind
// it deflects the spring and moves the link.
//
// Every body's joint has a coordinate of its own, in the order of the bodies, except where the scene drives it through a mimic
// relation: such a body stays in the tree with its own position, q_body = multiplier · q_driver + offset, but nq and nv do
// not count it, and what its row and column would hold belongs to the driver's.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <string>
#include <vector>

#include "ir/robot_description.hpp"
#include "ir/scene.hpp"

namespace dalembert::ir {

struct Body {
  std::string name;                                             // the moving joint's child link
  std::string joint;                                            // the joint that moves it
  JointType type = JointType::revolute;                         // revolute, continuous or prismatic
  int parent = -1;                                              // body index, -1: the base
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();  // body frame in the parent body's frame at q = 0
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();              // unit, in the body frame
  Inertia inertia;                                              // fused, in the body frame
  int subtree_size = 1;                                         // bodies in the subtree, this one included

  int driven_by = -1;     // the body whose joint drives this one, never driven itself; -1: a coordinate of its own
  double multiplier = 1;  // read only when driven: q = multiplier · q_driver + offset
  double offset = 0;

  double armature = 0, damping = 0, friction = 0;  // as the scene asks; a driven body's are its driver's
  Spring spring;                                   // of the joint's own coordinate: a driven body has none
  std::string elastic;                             // the elastic joint whose deflection this body's joint is; else empty

  bool prismatic() const { return type == JointType::prismatic; }
  bool driven() const { return driven_by >= 0; }
};

// Where a link of the URDF ended up, or a frame that the scene puts on one.
struct LinkPlacement {
  std::string link;
  int body = -1;                                                // -1: the base
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();  // link frame in the body's frame
  std::string on = "";                                          // of a frame of the scene: its link

  std::string in_words() const { return on.empty() ? "link '" + link + "'" : "frame '" + link + "'"; }
};

struct KinematicTree {
  std::string robot;  // the URDF's robot name
  std::string base_link;
  bool floating_base = false;
  Inertia base;  // fused, in the base link's frame
  std::vector<Body> bodies;
  std::vector<LinkPlacement> links;  // every link kept, in depth-first order; then the scene's frames
  std::vector<int> pushed;           // per wrench of the scene: the body it acts on
  int constraint_rows = 0;           // of the scene's contacts and loops

  int joints() const { return static_cast<int>(bodies.size()); }  // moving joints, driven ones included
  // Per body: which of the joint coordinates is its own, or its driver's, counted from 0 behind the base's.
  std::vector<int> coordinates() const {
    std::vector<int> index(bodies.size());
    int next = 0;
    for (size_t k = 0; k < bodies.size(); ++k)
      if (!bodies[k].driven()) index[k] = next++;
    for (size_t k = 0; k < bodies.size(); ++k)
      if (bodies[k].driven()) index[k] = index[static_cast<size_t>(bodies[k].driven_by)];
    return index;
  }
  // Joints with a coordinate of their own.
  int independent_joints() const {
    return static_cast<int>(std::count_if(bodies.begin(), bodies.end(), [](const Body& b) { return !b.driven(); }));
  }
  // Whether M, C and W do not depend on the joint's position: on a fixed base the first joint of every branch carries the frame
  // of reference, and slides with nothing but slides before them only shift it.
  bool carries_reference(size_t body) const {
    if (floating_base) return false;
    bool slides = bodies[body].prismatic();
    int above = bodies[body].parent;
    if (above < 0) return true;
    for (; slides && above >= 0; above = bodies[static_cast<size_t>(above)].parent)
      slides = bodies[static_cast<size_t>(above)].prismatic();
    return slides;
  }
  bool any_spring() const {
    return std::any_of(bodies.begin(), bodies.end(), [](const Body& b) { return b.spring.k != 0; });
  }
  // Whether a body is `below`, or above it; -1, the base, is above all.
  bool is_above(int body, int below) const {
    while (below > body) below = bodies[static_cast<size_t>(below)].parent;
    return below == body;
  }
  // … and not above another body too.
  bool is_above_only(int body, int below, int beside) const { return is_above(body, below) && !is_above(body, beside); }
  int nq() const { return independent_joints() + (floating_base ? 7 : 0); }
  int nv() const { return independent_joints() + (floating_base ? 6 : 0); }
};

}  // namespace dalembert::ir
