// A planner's linearisation of a robot that stands: MAHRU, both feet welded to the ground. The state is (δ, v) as in
// linearise_mahru.cpp, the inputs are the motors' torques, and v̇ is that of constrained forward dynamics, whose derivatives
// generated code gives:
//
//     δ̇ = −ad(v̄) δ + δv,    δv̇ = ∂v̇/∂q δ + ∂v̇/∂v δv + ∂v̇/∂τ δτ.
//
// A and B are checked against differences where the robot stands still and where it moves; and where it stands still against
// what the feet ask: their rows' accelerations are −kd J v − kp e, so that J ∂v̇/∂q = −kp J, J ∂v̇/∂v = −kd J, J ∂v̇/∂τ = 0. What
// the motors cannot move comes to rest by itself, as s² + kd s + kp has it.
#include <Eigen/Geometry>
#include <cmath>
#include <dalembert/integrators/motion.hpp>

#include "figures.hpp"
#include "linearised_standing/dynamics.hpp"

namespace {

using namespace linearised_standing;
using MatrixV = Eigen::Matrix<double, nv, nv>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr int motors = nv - 6, rows = 12;
constexpr double kp = 400, kd = 40;
constexpr double difference = 1e-5;  // of a coordinate, rate or torque, either way

struct State {
  VectorQ q;
  VectorV v, torques;
};

VectorV acceleration(Workspace& robot, const State& state) {
  standing(state.q, state.v, state.torques, robot);
  return standing_constrained_forward_dynamics(robot);
}

// A (2 nv × 2 nv) and B (2 nv × motors) at a state.
struct Linear {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * nv, 2 * nv), B = Eigen::MatrixXd::Zero(2 * nv, motors);
};
void linearise(Workspace& robot, const State& state, Linear& linear) {
  forward_dynamics(state.q, state.v, state.torques, robot);
  linear.A.topLeftCorner<6, 6>() = -dalembert::ad<double>(Vector6(state.v.head<6>()));
  linear.A.topRightCorner<nv, nv>().setIdentity();
  linear.A.bottomLeftCorner<nv, nv>() = constrained_forward_dynamics_dq(robot);
  linear.A.bottomRightCorner<nv, nv>() = constrained_forward_dynamics_dv(robot);
  linear.B.bottomRows<nv>() = constrained_forward_dynamics_dtau(robot).rightCols<motors>();
}

// Columns of central differences of v̇: by positions, rates, then motors.
Eigen::MatrixXd differences(Workspace& robot, const State& state) {
  Eigen::MatrixXd columns(nv, 2 * nv + motors);
  for (int i = 0; i < 2 * nv + motors; ++i) {
    const auto at = [&](double change) {
      State changed = state;
      VectorV step = VectorV::Zero();
      if (i < nv) step[i] = change;
      else if (i < 2 * nv) changed.v[i - nv] += change;
      else changed.torques[i - 2 * nv + 6] += change;
      dalembert::integrators::move(state.q, step, changed.q);
      return acceleration(robot, changed);
    };
    columns.col(i) = (at(difference) - at(-difference)) / (2 * difference);
  }
  return columns;
}

// Of the largest element; no bound holds for what is not finite.
double largest(const Eigen::MatrixXd& matrix) { return matrix.allFinite() ? matrix.cwiseAbs().maxCoeff() : std::nan(""); }
double relative(const Eigen::MatrixXd& ours, const Eigen::MatrixXd& theirs) { return largest(ours - theirs) / largest(theirs); }

void compare(Workspace& robot, const State& state, Linear& linear, Figures& figures) {
  linearise(robot, state, linear);
  const Eigen::MatrixXd expected = differences(robot, state);
  figures.bounded("  dv'/dq differs from central differences by",
                  relative(linear.A.bottomLeftCorner<nv, nv>(), expected.leftCols<nv>()), 1e-7, "of it");
  figures.bounded("  dv'/dv", relative(linear.A.bottomRightCorner<nv, nv>(), expected.middleCols<nv>(nv)), 1e-7, "of it");
  figures.bounded("  dv'/dtau", relative(linear.B.bottomRows<nv>(), expected.rightCols<motors>()), 1e-7, "of it");
}

}  // namespace

int main() {
  State state{VectorQ::Zero(), VectorV::Zero(), VectorV::Zero()};
  state.q[6] = 1;
  for (const auto& [joint, angle] : {std::pair{Joint::left_hip_pitch, -0.4},
                                     {Joint::left_knee, 0.8},
                                     {Joint::left_ankle_pitch, -0.4},
                                     {Joint::right_hip_pitch, -0.4},
                                     {Joint::right_knee, 0.8},
                                     {Joint::right_ankle_pitch, -0.4}})
    state.q[q_index(joint)] = angle;

  // The feet stay where they are now; the torques are those that hold the robot still.
  Workspace robot;
  evaluate(state.q, state.v, robot);
  const Eigen::Matrix<double, rows, nv> J = constraint_jacobian(robot);
  for (auto [contact, place] :
       {std::pair{&robot.contact_left_foot, pose_left_foot(robot)}, {&robot.contact_right_foot, pose_right_foot(robot)}}) {
    contact->kp = kp, contact->kd = kd;
    Eigen::Map<Eigen::Vector3d>(contact->anchor) = place.col(3);
    Eigen::Map<Eigen::Quaterniond>(contact->anchor + 3) = Eigen::Matrix3d(place.leftCols<3>());
  }
  inverse_dynamics(state.q, state.v, VectorV::Zero(), robot);
  state.torques = constrained_inverse_dynamics(robot);

  Figures figures;
  Linear linear;
  std::printf("standing still\n");
  figures.bounded("  it accelerates by", largest(acceleration(robot, state)), 1e-9, "rad/s^2");
  compare(robot, state, linear, figures);
  const MatrixV dq = constrained_forward_dynamics_dq(robot), dv = constrained_forward_dynamics_dv(robot),
                dtau = constrained_forward_dynamics_dtau(robot);
  figures.bounded("  J dv'/dq is not -kp J by", relative(J * dq, -kp * J), 1e-10, "of it");
  figures.bounded("  J dv'/dv is not -kd J by", relative(J * dv, -kd * J), 1e-10, "of it");
  figures.bounded("  J dv'/dtau is not zero by", largest(J * dtau) / largest(dtau), 1e-10, "of it");
  // dv'/dtau M takes the forbidden out of an acceleration: a projector, whose trace is the number of motions left.
  figures.bounded("  of 31 coordinates the feet leave other than 19 free by",
                  std::abs((dtau * mass_matrix(robot)).trace() - 19), 1e-9, "");

  std::printf("moving\n");
  state.v = 0.5 * VectorV::LinSpaced(1, -1);
  dalembert::integrators::move(state.q, VectorV(0.05 * VectorV::LinSpaced(-1, 1)), state.q);
  compare(robot, state, linear, figures);

  figures.timed("A and B at a state", [&] { linearise(robot, state, linear); });
  figures.timed("one constrained forward dynamics", [&] { state.v += 1e-12 * acceleration(robot, state); });
  return figures.exit_status();
}
