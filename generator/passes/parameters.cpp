#include "passes/parameters.hpp"

#include "ir/algorithm.hpp"

namespace dalembert::passes {
namespace {

struct Group {
  int first;
  ir::Shape shape;
  const char *name, *unit;
  bool inertial;
};

constexpr Group groups[] = {
    {rotation_p, ir::Shape::matrix, "rotation", "", false},
    {translation_p, ir::Shape::vector, "translation", "m", false},
    {pose_rotation_p, ir::Shape::matrix, "pose_rotation", "", false},
    {pose_translation_p, ir::Shape::vector, "pose_translation", "m", false},
    {turning_p, ir::Shape::scalar, "turning", "rad per unit of the coordinate", false},
    {sliding_p, ir::Shape::scalar, "sliding", "m per unit of the coordinate", false},
    {mass_p, ir::Shape::scalar, "mass", "kg", true},
    {first_p, ir::Shape::vector, "first", "kg m", true},
    {second_p, ir::Shape::symmetric, "second", "kg m^2", true},
    {half_second_p, ir::Shape::vector, "half_second", "kg m^2", true},
    {half_trace_p, ir::Shape::scalar, "half_trace", "kg m^2", true},
    {armature_p, ir::Shape::scalar, "armature", "kg m^2 or kg", true},
    {damping_p, ir::Shape::scalar, "damping", "N m s/rad or N s/m", true},
    {friction_p, ir::Shape::scalar, "friction", "N m or N", true},
    {half_armature_p, ir::Shape::scalar, "half_armature", "kg m^2 or kg", true},
    {axis_inertia_p, ir::Shape::scalar, "axis_inertia", "kg m^2 or kg", true},
    {stiffness_p, ir::Shape::scalar, "stiffness", "N m/rad or N/m", true},
    {half_stiffness_p, ir::Shape::scalar, "half_stiffness", "N m/rad or N/m", true},
    {rest_p, ir::Shape::scalar, "rest", "rad or m", false},
    {own_coordinate_p, ir::Shape::scalar, "own_coordinate", "", false},
    {link_rotation_p, ir::Shape::matrix, "link_rotation", "", false},
    {link_translation_p, ir::Shape::vector, "link_translation", "m", false},
    {moves_p, ir::Shape::scalar, "moves", "", false},
    {first_part_p, ir::Shape::scalar, "first_part", "", false},
    {on_base_p, ir::Shape::scalar, "on_base", "", false},
    {joint_twist_p, ir::Shape::wrench, "joint_twist", "m/s, rad/s", false},
    {bears_p, ir::Shape::scalar, "bears", "", false},
};

const Group& group_of(int parameter) {
  const Group* found = groups;
  for (const Group& g : groups)
    if (g.first <= parameter) found = &g;
  return *found;
}

double moment_value(int parameter, const ir::Moments& m) {
  constexpr int row[] = {0, 0, 0, 1, 1, 2}, column[] = {0, 1, 2, 1, 2, 2};
  if (parameter == mass_p) return m.mass;
  if (parameter == half_trace_p) return m.half_trace;
  if (parameter >= half_second_p) return 0.5 * m.second(parameter - half_second_p, parameter - half_second_p);
  if (parameter >= second_p) return m.second(row[parameter - second_p], column[parameter - second_p]);
  return m.first[parameter - first_p];
}

double entry(const Eigen::Matrix3d& m, int i) { return m(i / 3, i % 3); }

}  // namespace

std::string parameter_name(int parameter) {
  const Group& g = group_of(parameter);
  const int i = parameter - g.first;
  if (g.first == bears_p) return g.name + ("_" + std::to_string(i));
  const std::string suffix =
      g.first == half_second_p ? ir::component_suffix(ir::Shape::matrix, 4 * i) : ir::component_suffix(g.shape, i);
  return suffix.empty() ? g.name : std::string(g.name) + "_" + suffix;
}

std::string parameter_unit(int parameter) { return group_of(parameter).unit; }

bool is_inertial(int parameter) { return group_of(parameter).inertial; }

bool is_of_moments(int parameter) { return parameter >= mass_p && parameter <= half_trace_p; }

std::optional<double> value_elsewhere(int parameter) {
  if (parameter == armature_p) return 1;  // a pivot of nothing else
  return is_inertial(parameter) ? std::optional(0.0) : std::nullopt;
}

double parameter_value(int parameter, const ir::KinematicTree& tree, const ir::NormalTree& normal, int body) {
  if (parameter >= bears_p) {
    const auto which = static_cast<size_t>(parameter - bears_p), wrenches = tree.pushed.size();
    if (which < wrenches) return tree.is_above(body, tree.pushed[which]) ? 1 : 0;
    const auto [to, back] = tree.held[which - wrenches];
    return (tree.is_above(body, to) ? 1 : 0) - (tree.is_above(body, back) ? 1 : 0);
  }
  const bool of_moments = is_of_moments(parameter);
  if (body < 0) {  // the base's link is the frame of reference
    if (parameter == first_part_p || parameter == moves_p) return 1;
    if (of_moments) return moment_value(parameter, normal.base);
    return parameter >= link_rotation_p && parameter < link_translation_p
               ? entry(Eigen::Matrix3d::Identity(), parameter - link_rotation_p)
               : 0;
  }
  const ir::NormalBody& n = normal.bodies[static_cast<size_t>(body)];
  const ir::Body& joint = tree.bodies[static_cast<size_t>(body)];
  if (of_moments) return moment_value(parameter, n.moments);
  const bool reference = tree.base_coordinates() == 0 && n.parent < 0;
  // Where the pose is a quaternion's it is given at run time (passes/joints/quaternion.hpp).
  const bool of_rotation = parameter < translation_p || (parameter >= pose_rotation_p && parameter < pose_translation_p);
  if (joint.has_quaternion() && parameter < turning_p && !(reference && parameter >= pose_rotation_p) &&
      (of_rotation || joint.displacements() > 0))
    return 0;
  const double per_unit = joint.driven() ? joint.multiplier : 1;
  switch (parameter) {
    case turning_p: return n.turning * per_unit;
    case sliding_p: return n.sliding * per_unit;
    case armature_p:
    case axis_inertia_p: return joint.driven() ? 0 : joint.armature;  // a driven joint's are counted at its driver
    case half_armature_p: return joint.driven() ? 0 : 0.5 * joint.armature;
    case damping_p: return joint.driven() ? 0 : joint.damping;
    case friction_p: return joint.driven() ? 0 : joint.friction;
    case stiffness_p: return joint.spring.k;
    case half_stiffness_p: return 0.5 * joint.spring.k;
    case rest_p: return joint.spring.rest;
    case own_coordinate_p: return joint.driven() ? 0 : 1;
    case moves_p: return joint.of_quaternion() ? 0 : 1;
    case on_base_p: return n.parent < 0 ? 1 : 0;
    case first_part_p: return joint.of_quaternion() && joint.part > 0 ? 0 : 1;
    default: break;
  }
  if (parameter >= joint_twist_p) return 0;
  if (parameter >= link_translation_p) return n.link_translation[parameter - link_translation_p];
  if (parameter >= link_rotation_p) return entry(n.link_rotation, parameter - link_rotation_p);
  if (parameter >= pose_translation_p) return reference ? 0 : n.translation[parameter - pose_translation_p];
  if (parameter >= pose_rotation_p)
    return entry(reference ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : n.rotation, parameter - pose_rotation_p);
  if (parameter >= translation_p) return n.translation[parameter - translation_p];
  return entry(n.rotation, parameter - rotation_p);
}

double inertia_about_axis(const ir::KinematicTree& tree, const ir::NormalTree& normal, int body) {
  const double turning = parameter_value(turning_p, tree, normal, body);
  const Eigen::Matrix3d& second = normal.bodies[static_cast<size_t>(body)].moments.second;
  return turning * turning * (second(0, 0) + second(1, 1));
}

}  // namespace dalembert::passes
