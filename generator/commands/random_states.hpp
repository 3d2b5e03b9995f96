// Random states of a robot, for comparing and timing.
#pragma once

#include <vector>

#include "commands/state_file.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/scene.hpp"

namespace dalembert {

// Uniform in [-π, π] rad for angles, [-0.5, 0.5] m for slides, [-2, 2] for velocities (rad/s, m/s) and for accelerations or
// forces, [-1, 1] m for the base's position; its orientation a unit quaternion. The same states on every system and in
// every run.
std::vector<State> random_states(const ir::KinematicTree& tree, int count);

// How the scene's constraints may act: each with one in two, whether or not it gives way, restitution and weights between 0
// and 1. Another draw for each number.
ir::Acting random_acting(const ir::Scene& scene, unsigned number);

// What the scene's robot may carry: compact payloads, up to as heavy as a link is; and where gravity is given at run time, one
// of 5 to 12 m/s² in any direction. Another draw for each number.
ir::Loading random_loading(const ir::KinematicTree& tree, const ir::Scene& scene, unsigned number);

}  // namespace dalembert
