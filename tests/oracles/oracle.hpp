// What an independent program says about a robot, in this project's conventions.
//
// An oracle reads the URDF itself and shares no code with the compiler or its front end: only the order of the joints (by
// name) and the conventions of q and v (docs/conventions.md) are given to it. Floating base: q = [position, quaternion
// x y z w, joints], v = [base twist in base axes, linear first; joint rates].
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace dalembert::oracle {

enum class Base { fixed, floating };

struct Dynamics {
  Eigen::MatrixXd mass_matrix;           // nv × nv
  Eigen::VectorXd coriolis;              // C v, nv (none of the oracles knows C itself)
  Eigen::VectorXd gravity;               // g, nv
  Eigen::VectorXd bias;                  // C v + g, nv
  Eigen::Matrix<double, 6, 1> momentum;  // whole robot's, base axes, about the base's origin; zero when the base is fixed
};

// What follows from a state and an acceleration or effort, nv each, while something pushes: solved by ways of the oracle's own.
struct Response {
  Eigen::VectorXd inverse_dynamics;     // τ(q, v, v̇, wrench), nv
  Eigen::VectorXd forward_dynamics;     // v̇(q, v, τ, wrench), nv
  Eigen::MatrixXd inverse_mass_matrix;  // M⁻¹, nv × nv
};

// A state and what is to be answered for it: v as in v̇ = rates of its entries, τ its dual; the wrench on the last joint's link
// at its origin, along the world's axes, force first.
struct Question {
  Eigen::VectorXd q, v, v_dot, tau;
  Eigen::Matrix<double, 6, 1> wrench;
};

// Of all that moves, in world axes; and of the last joint's link.
struct WholeRobot {
  double kinetic_energy = 0, potential_energy = 0;  // J
  Eigen::Vector3d center_of_mass;                   // m
  Eigen::MatrixXd center_of_mass_jacobian;          // 3 × nv
  Eigen::Matrix<double, 6, 1> momentum;             // about the centre of mass, linear first
  Eigen::Matrix<double, 3, 4> link_pose;            // axes and origin
  Eigen::MatrixXd link_jacobian;                    // 6 × nv, world axes, at the link's origin
};

struct Request {
  std::string urdf;  // path of the file
  Base base = Base::floating;
  std::vector<std::string> joints;       // moving joints in our order
  Eigen::Vector3d gravity{0, 0, -9.81};  // m/s², world axes
};

}  // namespace dalembert::oracle
