// A legged robot's stance by constrained inverse dynamics: a quadruped of 12 kg on four feet that are points carries its centre
// of mass 5 cm to and fro, once a second, in ticks of 1 ms, its trunk level. Generated code turns accelerations into torques
// and the least forces of the feet that go with them; a simulation whose feet the ground holds must find the same forces.
#include <Eigen/LU>
#include <cmath>
#include <dalembert/integrators/rk4.hpp>

#include "figures.hpp"
#include "standing_quadruped/dynamics.hpp"

namespace {

using namespace standing_quadruped;
using Eigen::Vector3d;
using Feet = Eigen::Matrix<double, 3, 4>;

constexpr double ground_friction = 0.6, tick = 1e-3, duration = 3, pi = 3.141592653589793;

// The robot on its feet, as the integrator wants it.
struct Ground {
  Workspace robot;
  VectorV torques = VectorV::Zero();

  VectorV acceleration(const VectorQ& q, const VectorV& v) {
    forward_dynamics(q, v, torques, robot);
    return constrained_forward_dynamics(robot);
  }
};

// Where the centre of mass shall be, from where it was, with its rates.
struct Reference {
  Vector3d position, velocity, acceleration;
};
Reference sway(double time) {
  const Vector3d half(0.01, 0.02, -0.012);
  const double w = 2 * pi;
  return {half * (1 - std::cos(w * time)), half * w * std::sin(w * time), half * w * w * std::cos(w * time)};
}

struct Controller {
  Workspace robot;
  Vector3d start;  // of the centre of mass
  double mass;

  Controller(const VectorQ& q, const VectorV& v) {
    evaluate(q, v, robot);
    start = center_of_mass(robot);
    mass = momentum_matrix(robot).topLeftCorner<3, 3>().norm() / std::sqrt(3.0);
  }

  // Accelerations that leave the feet at rest, J v̇ + J̇ v = 0, turn the trunk level, and give the centre of mass its own. A
  // leg's three joints follow the trunk: v̇ = T [trunk's v̇; 1].
  VectorV accelerations(const VectorQ& q, const VectorV& v, const Reference& shall) {
    evaluate(q, v, robot);
    const auto J = constraint_jacobian(robot);
    Eigen::Matrix<double, nv, 7> T = Eigen::Matrix<double, nv, 7>::Identity();
    for (int leg = 0; leg < 4; ++leg) {
      Eigen::Matrix<double, 3, 7> of_trunk;
      of_trunk << J.block<3, 6>(3 * leg, 0), constraint_bias(robot).segment<3>(3 * leg);
      T.middleRows<3>(6 + 3 * leg) = -J.block<3, 3>(3 * leg, 6 + 3 * leg).inverse() * of_trunk;
    }

    const auto A = momentum_matrix(robot).topRows<3>();  // of linear momentum
    const Vector3d place = start + shall.position - center_of_mass(robot), speed = shall.velocity - A * v / mass,
                   change = mass * (shall.acceleration + 100 * place + 20 * speed) - momentum_bias(robot).head<3>();
    Eigen::Matrix<double, 7, 1> trunk;
    trunk << 0, 0, 0, -200 * q.segment<3>(3) - 20 * v.segment<3>(3), 1;  // turned by 2 q[3..5] to first order
    const Eigen::Matrix<double, 3, 7> of_momentum = A * T;
    trunk.head<3>() = of_momentum.leftCols<3>().inverse() * (change - of_momentum * trunk);
    return T * trunk;
  }

  Feet feet() const {
    Feet result;
    result << pose_front_left_foot(robot).col(3), pose_front_right_foot(robot).col(3), pose_hind_left_foot(robot).col(3),
        pose_hind_right_foot(robot).col(3);
    return result;
  }
};

// The largest so far; a NaN stays.
void raise(double& worst, double value) {
  if (!(value <= worst) && !std::isnan(worst)) worst = value;
}

}  // namespace

int main() {
  VectorQ q;
  VectorV v = VectorV::Zero(), a;
  q << 0, 0, 0.33, 0, 0, 0, 1, 0, 0.75, -1.5, 0, 0.75, -1.5, 0, 0.75, -1.5, 0, 0.75, -1.5;
  Controller controller(q, v);
  Workspace& robot = controller.robot;
  const Feet places = controller.feet();
  Ground ground;
  Contact* const contacts[] = {&ground.robot.contact_front_left_foot, &ground.robot.contact_front_right_foot,
                               &ground.robot.contact_hind_left_foot, &ground.robot.contact_hind_right_foot};
  for (int foot = 0; foot < 4; ++foot) {  // drawn back to where they stood, against the integrator's drift
    contacts[foot]->kp = 400, contacts[foot]->kd = 40;
    std::copy_n(places.col(foot).data(), 3, contacts[foot]->anchor);
  }

  const Vector3d limits(23.7, 23.7, 35.5);  // of a leg's motors, as in quadruped.urdf, N m
  double base_rows = 0, difference = 0, balance = 0, leans = 0, least = 1e9, share = 0, off = 0, turned = 0, drift = 0;
  for (int i = 0; i < duration / tick; ++i) {
    a = controller.accelerations(q, v, sway(i * tick));
    inverse_dynamics(q, v, a, robot);
    ground.torques = constrained_inverse_dynamics(robot);
    a = ground.acceleration(q, v);

    // What the ground's forces leave of weight and change of momentum.
    const Eigen::Matrix<double, 12, 1> forces = constraint_forces(ground.robot);
    Eigen::Matrix<double, 6, 1> left = momentum_matrix(robot) * a + momentum_bias(robot);
    left[2] += 9.81 * controller.mass;
    const Feet feet = controller.feet();
    for (int foot = 0; foot < 4; ++foot) {
      const Vector3d force = forces.segment<3>(3 * foot), arm = feet.col(foot) - center_of_mass(robot);
      left.head<3>() -= force, left.tail<3>() -= arm.cross(force);
      least = std::fmin(least, force[2]);
      raise(leans, force[2] > 0 ? std::hypot(force[0], force[1]) / force[2] : HUGE_VAL);
      raise(share, ground.torques.segment<3>(6 + 3 * foot).cwiseQuotient(limits).lpNorm<Eigen::Infinity>());
    }
    raise(base_rows, ground.torques.head<6>().norm());
    raise(balance, left.norm());
    raise(difference, (forces - inverse_constraint_forces(robot)).norm());
    raise(off, (controller.start + sway(i * tick).position - center_of_mass(robot)).norm());
    raise(turned, 2 * q.segment<3>(3).norm());
    raise(drift, (feet - places).norm());
    dalembert::integrators::rk4(ground, tick, q, v);
  }

  Figures figures;
  figures.bounded("the base, which has no motor, is moved by", base_rows, 1e-9, "N, N m");
  figures.bounded("the feet's forces are off weight and change of momentum by", balance, 1e-9, "N, N m");
  figures.bounded("they are not what the controller takes for them by", difference, 1e-6, "N");
  figures.bounded("a foot needs, for friction, a coefficient of", leans, ground_friction, "");
  std::printf("%-58s %9.1f N\n", "and presses at the ground by at least", least);
  figures.bounded("a motor gives at most, of its limit", share, 1, "");
  figures.bounded("the centre of mass is off its way by at most", off, 1e-4, "m");
  figures.bounded("the trunk is turned by at most", turned, 1e-3, "rad");
  figures.bounded("the feet have moved by at most", drift, 1e-9, "m");
  figures.timed("accelerations for a tick", [&] { a = controller.accelerations(q, v, sway(0)); });
  figures.timed("their torques and forces", [&] { inverse_dynamics(q, v, a, robot); });
  figures.timed("one forward dynamics on four feet", [&] { a = ground.acceleration(q, v); });
  return figures.exit_status();
}
