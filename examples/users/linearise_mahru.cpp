// A planner's linearisation: MAHRU in flight near a trajectory, its base floating. The state is (δ, v), δ being how far the
// robot is from where it should be, q = q̄ exp(δ), along v's own coordinates: nv numbers, where q has nv + 1 and no orientation
// is singular. The inputs are the motors' torques. Then
//
//     δ̇ = −ad(v̄) δ + δv              ad: of the base's twist; zero for the joints
//     δv̇ = ∂v̇/∂q δ + ∂v̇/∂v δv + M⁻¹ δτ,
//
// which is A and B. What the generated code gives is checked against differences of forward dynamics; A and B against
// differences of one step of the integrator, whose linearisation is exp(h A) to second order where A is taken half way.
#include <Eigen/Core>
#include <cmath>
#include <dalembert/integrators/rk4.hpp>

#include "figures.hpp"
#include "linearised_mahru/dynamics.hpp"

namespace {

using linearised_mahru::nv;
using linearised_mahru::VectorQ;
using linearised_mahru::VectorV;
using MatrixV = Eigen::Matrix<double, nv, nv>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr int motors = nv - 6;
constexpr double step = 1e-3;        // s, of the integrator
constexpr double difference = 1e-5;  // of a coordinate, rate or torque, either way

struct Robot {
  linearised_mahru::Workspace workspace;
  VectorV torques;

  VectorV acceleration(const VectorQ& q, const VectorV& v) {
    linearised_mahru::forward_dynamics(q, v, torques, workspace);
    return linearised_mahru::forward_dynamics(workspace);
  }
};

struct State {
  VectorQ q;
  VectorV v;
};

State moved(const State& state, const VectorV& step_of_q, const VectorV& step_of_v) {
  State result = state;
  dalembert::integrators::move(state.q, step_of_q, result.q);
  result.v += step_of_v;
  return result;
}

State after(Robot& robot, State state, double time) {
  dalembert::integrators::rk4(robot, time, state.q, state.v);
  return state;
}

// (δ, v − v̄) of a state near another one, to first order in δ.
Eigen::Matrix<double, 2 * nv, 1> from(const State& near, const State& state) {
  const Eigen::Quaterniond base(near.q[6], near.q[3], near.q[4], near.q[5]),
      turned(state.q[6], state.q[3], state.q[4], state.q[5]);
  const Eigen::Quaterniond between = base.conjugate() * turned;
  Eigen::Matrix<double, 2 * nv, 1> result;
  result << base.conjugate() * Eigen::Vector3d(state.q.head<3>() - near.q.head<3>()),
      2 * std::copysign(1.0, between.w()) * between.vec(), state.q.tail<motors>() - near.q.tail<motors>(), state.v - near.v;
  return result;
}

// A (2 nv × 2 nv) and B (2 nv × motors) at a state.
struct Linear {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * nv, 2 * nv), B = Eigen::MatrixXd::Zero(2 * nv, motors);
};
void linearise(Robot& robot, const State& state, Linear& linear) {
  linearised_mahru::forward_dynamics(state.q, state.v, robot.torques, robot.workspace);
  linearised_mahru::evaluate(state.q, state.v, robot.workspace);
  linear.A.topLeftCorner<6, 6>() = -dalembert::ad<double>(Vector6(state.v.head<6>()));
  linear.A.topRightCorner<nv, nv>().setIdentity();
  linear.A.bottomLeftCorner<nv, nv>() = linearised_mahru::forward_dynamics_dq(robot.workspace);
  linear.A.bottomRightCorner<nv, nv>() = linearised_mahru::forward_dynamics_dv(robot.workspace);
  linear.B.bottomRows<nv>() = linearised_mahru::inverse_mass_matrix(robot.workspace).rightCols<motors>();
}

// Columns of central differences: `result` of the state and torques with coordinate i moved, of positions, rates, then motors.
template <class Result>
Eigen::MatrixXd differences(Robot& robot, const State& state, Result result) {
  Eigen::MatrixXd columns;
  for (int i = 0; i < 2 * nv + motors; ++i) {
    const auto at = [&](double change) -> Eigen::VectorXd {
      VectorV step_of_q = VectorV::Zero(), step_of_v = VectorV::Zero();
      Robot changed = robot;
      if (i < nv) step_of_q[i] = change;
      else if (i < 2 * nv) step_of_v[i - nv] = change;
      else changed.torques[i - 2 * nv + 6] += change;
      return result(changed, moved(state, step_of_q, step_of_v));
    };
    const Eigen::VectorXd column = (at(difference) - at(-difference)) / (2 * difference);
    if (i == 0) columns.resize(column.size(), 2 * nv + motors);
    columns.col(i) = column;
  }
  return columns;
}

// Its series: a step is short, so that it ends soon.
Eigen::MatrixXd exponential(const Eigen::MatrixXd& matrix) {
  Eigen::MatrixXd term = Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()), sum = term;
  for (int k = 1; term.cwiseAbs().maxCoeff() > 1e-18 && k < 100; ++k) {
    term = Eigen::MatrixXd(matrix * term) / k;
    sum += term;
  }
  return sum;
}

// Largest difference, relative to the largest element; no bound holds for what is not finite.
double relative(const Eigen::MatrixXd& ours, const Eigen::MatrixXd& theirs) {
  if (!ours.allFinite() || !theirs.allFinite()) return std::nan("");
  return (ours - theirs).cwiseAbs().maxCoeff() / theirs.cwiseAbs().maxCoeff();
}

}  // namespace

int main() {
  Robot robot;
  robot.torques << Vector6::Zero(), Eigen::Matrix<double, motors, 1>::LinSpaced(0.1, -0.1);
  State state;
  state.q << 0.1, -0.2, 1, 0.1, -0.3, 0.2, std::sqrt(1 - 0.14), Eigen::Matrix<double, motors, 1>::LinSpaced(-0.5, 0.6);
  state.v << 0.4, -0.3, 0.2, 0.5, -0.7, 0.3, Eigen::Matrix<double, motors, 1>::LinSpaced(0.6, -0.4);

  Figures figures;
  Linear linear;
  linearise(robot, state, linear);
  const Eigen::MatrixXd of_dynamics =
      differences(robot, state, [](Robot& r, const State& s) { return Eigen::VectorXd(r.acceleration(s.q, s.v)); });
  figures.bounded("dv'/dq differs from central differences by",
                  relative(linear.A.bottomLeftCorner<nv, nv>(), of_dynamics.leftCols<nv>()), 1e-7, "of it");
  figures.bounded("dv'/dv", relative(linear.A.bottomRightCorner<nv, nv>(), of_dynamics.middleCols<nv>(nv)), 1e-7, "of it");
  figures.bounded("dv'/dtau", relative(linear.B.bottomRows<nv>(), of_dynamics.rightCols<motors>()), 1e-7, "of it");

  // One step: (A_d, B_d) in the upper rows of exp(h [A B; 0 0]).
  Linear half_way;
  linearise(robot, after(robot, state, step / 2), half_way);
  Eigen::MatrixXd both = Eigen::MatrixXd::Zero(2 * nv + motors, 2 * nv + motors);
  both.topRows<2 * nv>() << step * half_way.A, step * half_way.B;
  const Eigen::MatrixXd discrete = exponential(both).topRows(2 * nv);
  const State next = after(robot, state, step);
  const Eigen::MatrixXd of_step =
      differences(robot, state, [&](Robot& r, const State& s) { return Eigen::VectorXd(from(next, after(r, s, step))); });
  figures.bounded("a step's positions, by A, differ from differences by",
                  relative(discrete.topLeftCorner(nv, 2 * nv), of_step.topLeftCorner(nv, 2 * nv)), 1e-6, "of it");
  figures.bounded("its rates, by A", relative(discrete.bottomLeftCorner(nv, 2 * nv), of_step.bottomLeftCorner(nv, 2 * nv)),
                  1e-5, "of it");
  figures.bounded("its positions, by B", relative(discrete.topRightCorner(nv, motors), of_step.topRightCorner(nv, motors)),
                  5e-4, "of it");
  figures.bounded("its rates, by B", relative(discrete.bottomRightCorner(nv, motors), of_step.bottomRightCorner(nv, motors)),
                  1e-5, "of it");

  figures.timed("A and B at a state", [&] { linearise(robot, state, linear); });
  return figures.exit_status();
}
