// The equations of the explicit formulation, body by body, on symbolic scalars.
//
// Phases I to III (Shin, Park and Park 2016) with everything along the reference frame's axes and about its origin: the
// base's frame where it moves, else the frame of the first body of each branch. Transforms of Phase II then disappear
// and accumulation is a plain sum. Velocities are absolute. Gravity and bias run in body axes, where they are cheapest.
//
// Notation: R, p orientation and origin of a body's frame; J = [Jv; Jw] the joint's twist at the reference origin; [u; w] the
// body's twist; m, h, S the moments of mass, t the half trace; P momentum, D the lower right block of the bias matrix.
#pragma once

#include "passes/symbolic.hpp"

namespace dalembert::passes {

// What is constant about a joint and its body. In a loop these stand for columns of a table.
struct BodyConstants {
  Mat3 rotation;  // in the parent's frame at q = 0
  Vec3 translation;
  Sym turning, sliding;  // the joint's twist per unit of its coordinate, about z and along z
  Sym mass;
  Vec3 first;
  Sym6 second;
  Vec3 half_second;  // half of its diagonal
  Sym half_trace;
};

struct JointPosition {
  Sym sine, cosine;  // of the angle; 0 and 1 of a joint that does not turn
  Sym displacement;  // along the axis; 0 of a joint that does not slide
};

struct Pose {
  Mat3 rotation;
  Vec3 position;
};

struct Twist {
  Vec3 linear, angular;
};

struct Sums {  // Phase II: added up over a subtree
  Vec3 first;
  Sym6 second;
  Vec3 momentum;
  Mat3 bias;  // D
};

struct JointForces {
  Twist inertia;    // F = A* J
  Twist bias;       // G = A* J̇ + B* J
  Vec3 transposed;  // H = [0; P × Jv + Dᵀ Jw], its angular part
};

// Axes, turned about their z by the joint: R Rz(q).
Mat3 turned(const Mat3& axes, const JointPosition& q);
// Phase I (eq. 20): ⁰Ad_k. R = R_p R_k Rz(q), p = p_p + R_p p_k, slid along z by a joint that slides.
Pose pose(const Pose& parent, const BodyConstants& body, const JointPosition& q);
// The parent's from the body's: R_p = R Rz(q)ᵀ R_kᵀ.
Pose pose_of_parent(const Pose& pose, const BodyConstants& body, const JointPosition& q);
// Phase I: J = ⁰Ad_k E_k = [p × z; z] where it turns, [z; 0] where it slides.
Twist joint_twist(const Pose& pose, const BodyConstants& body);
// Phase I: V = V_p + J q̇.
Twist body_twist(const Twist& parent, const Twist& joint, Sym rate);
// J̇ = ad(V) J = [w × Jv + u × Jw; w × Jw]; V may be the parent's or the body's own, ad(J) J being zero.
Twist joint_twist_rate(const Twist& body, const Twist& joint);

// Phase II (eq. 12, 13) of one body: its moments at the reference origin, its momentum and bias.
// Without the half trace (t = 0) D makes C the one of Christoffel symbols (Echeandia and Wensing 2021).
// x = R h + m p, S = R S_k Rᵀ + R h pᵀ + p (R h)ᵀ + m p pᵀ, P = m u + w × x, D = −[w](S + t 1) − u xᵀ + (x·u) 1.
Sums moments(const Pose& pose, const BodyConstants& body);
void add_velocity(Sums& sums, const Twist& twist, Sym mass, Sym half_trace);
Sums operator+(const Sums& a, const Sums& b);  // eq. 29, 30

// A* [v; w] with A* given by m, h, S.
Twist apply_inertia(Sym mass, const Sums& sums, const Twist& twist);
// B* [v; w] = [−P × w; D w]
Twist apply_bias(const Sums& sums, const Twist& twist);
Vec3 apply_bias_transposed(const Sums& sums, const Twist& joint);

// Phase III (eq. 31–39).
Sym element(const Twist& wrench, const Twist& twist);  // F·J

// Body axes: Rᵀ v and R f across a joint.
Vec3 to_child(const BodyConstants& body, const JointPosition& q, const Vec3& v);
Vec3 to_parent(const BodyConstants& body, const JointPosition& q, const Vec3& f);

// The body's state in recursive Newton-Euler, in its own axes: angular velocity, angular acceleration and the acceleration of
// the frame's origin (gravity as an upward acceleration of the base).
struct Motion {
  Vec3 angular, angular_acceleration, acceleration;
};
struct Force {
  Vec3 force, torque;  // on the body, torque about its frame's origin
};
// u, w of the body's frame along its own axes.
Twist body_velocity(const Twist& parent, const BodyConstants& body, const JointPosition& q, Sym rate);
Motion propagate(const Motion& parent, const BodyConstants& body, const JointPosition& q, Sym rate);
// The joint's motion along the body's axes, which stand still in it: of one axis, and of any.
Twist joint_motion(const BodyConstants& body, Sym rate);
Motion propagate(const Motion& parent, const BodyConstants& body, const JointPosition& q, const Twist& joint);
// Adds the joint's own acceleration.
void accelerate(Motion& motion, const BodyConstants& body, Sym acceleration);
Force body_force(const Motion& motion, const BodyConstants& body);

}  // namespace dalembert::passes
