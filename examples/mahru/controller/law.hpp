// The passivity-based law of Slotine and Li on generated dynamics:
//
//     v_r = v_d − Λ (q − q_d)     a_r = a_d − Λ (v − v_d)     s = v − v_r
//     τ = M a_r + C v_r + g − K s
//
// With V = ½ sᵀ M s and Ṁ = C + Cᵀ it follows that V̇ = −sᵀ K s: this is why the law wants the matrix C itself and not only C v,
// and why any C will not do. s dies out, and with it q − q_d, at the rate of the slower of Λ and K M⁻¹.
#pragma once

#include <Eigen/Cholesky>

#include "mahru_fixed/dynamics.hpp"
#include "mahru_fixed/self_test.hpp"
#include "mahru_floating/dynamics.hpp"
#include "mahru_floating/self_test.hpp"
#include "types.hpp"

namespace controller {

static_assert(mahru_fixed::joints == joints && mahru_floating::joints == joints);

inline constexpr double position_rate = 20;  // Λ, 1/s: how fast a position error dies out once s is zero
inline constexpr double velocity_rate = 50;  // 1/s: how fast s dies out

// K: the inertia that the joints feel at the starting posture (M, and where the base is free M_jj − M_jb M_bb⁻¹ M_bj), times
// the rate. A full matrix in place of one gain per joint, because K M⁻¹ is then near the rate in every direction: with a
// diagonal K some directions of an arm are ten times slower than others.
using MatrixJ = Eigen::Matrix<double, joints, joints>;

// On the stand: 25 joints, all driven.
class FixedBaseLaw {
 public:
  static constexpr Base base = Base::fixed;
  static constexpr auto& joint_names = mahru_fixed::joint_names;
  static constexpr auto& self_test = mahru_fixed::self_test;

  // As last evaluated. (Stands first because its type is deduced.)
  auto mass_matrix() const noexcept { return mahru_fixed::mass_matrix(workspace_); }

  explicit FixedBaseLaw(const State& start) {
    evaluate(start);
    gains_ = velocity_rate * mass_matrix();
  }
  void evaluate(const State& state) noexcept { mahru_fixed::evaluate(state.q, state.v, workspace_); }

  // N m. Call evaluate() with the same state first.
  void torque(const State& state, const Target& target, VectorJ& torque) const noexcept {
    const VectorJ v_r = target.v - position_rate * (state.q - target.q);
    const VectorJ a_r = target.a - position_rate * (state.v - target.v);
    torque = mahru_fixed::gravity(workspace_);
    torque.noalias() -= gains_ * (state.v - v_r);
    torque.noalias() += mass_matrix() * a_r;
    torque.noalias() += mahru_fixed::coriolis_matrix(workspace_) * v_r;
  }

 private:
  mahru_fixed::Workspace workspace_;
  MatrixJ gains_;
};

// Released, without gravity: nothing drives the base, so its six equations of the law must ask for no force. They are met by
// letting the base's reference velocity be its own (its s is zero) and by solving M_bb a_b = −(M_bj a_j + C_b v_r) for its
// reference acceleration.
class FloatingBaseLaw {
 public:
  static constexpr Base base = Base::floating;
  static constexpr auto& joint_names = mahru_floating::joint_names;
  static constexpr auto& self_test = mahru_floating::self_test;

  // As last evaluated. (Stands first because its type is deduced.)
  auto mass_matrix() const noexcept { return mahru_floating::mass_matrix(workspace_); }

  explicit FloatingBaseLaw(const State& start) {
    evaluate(start);
    const auto M = mass_matrix();
    const Eigen::Matrix<double, 6, joints> M_bj = M.topRightCorner<6, joints>();
    const Eigen::Matrix<double, 6, 6> M_bb = M.topLeftCorner<6, 6>();
    gains_ = velocity_rate * (M.bottomRightCorner<joints, joints>() - M_bj.transpose() * M_bb.llt().solve(M_bj));
  }
  void evaluate(const State& state) noexcept {
    q_ << state.base_position, state.base_rotation.coeffs(), state.q;
    v_ << state.base_linear, state.base_angular, state.v;
    mahru_floating::evaluate(q_, v_, workspace_);
  }

  void torque(const State& state, const Target& target, VectorJ& torque) const noexcept {
    const auto M = mass_matrix();
    mahru_floating::VectorV v_r, a_r;
    v_r << v_.head<6>(), target.v - position_rate * (state.q - target.q);
    a_r.tail<joints>() = target.a - position_rate * (state.v - target.v);
    const mahru_floating::VectorV velocity_terms = mahru_floating::coriolis_matrix(workspace_) * v_r;
    const Eigen::Matrix<double, 6, 1> on_base = M.topRightCorner<6, joints>() * a_r.tail<joints>() + velocity_terms.head<6>();
    a_r.head<6>() = -M.topLeftCorner<6, 6>().llt().solve(on_base);
    torque = velocity_terms.tail<joints>();
    torque.noalias() -= gains_ * (state.v - v_r.tail<joints>());
    torque.noalias() += M.bottomRows<joints>() * a_r;
  }

  // Momentum by the generated M: its base rows times v are linear and angular momentum about the base's origin, in base axes.
  struct Momentum {
    Eigen::Vector3d linear, angular;  // kg m/s and kg m²/s about the world's origin, world axes
  };
  Momentum momentum(const State& state) const noexcept {
    const Eigen::Matrix<double, 6, 1> h = mass_matrix().topRows<6>() * v_;
    const Eigen::Vector3d linear = state.base_rotation * h.head<3>();
    return {linear, state.base_rotation * h.tail<3>() + state.base_position.cross(linear)};
  }

 private:
  mahru_floating::Workspace workspace_;
  mahru_floating::VectorQ q_;
  mahru_floating::VectorV v_;
  MatrixJ gains_;
};

}  // namespace controller
