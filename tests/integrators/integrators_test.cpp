// Every integrator has the order it claims, against another program's trajectory, and keeps what the motion keeps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "load_robot.hpp"
#include "reference/trajectory.hpp"
#include "states.hpp"
#include "systems.hpp"
#include "trend.hpp"

namespace dalembert::testing {
namespace {

template <class Code>
struct Method {
  using S = System<Code>;
  const char* name;
  int order;
  std::function<void(S&, double, typename S::VectorQ&, typename S::VectorV&)> step;
};

template <class Code>
std::vector<Method<Code>> methods() {
  using S = System<Code>;
  using Q = typename S::VectorQ;
  using V = typename S::VectorV;
  return {
      {"semi-implicit Euler", 1, [](S& s, double h, Q& q, V& v) { integrators::semi_implicit_euler(s, h, q, v); }},
      {"RK4", 4, [](S& s, double h, Q& q, V& v) { integrators::rk4(s, h, q, v); }},
      {"implicit midpoint", 2, [](S& s, double h, Q& q, V& v) { ASSERT_TRUE(integrators::implicit_midpoint(s, h, q, v)); }},
      {"linearly implicit", 1, [](S& s, double h, Q& q, V& v) { integrators::linearly_implicit(s, h, q, v); }},
  };
}

ir::KinematicTree tree_of(const std::string& name, bool floating) {
  for (const TestRobot& robot : test_robots)
    if (robot.name == name) return load_robot(robot, floating);
  throw std::runtime_error("no robot " + name);
}

// Errors of positions and speeds after `seconds` at two steps: halving divides them by 2^order.
template <class Code>
void expect_orders(const std::string& robot, const Eigen::Vector3d& gravity, double seconds) {
  using S = System<Code>;
  const ir::KinematicTree tree = tree_of(robot, S::base > 0);
  ir::Scene scene;
  scene.gravity = gravity;
  const State start = moderate_state(tree, 7);
  const reference::Motion exact = reference::trajectory(tree, scene, {start.q, start.v}, seconds);
  S system;
  for (const Method<Code>& method : methods<Code>()) {
    std::vector<double> errors;
    for (int steps : {100, 200}) {
      typename S::VectorQ q = start.q;
      typename S::VectorV v = start.v;
      for (int i = 0; i < steps; ++i) method.step(system, seconds / steps, q, v);
      errors.push_back(std::max((q - exact.q).cwiseAbs().maxCoeff(), (v - exact.v).cwiseAbs().maxCoeff()));
    }
    EXPECT_NEAR(std::log2(errors[0] / errors[1]), method.order, 0.3)
        << robot << ", " << method.name << ": " << errors[0] << ", " << errors[1];
    EXPECT_LT(errors[1], method.order == 1 ? 0.1 : method.order == 2 ? 1e-3 : 1e-6) << robot << ", " << method.name;
  }
}

TEST(Integrators, HaveTheirOrderOnAPendulumChain) { expect_orders<PendulumChain>("planar_chain_10", {0, 0, -9.81}, 0.1); }

TEST(Integrators, HaveTheirOrderOnMahruInFreeFlight) { expect_orders<FreeMahru>("mahru", {0, 0, 0}, 0.1); }

#ifdef DALEMBERT_WAM
TEST(Integrators, HaveTheirOrderOnWam) { expect_orders<WamArm>("wam", {0, 0, -9.81}, 0.1); }
#endif

// Free flight keeps momentum and, without springs or dampers, energy.
TEST(Integrators, KeepMomentumInFreeFlight) {
  using S = System<FreeMahru>;
  const State start = moderate_state(tree_of("mahru", true), 7);
  S system;
  S::VectorQ q = start.q;
  S::VectorV v = start.v;
  const Eigen::Matrix<double, 6, 1> before = system.momentum(q, v);
  const double energy = system.energy(q, v);
  for (int i = 0; i < 20000; ++i) integrators::rk4(system, 5e-4, q, v);
  EXPECT_LT((system.momentum(q, v) - before).norm(), 1e-9 * before.norm());
  EXPECT_LT(std::abs(system.energy(q, v) - energy), 1e-8 * energy);
  EXPECT_NEAR(q.segment<4>(3).norm(), 1, 4e-16);
}

// Energies along a minute of two pendulums that swing without chaos, J.
std::vector<double> energies(const Method<TwoPendulums>& method, double h) {
  using S = System<TwoPendulums>;
  S system;
  const auto workspace = std::make_unique<two_pendulums::Workspace>();
  S::VectorQ q(std::numbers::pi / 2 + 0.5, 0.3);  // links lie along x and hang so
  S::VectorV v = S::VectorV::Zero();
  std::vector<double> list;
  for (int i = 0; i < std::lround(60 / h); ++i) {
    two_pendulums::evaluate(q, v, *workspace);
    list.push_back(system.energy(q, v) + two_pendulums::potential_energy(*workspace)(0));
    method.step(system, h, q, v);
  }
  return list;
}

// The midpoint rule's energy oscillates and comes back; that of RK4 falls.
TEST(Integrators, MidpointHasNoSecularDriftOfEnergy) {
  for (const Method<TwoPendulums>& method : methods<TwoPendulums>())
    for (const double h : {1e-2, 5e-3, 2.5e-3}) {
      if (method.order < 2) continue;
      const std::vector<double> curve = energies(method, h);
      const auto [smallest, largest] = std::minmax_element(curve.begin(), curve.end());
      const double part = trend(curve) / (*largest - *smallest);
      if (method.order == 2) EXPECT_LT(std::abs(part), 0.01) << h << " s: from " << *smallest << " to " << *largest << " J";
      else EXPECT_LT(part, -0.5) << h << " s: from " << *smallest << " to " << *largest << " J";
    }
}

}  // namespace
}  // namespace dalembert::testing
