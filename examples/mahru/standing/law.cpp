#include "law.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>

namespace standing {
namespace {

using mahru_on_feet::Joint;

// Feedback, 1/s² and 1/s.
constexpr double com_kp = 100, com_kd = 20;
constexpr double foot_kp = 400, foot_kd = 40;  // in the air
constexpr double sole_kd = 20;                 // on the ground, where the ground keeps the place
constexpr double posture_kp = 100, posture_kd = 20;
constexpr double angular_momentum_kd = 5;

// Weights of the tasks. Of 1 for 1 rad/s² of an arm's joint.
constexpr double linear_weight = 1;      // per N²: 65 kg at 0.1 m/s² weigh 42
constexpr double angular_weight = 1e-3;  // per (N m)²
constexpr double pelvis_weight = 10;     // per (rad/s²)²
constexpr double leg_weight = 1e-2;      // their joints follow from feet, pelvis and centre of mass
constexpr double base_linear_weight = 1e-3;
constexpr double force_weight = 1e-5;   // per N²
constexpr double moment_weight = 4e-3;  // per (N m)²: 1 N m as 20 N, which keeps the centres of pressure near the middle

Eigen::Matrix3d cross(const Vector3d& r) {
  Eigen::Matrix3d m;
  m << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
  return m;
}

// The turning that leads back to the world's axes, rad; along the world's axes and the turned ones it is the same.
Vector3d turn_back(const Eigen::Matrix3d& r) {
  const Eigen::AngleAxisd turn(r.transpose());
  return turn.angle() * turn.axis();
}

}  // namespace

Law::Law(const State& start, const VectorJ& limits, const Beliefs& beliefs)
    : limits_(limits),
      // The pyramid inside of the round cone.
      sole_(sole_constraints(beliefs.friction / std::sqrt(2.0), sole_x - beliefs.sole_margin, sole_y - beliefs.sole_margin)),
      least_load_(beliefs.least_load) {
  evaluate(start);
  posture_ = q_;
  most_load_ = 1.5 * 9.81 * mass();

  weights_.head<3>().setConstant(base_linear_weight);
  weights_.segment<3>(3).setConstant(pelvis_weight);
  weights_.tail<joints>().setOnes();
  for (const Joint joint : {Joint::left_hip_yaw, Joint::left_hip_roll, Joint::left_hip_pitch, Joint::left_knee,
                            Joint::left_ankle_pitch, Joint::left_ankle_roll, Joint::right_hip_yaw, Joint::right_hip_roll,
                            Joint::right_hip_pitch, Joint::right_knee, Joint::right_ankle_pitch, Joint::right_ankle_roll})
    weights_[v_index(joint)] = leg_weight;
  rate_weights_ << Vector3d::Constant(linear_weight), Vector3d::Constant(angular_weight);

  // What of the program is the same at all times: soles, and which rows there are.
  constexpr double none = std::numeric_limits<double>::infinity();
  qp_.A.setZero();
  qp_.upper.setConstant(none);
  for (const Side side : sides) {
    const int row = side * (sole_rows + 1);
    qp_.A.block<sole_rows, 6>(row, 6 * side) = sole_;
    qp_.A(row + sole_rows, 6 * side + 2) = 1;
  }
}

Eigen::Matrix<double, 3, 4> Law::sole_pose(Side side) const noexcept {
  return side == left ? Eigen::Matrix<double, 3, 4>(mahru_on_feet::pose_left_sole(robot_))
                      : Eigen::Matrix<double, 3, 4>(mahru_on_feet::pose_right_sole(robot_));
}

void Law::evaluate(const State& state) noexcept {
  q_ << state.base_position, state.base_rotation.coeffs(), state.q;
  v_ << state.base_linear, state.base_angular, state.v;
  mahru_on_feet::evaluate(q_, v_, robot_);
}

void Law::torque(const Target& target, VectorJ& torque) noexcept {
  tasks(target);
  program(target);
  torque = tau0_;
  torque.noalias() += T_ * forces_;
  if (gave_way_) torque = torque.cwiseMax(-limits_).cwiseMin(limits_);
}

// Feet, momentum and posture: v̇ = v0 + P B F.
void Law::tasks(const Target& target) noexcept {
  J_.topRows<6>() = mahru_on_feet::jacobian_mixed_left_sole(robot_);
  J_.bottomRows<6>() = mahru_on_feet::jacobian_mixed_right_sole(robot_);
  const auto A = mahru_on_feet::momentum_matrix(robot_);
  G_ << J_, A;

  Eigen::Matrix<double, 18, 1> rate;  // of G v̇, at F = 0
  rate << -mahru_on_feet::acceleration_bias_mixed_left_sole(robot_), -mahru_on_feet::acceleration_bias_mixed_right_sole(robot_),
      -mahru_on_feet::momentum_bias(robot_);
  rate[14] -= 9.81 * mass();
  const Vector12 soles = J_ * v_;
  const Vector3d com = center_of_mass();
  turn_.setZero(), B_.setZero();
  for (const Side side : sides) {
    const FootTarget& foot = target.foot[side];
    const auto pose = sole_pose(side);
    const Eigen::Matrix3d r = pose.leftCols<3>();
    const Vector3d p = pose.col(3);
    Eigen::Ref<Vector6> wanted = rate.segment<6>(6 * side);
    if (foot.load > 0) {
      wanted -= sole_kd * soles.segment<6>(6 * side);
    } else {
      wanted.head<3>() += foot.a + foot_kp * (foot.p - p) + foot_kd * (foot.v - soles.segment<3>(6 * side));
      wanted.tail<3>() += foot_kp * turn_back(r) - foot_kd * soles.segment<3>(6 * side + 3);
      continue;  // nothing depends on its wrench, which is therefore zero
    }
    turn_.block<3, 3>(6 * side, 6 * side) = r;
    turn_.block<3, 3>(6 * side + 3, 6 * side + 3) = r;
    B_.block<3, 3>(0, 6 * side) = r;
    B_.block<3, 3>(3, 6 * side).noalias() = cross(p - com) * r;
    B_.block<3, 3>(3, 6 * side + 3) = r;
  }

  const Vector6 h = momentum();
  rate_wanted_.head<3>() =
      mass() * (target.com_a + com_kp * (target.com - com) + com_kd * (target.com_v - h.head<3>() / mass()));
  rate_wanted_.tail<3>() = -angular_momentum_kd * h.tail<3>();

  const Eigen::Matrix3d pelvis = Eigen::Quaterniond(q_.segment<4>(3)).toRotationMatrix();
  wanted_.head<3>().setZero();
  wanted_.segment<3>(3) = posture_kp * turn_back(pelvis) - posture_kd * v_.segment<3>(3);
  wanted_.tail<joints>() = posture_kp * (posture_ - q_).tail<joints>() - posture_kd * v_.tail<joints>();

  // The nearest v̇ by the weights W: wanted + W⁻¹ Gᵀ (G W⁻¹ Gᵀ)⁻¹ (rate − G wanted).
  Eigen::Matrix<double, nv, 18> right = weights_.cwiseInverse().asDiagonal() * G_.transpose();
  Eigen::Matrix<double, 18, 18> S;
  S.noalias() = G_ * right;
  const Eigen::LLT<Eigen::Matrix<double, 18, 18>> factor(S);
  rate.noalias() -= G_ * wanted_;
  Eigen::Matrix<double, 18, 7> columns;  // the last six of (G W⁻¹ Gᵀ)⁻¹, and it times the rate
  columns << Eigen::Matrix<double, 12, 6>::Zero(), rate.head<12>(), Eigen::Matrix<double, 6, 6>::Identity(), rate.tail<6>();
  factor.solveInPlace(columns);
  P_.noalias() = right * columns.leftCols<6>();
  v0_ = wanted_;
  v0_.noalias() += right * columns.col(6);
}

void Law::program(const Target& target) noexcept {
  const auto M = mahru_on_feet::mass_matrix(robot_);
  const auto M_j = M.bottomRows<joints>();
  const Eigen::Matrix<double, joints, 6> MP = M_j * P_;
  tau0_ = mahru_on_feet::bias(robot_).tail<joints>();
  tau0_.noalias() += M_j * v0_;
  T_.noalias() = MP * B_;
  T_.noalias() -= J_.rightCols<joints>().transpose() * turn_;

  // ‖ḣ − wanted‖² + ‖v̇ − wanted‖²_W in terms of ḣ, then of F.
  Vector6 h0;  // ḣ at F = 0
  h0 << 0, 0, -9.81 * mass(), 0, 0, 0;
  const Eigen::Matrix<double, nv, 6> WP = weights_.asDiagonal() * P_;
  Eigen::Matrix<double, 6, 6> of_rate;
  of_rate.noalias() = WP.transpose() * P_;
  of_rate.diagonal() += rate_weights_;
  const Vector6 slope = rate_weights_.cwiseProduct(h0 - rate_wanted_) + WP.transpose() * (v0_ - wanted_);
  const Eigen::Matrix<double, 6, 12> of_rate_B = of_rate * B_;
  qp_.H.noalias() = B_.transpose() * of_rate_B;
  qp_.g.noalias() = B_.transpose() * slope;
  for (int i = 0; i < 12; ++i) qp_.H(i, i) += i % 6 < 3 ? force_weight : moment_weight;

  for (const Side side : sides) {
    const int row = side * (sole_rows + 1);
    const double load = target.foot[side].load;
    qp_.lower.segment<sole_rows>(row).setZero();
    qp_.lower[row + sole_rows] = least_load_ * load;
    qp_.upper[row + sole_rows] = most_load_ * load;
  }
  constexpr int torques = 2 * (sole_rows + 1);
  qp_.A.bottomRows<joints>() = T_;
  qp_.lower.tail<joints>() = -limits_ - tau0_;
  qp_.upper.tail<joints>() = limits_ - tau0_;

  status_ = qp_.solve();
  gave_way_ = status_ != QpStatus::solved;
  if (gave_way_) {  // once more, torques without a limit
    constexpr double none = std::numeric_limits<double>::infinity();
    qp_.lower.segment<joints>(torques).setConstant(-none);
    qp_.upper.segment<joints>(torques).setConstant(none);
    if (qp_.solve() == QpStatus::solved) forces_ = qp_.x;
  } else {
    forces_ = qp_.x;
  }
}

}  // namespace standing
