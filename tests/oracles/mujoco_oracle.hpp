// MuJoCo as an oracle: M, C v, g, bias and momentum of a URDF, by MuJoCo's own reading of it.
//
// Its conventions differ from ours and are converted here, nowhere else: quaternions w x y z, and a base velocity whose
// linear part is in world axes. MuJoCo's principal axes of inertias are good to 1e-8 only; `overwrite_inertias` replaces
// them, after which its kinematics are still its own and its results are good to rounding.
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <memory>

#include "ir/kinematic_tree.hpp"
#include "oracle.hpp"

namespace dalembert::oracle {

enum class Inertias {
  as_read,      // MuJoCo's own; refuses what breaks the triangle inequality; good to 1e-8
  overwritten,  // a placeholder until overwrite_inertias() is called
};

// An equality constraint: the body that `joint` moves is held by the one that `other` moves, or by the world.
struct Held {
  std::string joint, other = "";  // of a body, in the URDF's names; empty: the world
  bool weld = false;              // else at a point: "connect"
};

// What MuJoCo makes of its constraints, in its rows and our coordinates. A row is of the held body against the other: along the
// world's axes the velocity of its point less that of the other's point; then, of a weld, the rate of the vector part of the
// quaternion between them, which is half the angular velocity, along the other's axes, where they agree.
struct Soft {
  Eigen::MatrixXd jacobian;  // efc_J, rows x nv
  Eigen::VectorXd velocity, position, reference, regularization, stiffness, damping,
      forces;             // efc_vel, _pos, _aref, _R, _KBIP's K I and B, _force
  Eigen::VectorXd v_dot;  // of qacc
};

class MujocoOracle {
 public:
  MujocoOracle(const Request& request, Inertias inertias);  // throws std::runtime_error with MuJoCo's message

  // Sets every body's mass, centre and principal inertia. Bodies are matched by joint name.
  void overwrite_inertias(const ir::KinematicTree& tree);

  // Gives every joint its spring. Joints are matched by order.
  void set_springs(const ir::KinematicTree& tree);
  // What springs push the joints with at q, N m or N, in our order, behind the base's rows.
  Eigen::VectorXd spring_forces(const Eigen::VectorXd& q);

  void set_gravity(const Eigen::Vector3d& gravity);  // m/s², world axes
  Dynamics evaluate(const Eigen::VectorXd& q, const Eigen::VectorXd& v);
  WholeRobot whole_robot(const Eigen::VectorXd& q, const Eigen::VectorXd& v);
  Response respond(const Question& question);  // by mj_rne with accelerations, and by MuJoCo's factors of M

  // Adds constraints, and leaves out all others; inertias are placeholders again. K and B, as in solref's direct form, are
  // those of every constraint, and so is the impedance, at any distance.
  void hold(const std::vector<Held>& held, double stiffness, double damping, double impedance);
  // Where the i-th holds: a point in the body, one in the other (or in the world), and the body's axes in the other's when
  // there is no error.
  void place(size_t i, const Eigen::Vector3d& at, const Eigen::Vector3d& at_other, const Eigen::Quaterniond& turned);
  Soft soft(const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& tau);  // mj_forward, by Newton's method

  // For benchmarks and simulation: MuJoCo's own model, data and coordinates.
  const mjModel* model() const { return model_.get(); }
  mjModel* model() { return model_.get(); }
  const mjData* data() const { return data_.get(); }
  mjData* data() { return data_.get(); }
  void set_state(const Eigen::VectorXd& q, const Eigen::VectorXd& v);  // converts, writes qpos and qvel, computes nothing

  // qvel = T v; qacc = T v̇ + Ṫ v.
  struct Change {
    Eigen::MatrixXd transform;  // T: a permutation but for the rotation R of the base's linear velocity
    Eigen::VectorXd drift;      // Ṫ v: R (ω × v) of the base
  };
  Change change_of_coordinates(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const;

 private:
  struct Delete {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
  };
  void find_joints();  // by name
  void set_inertia(int body, const ir::Inertia& inertia);
  void compute_mass_matrix();                                // at the state set: mj_fullM and mj_factorM have what they need
  Eigen::VectorXd own_bias(const Eigen::Vector3d& gravity);  // mj_rne in MuJoCo's coordinates, at the state set
  int last_body() const;                                     // that of the last joint's link
  Eigen::Matrix<double, 6, 1> own_momentum(const Eigen::Matrix3d& base_rotation);

  std::unique_ptr<mjModel, Delete> model_;
  std::unique_ptr<mjData, Delete> data_;
  std::string urdf_;
  bool floating_;
  std::vector<std::string> joints_;
  std::vector<int> qpos_, dof_;  // our joint → MuJoCo's addresses
  int base_qpos_ = 0, base_dof_ = 0, base_body_ = 0;
};

}  // namespace dalembert::oracle
