// The tree the dynamics is computed on: fixed, locked and cut joints are gone, bodies stand in depth-first order.
//
// Invariants: bodies[k].parent < k (-1 is the base); a subtree is the contiguous range [k, k + subtree_size). The base's
// inertia matters only where it has coordinates.
//
// A joint of several coordinates is as many bodies in a row, all but the last without mass (ir/joint_types.hpp).
//
// An elastic joint is two on the same axis: the one of the URDF's name moves the motor, a body without mass, and the one behind
// it deflects the spring and moves the link.
//
// Every body's joint has a coordinate of its own, in the order of the bodies, except where the scene drives it through a mimic
// relation: such a body stays in the tree with its own position, q_body = multiplier · q_driver + offset, but nq and nv do
// not count it, and what its row and column would hold belongs to the driver's.
//
// A body whose joint a loop of the scene's lets follow others (ir/linkage.hpp) has a position of its own in q, and no
// coordinate in v. Such a tree is what users see; dynamics are computed on opened(), where every joint has its coordinate.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <dalembert/quaternion_joint.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ir/linkage.hpp"
#include "ir/robot_description.hpp"
#include "ir/scene.hpp"

namespace dalembert::ir {

struct Body {
  std::string name;                                             // the moving joint's child link
  std::string joint;                                            // the joint that moves it
  JointType type = JointType::revolute;                         // of one coordinate
  int parent = -1;                                              // body index, -1: the base
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();  // body frame in the parent body's frame at q = 0
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();              // unit, in the body frame
  Inertia inertia;                                              // fused, in the body frame
  int subtree_size = 1;                                         // bodies in the subtree, this one included

  int driven_by = -1;     // the body whose joint drives this one, never driven itself; -1: a coordinate of its own
  double multiplier = 1;  // read only when driven: q = multiplier · q_driver + offset
  double offset = 0;

  bool follows = false;  // by an embedded loop

  double armature = 0, damping = 0, friction = 0;  // as the scene asks; a driven body's are its driver's
  Spring spring;                                   // of the joint's own coordinate: a driven body has none
  std::string elastic;                             // the elastic joint whose deflection this body's joint is; else empty
  double pitch = 0;                                // of a helical joint: how far it slides per turn, m
  Limits limits;                                   // of a joint of one coordinate, as the URDF has them
  // Of a joint of several coordinates, which are as many bodies: what the URDF calls it, what it is, and which of them this is.
  std::string of;
  JointType kind = JointType::fixed;
  int part = 0, parts = 1;

  bool turns() const { return ir::turns(type); }
  bool slides() const { return ir::slides(type); }
  bool is_screw() const { return turns() && slides(); }
  JointType type_of_joint() const { return of.empty() ? type : kind; }
  double slide_per_unit() const { return ir::slide_per_unit(type, pitch); }
  // Whether it is part of a joint whose orientation is a quaternion: then all parts have the axes of the link at hand, and the
  // first has the joint's pose and motion.
  bool of_quaternion() const { return row_of(kind).has_quaternion(); }
  bool has_quaternion() const { return of_quaternion() && part == 0; }
  // How many displacements stand before the quaternion in q, and linear velocities before angular ones in v.
  int displacements() const { return std::max(0, row_of(kind).quaternion); }
  // Numbers of q: those of a joint of several coordinates are its first body's where it has a quaternion, else one each.
  int positions() const { return driven() ? 0 : !of_quaternion() ? 1 : part == 0 ? positions_of(kind) : 0; }
  bool driven() const { return driven_by >= 0; }
  bool independent() const { return !driven() && !follows; }  // has a coordinate in v of its own
};

// Where a link of the URDF ended up, or a frame that the scene puts on one.
struct LinkPlacement {
  std::string link;
  int body = -1;                                                // -1: the base
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();  // link frame in the body's frame
  std::string on = "";                                          // of a frame of the scene: its link

  std::string in_words() const { return on.empty() ? "link '" + link + "'" : "frame '" + link + "'"; }
};

inline constexpr int nobody = -2;

// Of a tree that is a part of a robot: where its numbers stand in the robot's q, v and body_names, as far behind its own base's
// as positions() and coordinates() say, and how large results are.
struct WithinRobot {
  std::vector<int> positions, coordinates, links;  // per body
  int nv = 0, count_of_links = 0;
};

struct KinematicTree {
  std::string robot;  // the URDF's robot name
  std::string base_link;
  JointType base_joint = JointType::fixed;  // of the base to the world: a free flyer, or none
  Inertia base;                             // fused, in the base link's frame
  std::vector<Body> bodies;
  std::vector<LinkPlacement> links;  // every link kept, in depth-first order; then the scene's frames
  std::vector<int> pushed;           // per wrench of the scene: the body it acts on
  std::vector<std::pair<int, int>>
      held;                       // per constraint: the body its forces act on, and that which has the opposite, or nobody
  int constraint_rows = 0;        // of the scene's contacts and loops
  std::vector<Linkage> linkages;  // whose loops are embedded
  std::optional<WithinRobot> within{};

  // The link or frame of this name; null where there is none.
  const LinkPlacement* find_link(std::string_view name) const {
    const auto at = std::find_if(links.begin(), links.end(), [&](const LinkPlacement& placed) { return placed.link == name; });
    return at == links.end() ? nullptr : &*at;
  }
  int joints() const { return static_cast<int>(bodies.size()); }  // moving joints, driven ones included
  // Per body: which of the joint coordinates is its own, or its driver's, counted from 0 behind the base's; -1 of what follows
  // by a loop.
  std::vector<int> coordinates() const {
    if (within) return within->coordinates;
    std::vector<int> index(bodies.size(), -1);
    int next = 0;
    for (size_t k = 0; k < bodies.size(); ++k)
      if (bodies[k].independent()) index[k] = next++;
    for (size_t k = 0; k < bodies.size(); ++k)
      if (bodies[k].driven()) index[k] = index[static_cast<size_t>(bodies[k].driven_by)];
    return index;
  }
  // Per body: where in q its joint's own numbers begin, counted from 0 behind the base's; of parts that have none, the first's.
  std::vector<int> positions() const {
    if (within) return within->positions;
    std::vector<int> index(bodies.size());
    int next = 0;
    for (size_t k = 0; k < bodies.size(); ++k) {
      index[k] = bodies[k].of_quaternion() && bodies[k].part > 0 ? index[k - 1] : next;
      next += bodies[k].positions();
    }
    for (size_t k = 0; k < bodies.size(); ++k)
      if (bodies[k].driven()) index[k] = index[static_cast<size_t>(bodies[k].driven_by)];
    return index;
  }
  bool any_quaternion() const {
    return std::any_of(bodies.begin(), bodies.end(), [](const Body& b) { return b.has_quaternion(); });
  }
  // Joints with a coordinate of their own.
  int independent_joints() const {
    return static_cast<int>(std::count_if(bodies.begin(), bodies.end(), [](const Body& b) { return b.independent(); }));
  }
  // Whether it follows by a loop, or is followed.
  bool in_linkage(int body) const {
    return std::any_of(linkages.begin(), linkages.end(), [&](const Linkage& linkage) {
      return std::count(linkage.dependent.begin(), linkage.dependent.end(), body) > 0 ||
             std::count(linkage.independent.begin(), linkage.independent.end(), body) > 0;
    });
  }
  // The same where no loop is embedded.
  KinematicTree opened() const {
    KinematicTree tree = *this;
    tree.linkages.clear();
    for (Body& body : tree.bodies) body.follows = false;
    return tree;
  }
  // Whether M, C and W do not depend on the joint's position: on a fixed base the first joint of every branch carries the frame
  // of reference, and slides with nothing but slides before them only shift it.
  bool carries_reference(size_t body) const {
    if (base_coordinates() > 0) return false;
    bool turns = bodies[body].turns();
    int above = bodies[body].parent;
    if (above < 0) return true;
    for (; !turns && above >= 0; above = bodies[static_cast<size_t>(above)].parent)
      turns = bodies[static_cast<size_t>(above)].turns();
    return !turns;
  }
  bool any_spring() const {
    return std::any_of(bodies.begin(), bodies.end(), [](const Body& b) { return b.spring.k != 0; });
  }
  // Whether a body is `below`, or above it; -1, the base, is above all.
  bool is_above(int body, int below) const {
    while (below > body) below = bodies[static_cast<size_t>(below)].parent;
    return below == body;
  }
  // Joints with a quaternion, as integrators know them; not the base.
  std::vector<QuaternionJoint> quaternion_joints() const {
    std::vector<QuaternionJoint> all;
    const std::vector<int> position = positions(), coordinate = coordinates();
    for (size_t k = 0; k < bodies.size(); ++k)
      if (bodies[k].has_quaternion())
        all.push_back({base_positions() + position[k], base_coordinates() + coordinate[k], bodies[k].displacements() > 0});
    return all;
  }
  // Where in q unit quaternions x y z w begin: the base's first.
  std::vector<int> quaternions() const {
    std::vector<int> first;
    if (row_of(base_joint).has_quaternion()) first.push_back(row_of(base_joint).quaternion);
    for (const QuaternionJoint& joint : quaternion_joints()) first.push_back(joint.q + (joint.slides ? 3 : 0));
    return first;
  }
  // The base moves where it has any.
  int base_coordinates() const { return coordinates_of(base_joint); }
  int base_positions() const { return positions_of(base_joint); }
  int nq() const {
    int numbers = base_positions();
    for (const Body& body : bodies) numbers += body.positions();
    return numbers;
  }
  int nv() const { return base_coordinates() + independent_joints(); }
};

}  // namespace dalembert::ir
