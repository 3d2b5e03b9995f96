// Sweeps that several quantities are made of. Each function adds what it names to the algorithm, once, and tells the roles.
#pragma once

#include <functional>

#include "passes/builder.hpp"

namespace dalembert::passes {

// Whose axes and origin Phases I to III go by. `cheapest`: the base's where it moves, else the first body's of every
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

// A: how the twist changes, gravity taken off, in the frame's axes about its origin; for the accelerations the function is
// given.
int accelerations(Builder& builder, Frame frame = Frame::base);
Twist acceleration_of(SweepBuilder& s, int role);

// What derivatives of inverse dynamics are made of, per joint: Ψ̇, Ψ̇ + Ṡ and Ψ̈ of its twist; and A of every body.
struct AxisMotion {
  int drift, rates, curvature, acceleration;
};
AxisMotion axis_motion(Builder& builder);
// The same of a coordinate of the base, in a sweep of the base alone: Ψ̇ is zero.
struct BaseAxisMotion {
  Twist rates, curvature;
};
BaseAxisMotion base_axis_motion(Builder& builder, SweepBuilder& base, const Twist& unit);

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

// Gravity along the axes of a branch's frame of reference, on a fixed base: the same for all its bodies. Of lines alone, which
// know where that is.
int gravity_in_reference(Builder& builder);

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

// A frame fixed to a body (−1: the base), in the frame of the normal tree.
struct LinkFrame {
  std::string name;  // an identifier
  int body = -1;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};
LinkFrame link_frame(const std::string& link, const ir::KinematicTree& tree, const ir::NormalTree& normal);

// Its axes, one after another, and its origin in the frame of the poses, as roles of the base.
struct LinkPlace {
  int axes, origin;
};
LinkPlace link_place(Builder& builder, const LinkFrame& link, Frame frame);
// The base's axes and origin in the world, as roles of the base.
LinkPlace base_in_world(Builder& builder);
// Three columns from a role of a given body.
Mat3 three_columns(SweepBuilder& s, int body, int role);

// dV: the acceleration of every body where v̇ = 0, about the base's origin; along the base's axes in any case, or the cheapest.
int bias_accelerations(Builder& builder, bool along_base);

// What the scene's wrenches do to the robot: the wrench that they are together on each subtree, along the base's axes about its
// origin. −1: there are none.
int external_wrenches(Builder& builder);
// A generalised force without what the wrenches contribute to it: τ − J·E. base_wrench: what the base's rows of it are, when it
// floats; −1: nobody asks for them.
int less_external(Builder& builder, int torque, int base_wrench = -1);
// How τ changes with q because wrenches keep to the world's axes and do not turn with their bodies: for j above i or i itself,
// dτ_i/dq_j has X_i·ω_j more, dτ_j/dq_i has S_j·Y_i. −1: none does.
struct WorldWrenchRoles {
  int lower = -1;       // X
  int derivative = -1;  // Y
};
WorldWrenchRoles world_wrenches(Builder& builder);
// Y of a coordinate of the base, in a sweep of its own.
Twist world_wrench_derivative(Builder& builder, SweepBuilder& base, const Twist& unit);

// The factorisation M = Lᵀ D L along the tree: L_ki = V_k·J_i for i above k, D the pivots; M_kk to measure them against. Of the
// base's coordinates too, which stand before all joints.
struct Articulated {
  int gain;  // V
  int inverse_pivot, pivot, diagonal;
};
Articulated articulated_bodies(Builder& builder);
// V and J of every coordinate as arrays, 6 × nv, that are no outputs.
struct GainArrays {
  int gain, joint;
};
GainArrays gain_arrays(Builder& builder);

// U and D of M as an array: the output, or one that is none. Makes what the guard goes by.
int mass_matrix_factor(Builder& builder);

// The array is zero where M is not positive definite, and the function's status says so.
void guard(Builder& builder, int array);

// M's factors along the tree, M = U D U': an array of which the half above the diagonal is U, and one that is D.
struct TreeFactors {
  int upper, pivots;
};
TreeFactors tree_factors(Builder& builder);

// τ − C v − g, with what wrenches contribute, of every coordinate.
int unbalanced(Builder& builder);

// v̇ of every coordinate for the forces that the function is given; and summed up to the body's twist, what velocities alone
// cause left out (of the base: its v̇).
struct SolvedRoles {
  int acceleration = -1, twist = -1;
  int free_acceleration = -1;  // D⁻¹ L⁻ᵀ (τ − C v − g) = L v̇
};
SolvedRoles solved_accelerations(Builder& builder);

// M⁻¹ as an array: `array`, or, −1, one that is no output.
int inverse_mass_matrix(Builder& builder, int array = -1);
// M⁻¹ with room, as products take it; made where it is not there yet.
int padded_inverse(Builder& builder);
// to = −inverse efforts; efforts' columns before the first are zero, or what they give is known.
void negative_product(Builder& builder, int inverse, int efforts, int to, int first);

}  // namespace dalembert::passes
