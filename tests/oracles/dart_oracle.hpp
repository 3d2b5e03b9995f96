// DART as an oracle: M, C v, g, bias and momentum of a URDF, by DART's own reading of it.
//
// DART keeps fixed links as bodies of their own and reads inertias itself, so it also checks our fusing of fixed joints and
// our reading of rotated <inertial> elements. Never compile a target that uses it with -march=native: Eigen's alignment is
// part of its ABI. Hence a library, and a test executable, of its own.
#pragma once

#include <memory>

#include "joint_kinds.hpp"
#include "oracle.hpp"

namespace dalembert::oracle {

class DartOracle {
 public:
  explicit DartOracle(const Request& request);  // throws std::runtime_error
  ~DartOracle();
  DartOracle(DartOracle&&) noexcept;

  Dynamics evaluate(const Eigen::VectorXd& q, const Eigen::VectorXd& v);
  Response respond(const Question& question);  // by DART's recursions: Newton-Euler and articulated bodies

  // For benchmarks: DART's own coordinates of a state of ours, and what it computes in them.
  struct Coordinates {
    Eigen::VectorXd positions, velocities;
  };
  Coordinates own_coordinates(const Eigen::VectorXd& q, const Eigen::VectorXd& v);
  void set_state(const Coordinates& coordinates);
  const Eigen::MatrixXd& own_mass_matrix();
  const Eigen::VectorXd& own_gravity();
  const Eigen::VectorXd& own_bias();
  Eigen::VectorXd own_inverse_dynamics(const Eigen::VectorXd& own_accelerations);  // at the state set
  Eigen::VectorXd own_forward_dynamics(const Eigen::VectorXd& own_forces);
  Eigen::VectorXd own_vector(const Eigen::VectorXd& ours) const;  // accelerations or forces: the order alone differs
  Eigen::VectorXd our_vector(const Eigen::VectorXd& own) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// What DART's own joints of every kind answer: screw, universal, planar, ball and free, built one by one and not from a URDF.
struct KindsAnswer {
  Eigen::MatrixXd mass_matrix;
  Eigen::VectorXd bias, forward_dynamics;
};
// A coordinate of v behind the base's, in our order: the joint, and which of its coordinates.
struct KindsCoordinate {
  std::string joint;
  int part = 0;
};
// q, v, tau: as ours; position: per coordinate, where in q its joint's numbers begin.
KindsAnswer dart_answer(const KindsRobot& robot, const std::vector<KindsCoordinate>& coordinates,
                        const std::vector<int>& positions, bool floating, const Eigen::Vector3d& gravity,
                        const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& tau);

}  // namespace dalembert::oracle
