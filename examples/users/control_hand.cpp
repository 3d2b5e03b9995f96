// A controller: MAHRU's right hand follows a circle, turned as it was, by computed torque in task space.
//
// The arm has seven joints, the waist among them, and the hand's motion six coordinates. Of all joint accelerations that give
// the hand the acceleration a* = a_ref + D (v_ref − J v) + K e, those are taken that are nearest to a spring and a damper
// towards the first posture:
//
//     v̇ = v̇₀ + Jᵀ (J Jᵀ)⁻¹ (a* − J̇ v − J v̇₀),    τ = M v̇ + C v + g.
//
// J and J̇ v are "mixed": along the world's axes, at the hand's origin, so that J v̇ + J̇ v is the acceleration of that origin.
// The arm it drives is simulated by forward dynamics, between ticks of 1 ms in two steps of Runge and Kutta. The hand carries 1
// kg.
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>
#include <dalembert/integrators/rk4.hpp>

#include "controlled_arm/dynamics.hpp"
#include "figures.hpp"
#include "simulated_arm/dynamics.hpp"

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using VectorQ = controlled_arm::VectorQ;
using VectorV = controlled_arm::VectorV;

constexpr double period = 1e-3;  // s
const VectorQ first_posture = (VectorQ() << 0, -0.3, -0.4, 0.2, -1.3, 0.1, 0.2).finished();

// Position, velocity and acceleration of the hand's origin in the world: once around a circle in four seconds, from rest to
// rest.
struct Reference {
  Eigen::Vector3d position, velocity, acceleration;
};
Reference circle(const Eigen::Vector3d& start, double time) {
  constexpr double radius = 0.08, duration = 4, full = 2 * 3.14159265358979;
  const double s = std::min(time / duration, 1.0);
  const double angle = full * s * s * s * (10 + s * (6 * s - 15)), speed = full / duration * 30 * s * s * (1 - s) * (1 - s),
               change = full / (duration * duration) * 60 * s * (1 - s) * (1 - 2 * s);
  const Eigen::Vector3d out(0, std::cos(angle), std::sin(angle)), along(0, -out.z(), out.y());
  return {start + radius * (out - Eigen::Vector3d::UnitY()), radius * speed * along,
          radius * (change * along - speed * speed * out)};
}

class Controller {
 public:
  explicit Controller(double payload) {
    workspace_.payload_right_hand.mass = payload;
    controlled_arm::evaluate(first_posture, VectorV::Zero(), workspace_);
    first_pose_ = controlled_arm::pose_right_hand(workspace_);
  }

  VectorV torques(double time, const VectorQ& q, const VectorV& v) {
    controlled_arm::evaluate(q, v, workspace_);
    const auto J = controlled_arm::jacobian_mixed_right_hand(workspace_);
    const Reference wanted = circle(first_pose_.col(3), time);
    Vector6 acceleration = 400 * error(wanted) - 40 * J * v;
    acceleration.head<3>() += wanted.acceleration + 40 * wanted.velocity;
    const VectorV posture = 25 * (first_posture - q) - 10 * v;
    const Vector6 missing = acceleration - controlled_arm::acceleration_bias_mixed_right_hand(workspace_) - J * posture;
    const VectorV v_dot = posture + J.transpose() * Matrix6(J * J.transpose()).llt().solve(missing);
    controlled_arm::inverse_dynamics(q, v, v_dot, workspace_);
    return controlled_arm::inverse_dynamics(workspace_);
  }

  // How far the hand is from where it should be at the time: m, then rad, world axes. At the state of the last torques.
  Vector6 error_at(double time) const { return error(circle(first_pose_.col(3), time)); }

 private:
  Vector6 error(const Reference& wanted) const {
    const auto pose = controlled_arm::pose_right_hand(workspace_);
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(first_pose_.leftCols<3>() * pose.leftCols<3>().transpose()));
    Vector6 result;
    result << wanted.position - pose.col(3), turn.angle() * turn.axis();
    return result;
  }

  controlled_arm::Workspace workspace_;
  Eigen::Matrix<double, 3, 4> first_pose_;
};

// The arm with its load, as the integrator wants it.
struct Arm {
  simulated_arm::Workspace workspace;
  VectorV torques = VectorV::Zero();

  VectorV acceleration(const VectorQ& q, const VectorV& v) {
    simulated_arm::forward_dynamics(q, v, torques, workspace);
    return simulated_arm::forward_dynamics(workspace);
  }
};

// The largest distance (m) and angle (rad) from the reference over five seconds.
struct Tracking {
  double distance = 0, angle = 0;
};
Tracking track(double payload_told) {
  Arm arm;
  arm.workspace.payload_right_hand.mass = 1;
  Controller controller(payload_told);
  VectorQ q = first_posture;
  VectorV v = VectorV::Zero();
  Tracking worst;
  for (int tick = 0; tick < 5000; ++tick) {
    const double time = tick * period;
    arm.torques = controller.torques(time, q, v);
    const Vector6 error = controller.error_at(time);
    worst.distance = std::max(worst.distance, error.head<3>().norm());
    worst.angle = std::max(worst.angle, error.tail<3>().norm());
    if (!arm.torques.allFinite()) worst.distance = std::nan("");
    for (int step = 0; step < 2; ++step) dalembert::integrators::rk4(arm, period / 2, q, v);
  }
  return worst;
}

}  // namespace

int main() {
  Figures figures;
  const Tracking tracking = track(1), untold = track(0);
  figures.bounded("the hand is off its circle by at most", tracking.distance, 1e-4, "m");
  figures.bounded("and turned by at most", tracking.angle, 2e-3, "rad");
  std::printf("%-58s %9.2e m\n", "where the controller does not know of the load, off by", untold.distance);

  Controller controller(1);
  Arm arm;
  VectorV torques;
  figures.timed("one tick of the controller", [&] { torques = controller.torques(1, first_posture, VectorV::Zero()); });
  figures.timed("one forward dynamics", [&] { torques = arm.acceleration(first_posture, VectorV::Zero()); });
  return figures.exit_status();
}
