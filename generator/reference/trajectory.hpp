// The motion of a robot left alone, by an integrator that is not ours: what integrators ought to give.
#pragma once

#include <Eigen/Core>
#include <stdexcept>
#include <string>

#include "ir/kinematic_tree.hpp"
#include "ir/scene.hpp"

namespace dalembert::reference {

struct Motion {
  Eigen::VectorXd q, v;  // as everywhere
};

// The motion is too fast or too uneven to be followed.
struct NoTrajectory : std::runtime_error {
  using runtime_error::runtime_error;
};

// Where the robot is after that many seconds from `start` without forces but the scene's gravity, springs, dampers and
// friction. By Boost.Odeint: Runge-Kutta-Fehlberg 7(8) in long double with local errors of 1e-16, on the flat equations (the
// quaternion's rate is ½ q ω), M and the bias being the generic engine's. Costs 13 evaluations a step, of some milliseconds of
// motion each. Throws NoTrajectory when that takes more than a hundred thousand evaluations, or M cannot be solved with.
Motion trajectory(const ir::KinematicTree& tree, const ir::Scene& scene, const Motion& start, double seconds);

// "Boost.Odeint 1.74.0"
std::string trajectory_program();

// Kinetic energy ½ vᵀ M v, and potential energy of gravity and springs, zero where every body's centre of mass is at the
// world's origin and the springs are at rest; J.
double kinetic_energy(const ir::KinematicTree& tree, const ir::Scene& scene, const Motion& at);
double potential_energy(const ir::KinematicTree& tree, const ir::Scene& scene, const Motion& at);

}  // namespace dalembert::reference
