// A simulator: MAHRU in free flight, its base floating, by forward dynamics and a step of Runge and Kutta of 0.5 ms.
//
// Nothing outside acts but gravity, so that two things are known of any motion: with motors that do nothing, energy is kept;
// with any motors, the momentum about the centre of mass is kept, and the linear momentum changes by weight times time. What of
// that is not so is the integrator's error.
#include <cmath>
#include <dalembert/integrators/rk4.hpp>

#include "figures.hpp"
#include "simulated_mahru/dynamics.hpp"

namespace {

using simulated_mahru::nv;
using simulated_mahru::VectorQ;
using simulated_mahru::VectorV;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double step = 5e-4, duration = 1;  // s
constexpr int joints = nv - 6;

// A robot in flight, as the integrator wants it.
struct Flight {
  simulated_mahru::Workspace workspace;
  VectorQ q;
  VectorV v;
  bool motors;

  // Turning, with bent and moving joints.
  explicit Flight(bool with_motors) : motors(with_motors) {
    q << 0, 0, 1, 0, 0, 0, 1, Eigen::Matrix<double, joints, 1>::LinSpaced(-0.4, 0.4);
    v << 0.3, -0.2, 1, 0.8, -0.5, 0.6, Eigen::Matrix<double, joints, 1>::LinSpaced(2, -2);
  }

  // Motors as springs and dampers towards the middle: forces on the base are zero.
  VectorV torques(const VectorQ& at, const VectorV& speed) const {
    VectorV result = VectorV::Zero();
    if (motors) result.tail<joints>() = -5 * at.tail<joints>() - 0.05 * speed.tail<joints>();
    return result;
  }

  VectorV acceleration(const VectorQ& at, const VectorV& speed) {
    simulated_mahru::forward_dynamics(at, speed, torques(at, speed), workspace);
    return simulated_mahru::forward_dynamics(workspace);
  }

  // Linear momentum, then the angular one about the centre of mass: world axes, kg m/s and kg m²/s.
  Vector6 momentum() {
    simulated_mahru::evaluate(q, v, workspace);
    return simulated_mahru::momentum_matrix(workspace) * v;
  }
  double energy() {  // J
    simulated_mahru::evaluate(q, v, workspace);
    return simulated_mahru::kinetic_energy(workspace)(0) + simulated_mahru::potential_energy(workspace)(0);
  }
};

// Relative to the largest: what momentum and energy are off by, at worst, during the flight.
struct Kept {
  double momentum = 0, energy = 0;
};
Kept fly(bool motors) {
  Flight robot(motors);
  const Vector6 first = robot.momentum();
  const double first_energy = robot.energy();
  const double mass = simulated_mahru::momentum_matrix(robot.workspace).leftCols<3>().topRows<3>().norm() / std::sqrt(3.0);
  const int steps = static_cast<int>(duration / step);
  Kept worst;
  for (int i = 1; i <= steps; ++i) {
    dalembert::integrators::rk4(robot, step, robot.q, robot.v);
    if (!robot.workspace.forward_dynamics_status.ok()) return {std::nan(""), std::nan("")};
    Vector6 expected = first;
    expected[2] -= mass * 9.81 * step * i;
    const Vector6 off = robot.momentum() - expected;
    if (!off.allFinite()) return {std::nan(""), std::nan("")};
    worst.momentum = std::max(
        {worst.momentum, off.head<3>().norm() / expected.head<3>().norm(), off.tail<3>().norm() / expected.tail<3>().norm()});
    worst.energy = std::max(worst.energy, std::abs(robot.energy() / first_energy - 1));
  }
  return worst;
}

}  // namespace

int main() {
  Figures figures;
  const Kept passive = fly(false), driven = fly(true);
  figures.bounded("in free flight energy changes by, of itself", passive.energy, 1e-10, "");
  figures.bounded("momentum is off by, of itself", passive.momentum, 1e-10, "");
  figures.bounded("with motors momentum is off by, of itself", driven.momentum, 1e-8, "");
  std::printf("%-58s %9.2e\n", "and energy changes by, which the dampers take", driven.energy);

  Flight robot(true);
  VectorV v_dot;
  figures.timed("one forward dynamics", [&] { v_dot = robot.acceleration(robot.q, robot.v); });
  figures.timed("one step, which asks for four", [&] {
    VectorQ q = robot.q;
    VectorV v = robot.v;
    dalembert::integrators::rk4(robot, step, q, v);
  });
  return figures.exit_status();
}
