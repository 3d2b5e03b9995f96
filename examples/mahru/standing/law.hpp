// A whole-body law on generated dynamics: one quadratic program of twelve unknowns per tick.
//
// The unknowns F are forces and moments at the two soles. Everything else follows from them:
//
//     ḣ  = B F + (m g, 0)                       rate of the momentum (centroidal): what the ground and the weight exert
//     v̇  = v̇₀ + P ḣ                             of all v̇ with J v̇ + J̇ v = feet's wanted acceleration and A v̇ + Ȧ v = ḣ the one
//                                               nearest, by the weights W, to what the posture wants
//     τ  = M_j v̇ + (C v + g)_j − J_jᵀ F         the joints' rows of the equations of motion; the base's are A v̇ + Ȧ v = ḣ
//
// and the program is
//
//     least  w_l ‖ḣ_l − wanted‖² + w_a ‖ḣ_a − wanted‖² + ‖v̇ − wanted‖²_W + small ‖F‖²
//     with   F inside friction cones and soles, |τ| ≤ limits.
//
// So feet and equations of motion hold exactly, limits hold exactly, and momentum and posture are met as well as these allow: a
// push that asks for a centre of pressure outside of the soles is taken up by turning the trunk and the arms.
#pragma once

#include "mahru_on_feet/dynamics.hpp"
#include "qp.hpp"
#include "sole.hpp"
#include "types.hpp"

namespace standing {

static_assert(mahru_on_feet::joints == joints);
inline constexpr int nv = mahru_on_feet::nv;

// What the law takes the world for. Friction and soles are less than what is there, for a margin.
struct Beliefs {
  double friction = 0.5;
  double sole_margin = 0.01;  // m, of the centre of pressure to the sole's edges
  double least_load = 10;     // N, on a foot that stands
};

class Law {
 public:
  // start: where posture, momentum and feet are those wanted. limits: torques, N m.
  Law(const State& start, const VectorJ& limits, const Beliefs& beliefs);

  void evaluate(const State& state) noexcept;
  // The joints' torques, N m. Call evaluate() first.
  void torque(const Target& target, VectorJ& torque) noexcept;

  // Of the last call.
  const Vector12& forces() const noexcept { return forces_; }  // left sole, right sole, along the sole's axes: N, N m
  Vector3d center_of_mass() const noexcept { return mahru_on_feet::center_of_mass(robot_); }
  Vector6 momentum() const noexcept { return mahru_on_feet::momentum_matrix(robot_) * v_; }  // linear, angular about it, world
  Eigen::Matrix<double, 3, 4> sole_pose(Side side) const noexcept;
  double mass() const noexcept { return mahru_on_feet::mass_matrix(robot_)(0, 0); }
  QpStatus status() const noexcept { return status_; }
  int steps() const noexcept { return qp_.steps; }
  bool gave_way() const noexcept { return gave_way_; }  // no F kept the torques inside the limits: they were cut off there

 private:
  static constexpr int rows = 2 * (sole_rows + 1) + joints;

  void tasks(const Target& target) noexcept;
  void program(const Target& target) noexcept;

  mahru_on_feet::Workspace robot_;
  mahru_on_feet::VectorQ q_, posture_;
  mahru_on_feet::VectorV v_, weights_;
  VectorJ limits_;
  double most_load_;

  // Tasks.
  Eigen::Matrix<double, 12, nv> J_;  // of both soles, along the world's axes
  Eigen::Matrix<double, 18, nv> G_;  // J and A
  Eigen::Matrix<double, nv, 6> P_;
  Eigen::Matrix<double, 6, 12> B_;
  Vector6 rate_wanted_, rate_weights_;
  mahru_on_feet::VectorV wanted_, v0_;  // v0: v̇ at F = 0
  Eigen::Matrix<double, 12, 12> turn_;  // wrenches: sole's axes → world's

  // The program.
  Qp<12, rows> qp_;
  Eigen::Matrix<double, sole_rows, 6> sole_;
  double least_load_;
  Eigen::Matrix<double, joints, 12> T_;  // τ = τ₀ + T F
  VectorJ tau0_;
  Vector12 forces_ = Vector12::Zero();
  QpStatus status_ = QpStatus::solved;
  bool gave_way_ = false;
};

}  // namespace standing
