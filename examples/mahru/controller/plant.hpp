// The robot to be controlled: MuJoCo simulating the same URDF. Nothing of dalembert is in here.
//
// The pelvis is welded to the world (Base::fixed) or released without gravity (Base::floating). Contacts, joint limits and all
// other constraints are off: what remains is M v̇ + C v + g = τ, integrated by Runge and Kutta's fourth-order rule.
#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <string>
#include <vector>

#include "types.hpp"

namespace controller {

class Plant {
 public:
  // `joint_names`: the order in which states and torques are exchanged. Throws std::runtime_error when MuJoCo refuses the
  // model. `world`: what stands for the world of a released robot, as URDF.
  Plant(const std::string& urdf_file, Base base, const char* const* joint_names,
        const std::string& world = "<link name=\"world\"/>");

  const VectorJ& lower() const { return lower_; }  // joint limits, rad
  const VectorJ& upper() const { return upper_; }

  // None of these allocates.
  void write(const State& state) noexcept;
  void read(State& state) const noexcept;
  void step(const VectorJ& torque) noexcept;  // N m, held over one period

  // MuJoCo's own account of the present state, in dalembert's coordinates and conventions.
  struct Account {
    Eigen::MatrixXd mass_matrix;       // nv × nv
    Eigen::Vector3d linear_momentum;   // kg m/s, world axes
    Eigen::Vector3d angular_momentum;  // kg m²/s about the world's origin, world axes
  };
  Account make_account() const { return {Eigen::MatrixXd::Zero(nv_, nv_), {}, {}}; }
  void account(Account& account) noexcept;

 protected:
  struct Delete {
    void operator()(mjModel* m) const { mj_deleteModel(m); }
    void operator()(mjData* d) const { mj_deleteData(d); }
  };
  std::unique_ptr<mjModel, Delete> model_;
  std::unique_ptr<mjData, Delete> data_;
  std::vector<int> velocity_index_;  // our joint → MuJoCo's qvel

 private:
  Base base_;
  int nv_;
  std::vector<int> position_index_;  // our joint → MuJoCo's qpos
  std::vector<int> order_;           // our velocity coordinate → MuJoCo's
  VectorJ lower_, upper_;
  std::vector<double> full_mass_matrix_;  // scratch of account()
};

}  // namespace controller
