// Deterministic states for tests: moderate ones, and ones that hurt.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "ir/kinematic_tree.hpp"

namespace dalembert::testing {

// splitmix64, and our own mapping to reals: the same numbers with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double uniform(double low, double high);

 private:
  std::uint64_t state_;
};

// Layouts of q and v as in design: Pinocchio's free-flyer. The quaternion is of unit length to rounding.
struct State {
  std::string name;
  Eigen::VectorXd q, v;
};

// Joint positions within ±3 rad (±0.5 m), velocities within ±2, base anywhere within 1 m.
State moderate_state(const ir::KinematicTree& tree, std::uint64_t seed);

// Rest at zero, velocities of 1e6 and of 1e-300, angles of 1e5 rad, a base 1e9 m away.
std::vector<State> extreme_states(const ir::KinematicTree& tree);

}  // namespace dalembert::testing
