// A scene against its robot: names looked up, defaults filled in, contradictions refused.
#pragma once

#include "diagnostics.hpp"
#include "frontend/scene_reader.hpp"
#include "ir/robot_description.hpp"
#include "ir/scene.hpp"

namespace dalembert::frontend {

// What `base` means when the user does not say: floating when the file hangs its root on a floating joint; fixed when the root
// link is named "world", or when neither it nor a link welded to it has an inertia; floating otherwise.
ir::Base default_base(const ir::RobotDescription& robot);

// Links that carry a payload, and links whose Jacobian is asked for.
inline constexpr size_t most_links_asked = 1000;
// Functions that the scene names: each is compiled.
inline constexpr size_t most_functions = 100;

// The scene, complete. Throws InputError with every unknown name and contradiction, each with its place and a remedy. Warns
// about what the URDF says and the scene leaves out: mimic relations, damping, friction. Where neither the scene nor a joint of
// the URDF (a floating one, or one on a root `world`) says whether the base moves, a notice says what is taken.
ir::Scene check_scene(const SceneDocument& document, const ir::RobotDescription& robot, Diagnostics& warnings);

}  // namespace dalembert::frontend
