// What is constant about a body and the joint above it: the numbers a sweep's graph takes as inputs of kind `parameter`.
#pragma once

#include <optional>
#include <string>

#include "ir/kinematic_tree.hpp"
#include "ir/normal_tree.hpp"

namespace dalembert::passes {

// Frames and moments are those of the normal tree (ir/normal_tree.hpp): kg, m, rad.
enum Parameter : int {
  rotation_p = 0,                            // 9, row by row: the body's frame in the parent's at q = 0
  translation_p = rotation_p + 9,            // 3
  pose_rotation_p = translation_p + 3,       // 9: the same, but that a fixed base's first bodies are frames of reference
  pose_translation_p = pose_rotation_p + 9,  // 3
  turning_p = pose_translation_p + 3,        // the joint's twist per unit of its coordinate: about z …
  sliding_p,                                 // … and along z
  mass_p,
  first_p,                       // 3
  second_p = first_p + 3,        // 6
  half_second_p = second_p + 6,  // 3: half of its diagonal
  half_trace_p = half_second_p + 3,
  armature_p,
  damping_p,
  friction_p,
  half_armature_p,  // of the armature; nothing where no body is
  axis_inertia_p,   // of lines: armature, and what a branch's first body has about its axis where that stands for its moments
  stiffness_p,
  half_stiffness_p,
  rest_p,                                    // where the spring is at rest
  own_coordinate_p,                          // 1; of a joint that is driven by another: 0
  link_rotation_p,                           // 9: the link's axes in the body's frame
  link_translation_p = link_rotation_p + 9,  // 3: the link's origin
  moves_p = link_translation_p + 3,          // 1; where the first body of a joint has all its motion: 0
  first_part_p,                              // 1; of a body behind the first of its joint: 0
  on_base_p,                                 // 1 of what hangs on the base, else 0
  joint_twist_p,  // 6: of a joint whose orientation is a quaternion, at its first body, all its motion
  // And on: one per external wrench, 1 where it acts on the body or beyond it; behind them one per constraint, 1 where its
  // force does, −1 where the opposite does.
  bears_p = joint_twist_p + 6
};

// "rotation_xy", as tables are called, and "kg m^2", empty for a number.
std::string parameter_name(int parameter);
std::string parameter_unit(int parameter);
// Whether it is of inertia: nothing may come from a place that no body takes.
bool is_inertial(int parameter);
// Whether it is a mass, a moment or made of them.
bool is_of_moments(int parameter);
// What such a place must have: of inertia, zero; of the armature, something that can be divided by; nullopt: anything will do.
std::optional<double> value_elsewhere(int parameter);

// Of a body, or of the base (−1). A driven joint's twist is per unit of its driver's coordinate.
double parameter_value(int parameter, const ir::KinematicTree& tree, const ir::NormalTree& normal, int body);
// Of a body that turns: what its moments make it about its joint's axis, per unit of the coordinate squared, kg m².
double inertia_about_axis(const ir::KinematicTree& tree, const ir::NormalTree& normal, int body);

}  // namespace dalembert::passes
