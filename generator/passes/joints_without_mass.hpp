// What moves no mass: where M is singular and has no inverse.
#pragma once

#include <string>
#include <vector>

#include "diagnostics.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/robot_description.hpp"
#include "ir/scene.hpp"

namespace dalembert::passes {

// Bodies whose joint has a coordinate of its own that moves neither mass nor, where it turns something, rotational inertia, and
// has no armature: M's row of it is zero, and g's element. A payload given at run time counts as mass. In the tree's order.
// M, C, g and the bias are defined all the same; whoever needs an inverse of M refuses a robot with such joints.
std::vector<int> joints_without_mass(const ir::KinematicTree& tree, const ir::Scene& scene);

// Whether all of M would be zero: nothing that moves has a mass or inertia, no joint an armature.
bool moves_no_mass(const ir::KinematicTree& tree, const ir::Scene& scene);

// The body's joint as its user knows it: by the URDF's name, in quotation marks.
std::string in_words(const ir::Body& body);

// The scene with all joints_without_mass locked: at zero, or where the mimic relation to such a joint puts them; an elastic
// joint whose spring moves nothing is rigid. Warns with their names.
ir::Scene with_massless_locked(const ir::RobotDescription& robot, const ir::KinematicTree& tree, ir::Scene scene,
                               Diagnostics& warnings);

// Throws InputError when the scene asks for a quantity that needs a mass (all but wrench_influence and those of links), or a
// centre of mass, and the robot has none.
void check_mass(const ir::RobotDescription& robot, const ir::KinematicTree& tree, const ir::Scene& scene);

}  // namespace dalembert::passes
