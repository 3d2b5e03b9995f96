// The robot as the generic engine sees it: any tree of bodies joined by one-degree-of-freedom joints, as plain numbers. A joint
// of more is a row of bodies, all but the last without mass.
//
// Problem. Evaluate the dynamics M v̇ + C v + g = τ of any tree in any scalar, as the paper prints it: the yardstick that
// generated code is measured against. It allocates, throws and multiplies by zeros: it is not the real-time path.
// Invariants. bodies[k].parent < k, −1 stands for the base; check_model(), run by every entry point, refuses others.
//
// Coordinates. Fixed base: q and v = q̇ have one entry per coordinate of the joints. Floating base: q = [base position in
// the world (3), unit quaternion x y z w (4), joints], v = [base linear velocity (3), angular velocity (3), both in base
// axes, joint rates]. A spherical or floating joint is three or six bodies in a row, about (floating: along, then about) x, y
// and z of the last one's frame, whose axes all share: q has its quaternion x y z w (floating: before it the position in the
// frame at q = 0), v its twist along these axes. A joint may be driven by another's coordinate (Coordinate below);
// reduction.hpp takes care of that.
#pragma once

#include <algorithm>
#include <dalembert/spatial.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace dalembert::generic {

template <class S>
struct Body {
  int parent = -1;                               // body index, −1: the base
  bool prismatic = false;                        // else it turns about the axis
  Vector3<S> axis = Vector3<S>::UnitZ();         // unit, in the body's frame
  Matrix3<S> rotation = Matrix3<S>::Identity();  // of the body's frame in the parent's at q = 0
  Vector3<S> translation = Vector3<S>::Zero();   // of the body's frame in the parent's at q = 0, m
  Inertia<S> inertia;                            // in the body's frame
  S armature = S(0);                             // rotor inertia reflected to the joint: added to M's diagonal, kg m² or kg
  S damping = S(0);                              // viscous: damping · v_i is added to the bias, N m s/rad or N s/m
  S friction = S(0);                             // Coulomb: friction · sign(v_i) is added to the bias, N m or N
  S stiffness = S(0);  // of a spring: stiffness · (q_i − rest) is added to the bias, N m/rad or N/m
  S rest = S(0);       // where that spring is at rest, rad or m
  S pitch = S(0);      // of a joint that turns: how far it slides along the axis per radian, m
  int part = -1;       // of a joint with a quaternion: which of its bodies; else -1
  int parts = 1;       // how many they are
};

// q_joint = multiplier · q[index] + offset, index counting the joints' independent coordinates.
template <class S>
struct Coordinate {
  int index = 0;
  S multiplier = S(1);
  S offset = S(0);
};

// Which of the matrices C with dM/dt = C + Cᵀ and the same C v: the paper's, of dynamical balance, or that of Christoffel
// symbols.
enum class Coriolis { balance, christoffel };

template <class S>
struct Model {
  bool floating_base = false;
  Inertia<S> base;  // matters only when the base floats
  std::vector<Body<S>> bodies;
  Vector3<S> gravity = Vector3<S>::Zero();  // acceleration of free fall in world axes, m/s²; the usual one is (0, 0, −9.81)
  Coriolis coriolis = Coriolis::balance;
  std::vector<Coordinate<S>> coordinates;  // one per body; empty: every joint has a coordinate of its own, in order

  int joints() const { return static_cast<int>(bodies.size()); }
  // Independent coordinates of the joints.
  int coordinate_count() const {
    int count = coordinates.empty() ? joints() : 0;
    for (const Coordinate<S>& coordinate : coordinates) count = std::max(count, coordinate.index + 1);
    return count;
  }
  // Joints with a quaternion, before body `end`.
  int quaternions(int end) const {
    return static_cast<int>(std::count_if(bodies.begin(), bodies.begin() + end, [](const Body<S>& b) { return b.part == 0; }));
  }
  int quaternions() const { return quaternions(joints()); }
  int nq() const { return coordinate_count() + quaternions() + (floating_base ? 7 : 0); }
  int nv() const { return coordinate_count() + (floating_base ? 6 : 0); }
  int base_rows() const { return floating_base ? 6 : 0; }
  // Bodies that can move, as W's columns count them: the base first when it floats.
  int moving_bodies() const { return joints() + (floating_base ? 1 : 0); }
};

// Dimension errors are the caller's: std::invalid_argument says which argument and what was expected.
template <class S>
void check_model(const Model<S>& model) {
  for (int k = 0; k < model.joints(); ++k) {
    const int parent = model.bodies[static_cast<size_t>(k)].parent;
    if (parent < -1 || parent >= k)
      throw std::invalid_argument("dalembert::generic: body " + std::to_string(k) + " has parent " + std::to_string(parent) +
                                  "; a parent stands before its children, -1 is the base");
  }
  if (!model.coordinates.empty() && model.coordinates.size() != model.bodies.size())
    throw std::invalid_argument("dalembert::generic: " + std::to_string(model.coordinates.size()) + " coordinates for " +
                                std::to_string(model.bodies.size()) + " bodies; give one per body or none");
  for (const Coordinate<S>& coordinate : model.coordinates)
    if (coordinate.index < 0) throw std::invalid_argument("dalembert::generic: a coordinate has a negative index");
}

template <class S>
void check_size(const VectorX<S>& argument, int expected, const char* name) {
  if (argument.size() != expected)
    throw std::invalid_argument(std::string("dalembert::generic: ") + name + " has " + std::to_string(argument.size()) +
                                " entries, the model needs " + std::to_string(expected));
}

}  // namespace dalembert::generic
