// Robots to integrate: generated dynamics, with springs and dampers in the joints.
#pragma once

#include <Eigen/Cholesky>
#include <dalembert/integrators/implicit_midpoint.hpp>
#include <dalembert/integrators/linearly_implicit.hpp>
#include <dalembert/integrators/rk4.hpp>
#include <dalembert/integrators/semi_implicit_euler.hpp>

#include "free_mahru/dynamics.hpp"
#include "pendulum_chain/dynamics.hpp"
#include "two_pendulums/dynamics.hpp"
#ifdef DALEMBERT_WAM
#include "wam_arm/dynamics.hpp"
#endif

namespace dalembert::testing {

// The generated code of one namespace as a type.
#define DALEMBERT_SYSTEM_CODE(Name, space)                                                                               \
  struct Name {                                                                                                          \
    using VectorQ = space::VectorQ;                                                                                      \
    using VectorV = space::VectorV;                                                                                      \
    using Workspace = space::Workspace;                                                                                  \
    static void evaluate(const VectorQ& q, const VectorV& v, Workspace& workspace) { space::evaluate(q, v, workspace); } \
    static auto mass(const Workspace& workspace) { return space::mass_matrix(workspace); }                               \
    static auto coriolis(const Workspace& workspace) { return space::coriolis_matrix(workspace); }                       \
    static auto bias(const Workspace& workspace) { return space::bias(workspace); }                                      \
  };
DALEMBERT_SYSTEM_CODE(FreeMahru, free_mahru)
DALEMBERT_SYSTEM_CODE(PendulumChain, pendulum_chain)
DALEMBERT_SYSTEM_CODE(TwoPendulums, two_pendulums)
#ifdef DALEMBERT_WAM
DALEMBERT_SYSTEM_CODE(WamArm, wam_arm)
#endif
#undef DALEMBERT_SYSTEM_CODE

// M⁻¹ f: for all systems one instance of Eigen's factors, of matrices that have room for any of them and allocate nothing.
using AnySize = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 32, 32>;
inline Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 32, 1> solved(
    const AnySize& mass, const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 32, 1>& force) {
  return Eigen::LDLT<AnySize>(mass).solve(force);
}

template <class Code>
class System {
 public:
  using VectorQ = typename Code::VectorQ;
  using VectorV = typename Code::VectorV;
  static constexpr int nq = VectorQ::RowsAtCompileTime, nv = VectorV::RowsAtCompileTime, base = nq == nv ? 0 : 6;
  using Matrix = Eigen::Matrix<double, nv, nv>;

  // Of the joints; a base has neither. N m/rad towards zero, N m s/rad.
  VectorV stiffness = VectorV::Zero(), damping = VectorV::Zero();
  VectorV effort = VectorV::Zero();  // held, N m

  VectorV acceleration(const VectorQ& q, const VectorV& v) {
    Code::evaluate(q, v, workspace_);
    return VectorV(solved(Code::mass(workspace_), force(q, v)));
  }

  integrators::Linearised<double, nv> linearised(const VectorQ& q, const VectorV& v) {
    Code::evaluate(q, v, workspace_);
    integrators::Linearised<double, nv> near;
    near.mass = Code::mass(workspace_);
    near.damping = Code::coriolis(workspace_);
    near.damping.diagonal() += damping;
    near.stiffness.setZero();
    near.stiffness.diagonal() = stiffness;
    near.force = force(q, v);
    return near;
  }

  // Kinetic, and that of the springs, J.
  double energy(const VectorQ& q, const VectorV& v) {
    Code::evaluate(q, v, workspace_);
    const auto joints = q.template tail<nv - base>();
    return v.dot(Code::mass(workspace_) * v) / 2 + joints.dot(stiffness.template tail<nv - base>().cwiseProduct(joints)) / 2;
  }

  // Linear and angular, about the world's origin and along its axes, of a robot whose base floats.
  Eigen::Matrix<double, 6, 1> momentum(const VectorQ& q, const VectorV& v) {
    Code::evaluate(q, v, workspace_);
    const Eigen::Matrix<double, 6, 1> own = (Code::mass(workspace_) * v).template head<6>();
    const Eigen::Matrix3d turned = rotation_of_quaternion<double>(q[3], q[4], q[5], q[6]);
    Eigen::Matrix<double, 6, 1> world;
    world << turned * own.template head<3>(), turned * own.template tail<3>();
    const Eigen::Vector3d linear = world.template head<3>(), at = q.template head<3>();
    world.template tail<3>() += at.cross(linear);
    return world;
  }

 private:
  VectorV force(const VectorQ& q, const VectorV& v) {
    VectorV f = effort - Code::bias(workspace_) - damping.cwiseProduct(v);
    constexpr int joints = nv - base;
    f.template tail<joints>() -= stiffness.template tail<joints>().cwiseProduct(q.template tail<joints>());
    return f;
  }

  typename Code::Workspace workspace_;
};

}  // namespace dalembert::testing
