#include "states.hpp"

namespace dalembert::testing {

double Random::uniform(double low, double high) {
  std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  z ^= z >> 31;
  return low + (high - low) * (static_cast<double>(z >> 11) * 0x1p-53);
}

State moderate_state(const ir::KinematicTree& tree, std::uint64_t seed) {
  Random random(seed);
  State state{"moderate " + std::to_string(seed), Eigen::VectorXd(tree.nq()), Eigen::VectorXd(tree.nv())};
  for (double& q : state.q) q = random.uniform(-1, 1);
  for (const int first : tree.quaternions()) state.q.segment<4>(first).normalize();
  const std::vector<int> coordinates = tree.positions();
  for (size_t k = 0; k < tree.bodies.size(); ++k)
    if (!tree.bodies[k].driven() && !tree.bodies[k].of_quaternion())
      state.q[tree.base_positions() + coordinates[k]] *= tree.bodies[k].turns() ? 3 : 0.5;
  for (double& v : state.v) v = random.uniform(-2, 2);
  return state;
}

std::vector<State> extreme_states(const ir::KinematicTree& tree) {
  State rest = moderate_state(tree, 1000), fast = rest, slow = rest, wound = rest, far = rest;
  rest.name = "at rest in zero";
  rest.v.setZero();
  rest.q.setZero();
  if (tree.base_coordinates() > 0) rest.q[6] = 1;
  fast.name = "velocities of 1e6";
  fast.v *= 1e6;
  slow.name = "velocities of 1e-300";
  slow.v *= 1e-300;
  wound.name = "angles of 1e5";
  const std::vector<int> coordinates = tree.coordinates();
  for (size_t k = 0; k < tree.bodies.size(); ++k)
    if (!tree.bodies[k].driven() && tree.bodies[k].turns()) wound.q[tree.base_positions() + coordinates[k]] *= 1e5;
  std::vector<State> states{rest, fast, slow, wound};
  if (tree.base_coordinates() > 0) {
    far.name = "base at 1e9";
    far.q.head<3>() *= 1e9;
    states.push_back(far);
  }
  return states;
}

}  // namespace dalembert::testing
