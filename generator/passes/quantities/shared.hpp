// Sweeps that several quantities are made of. Each function adds what it names to the algorithm, once, and tells the roles.
#pragma once

#include <functional>

#include "passes/builder.hpp"

namespace dalembert::passes {

// Whose axes and origin Phases I to III go by. `cheapest`: the floating base's; on a fixed base the first body's of every
// branch, which M and C do not tell from the base's. `base`: the base's in any case.
enum class Frame { cheapest, base };

// Phase I (Shin, Park and Park 2016, eq. 20).
struct Poses {
  int rotation, position, joint_linear, joint_angular, velocity, joint_rate;
};
Poses poses(Builder& builder, Frame frame = Frame::cheapest);
Pose pose_of(SweepBuilder& s, const Poses& roles);
Twist joint_of(SweepBuilder& s, const Poses& roles);
Twist velocity_of(SweepBuilder& s, const Poses& roles);
// One along a coordinate of the base, zero along the others.
Twist unit_twist(SweepBuilder& s, int coordinate);

// A: how the twist changes, gravity taken off, in the base's axes about its origin; for the accelerations the function is
// given.
int accelerations(Builder& builder);
Twist acceleration_of(SweepBuilder& s, int role);

// Phase II (eq. 12, 13, 29, 30): sums over the subtree.
int composite_mass(Builder& builder);
struct SumRoles {
  int first, second, momentum, bias;
};
struct BodyAndSubtree {
  SumRoles body, subtree;
};
BodyAndSubtree body_and_subtree_sums(Builder& builder, Frame frame = Frame::cheapest);
// The same with the D of Christoffel symbols, whatever C the scene asks for beside them.
BodyAndSubtree christoffel_sums(Builder& builder, Frame frame);
SumRoles subtree_sums(Builder& builder, Frame frame = Frame::cheapest);
Sums sums_of(SweepBuilder& s, const SumRoles& roles);

// Phase III: F = A* J, G = A* J̇ + B* J, H = B*ᵀ J of every coordinate.
struct ForceRoles {
  int inertia, bias, transposed;
};
ForceRoles forces(Builder& builder, Frame frame = Frame::cheapest);

// g_i of every coordinate; also what the bias is at rest.
struct GravityRoles {
  int torque, mass, first, down;  // the last two along the body's axes
};
GravityRoles gravity_torques(Builder& builder);

// Whether C v + g and what joints add to it is g: nothing moves and nothing springs back.
bool bias_is_gravity(const Builder& builder);

// Recursive Newton-Euler: for no accelerations (the bias), for none without gravity, or for those that the function is given.
enum class Driven { at_rest, weightless, accelerated };
struct NewtonEuler {
  int angular, angular_acceleration, acceleration;  // of the body: w, dw and its origin's acceleration less gravity
  int torque;          // τ of every coordinate, with the scene's armature, damping, friction and springs
  int subtree_wrench;  // f, n of every subtree along its first body's axes; the base's: of the whole robot
};
NewtonEuler newton_euler(Builder& builder, Driven driven);

// The frame of the link that each body is named after, for projections; and the twist of a joint above, in the link's axes and
// at its origin. `three`: three inputs of the projection's graph, from a component of a role on.
struct LinkRoles {
  int axes, origin;
};
LinkRoles link_frames(Builder& builder);
using ThreeInputs = std::function<Vec3(ir::InputKind, int role, int from)>;
Twist joint_in_link(Builder& builder, const LinkRoles& links, const ThreeInputs& three);

// The factorisation M = Lᵀ D L along the tree: L_ki = V_k·J_i for i above k, D the pivots; M_kk to measure them against. Of the
// floating base's coordinates too, which stand before all joints.
struct Articulated {
  int gain;  // V
  int inverse_pivot, pivot, diagonal;
};
Articulated articulated_bodies(Builder& builder);

// The array is zero where M is not positive definite, and the function's status says so.
void guard(Builder& builder, int array);

// v̇ of every coordinate for the forces that the function is given; and summed up to the body's twist, what velocities alone
// cause left out (of the base: its v̇).
struct SolvedRoles {
  int acceleration = -1, twist = -1;
};
SolvedRoles solved_accelerations(Builder& builder);

// M⁻¹ as an array: `array`, or, −1, one that is no output.
int inverse_mass_matrix(Builder& builder, int array = -1);

}  // namespace dalembert::passes
