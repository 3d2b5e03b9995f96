// The joint-torque regressor: inverse dynamics as a linear function of the bodies' inertial parameters.
//
// Source: Atkeson, An, Hollerbach, "Estimation of inertial parameters of manipulator loads and links" (International Journal
// of Robotics Research, 1986).
#pragma once

#include <dalembert/generic/forces.hpp>
#include <dalembert/generic/jacobians.hpp>

namespace dalembert::generic {

inline constexpr int parameters_per_body = 10;

// The ten numbers that a body's wrench is linear in: mass m (kg), m c (3; kg m), and the entries Ixx, Ixy, Ixz, Iyy, Iyz, Izz
// of the inertia matrix about the origin of the body's own frame, in its axes (kg m²; Ixy is the entry of the matrix, −∫ x y
// dm).
template <class S>
Eigen::Matrix<S, parameters_per_body, 1> inertial_parameters(const Inertia<S>& body) {
  const Matrix6<S> A = inertia_matrix(body);
  Eigen::Matrix<S, parameters_per_body, 1> result;
  result << body.mass, body.mass * body.com, A(3, 3), A(3, 4), A(3, 5), A(4, 4), A(4, 5), A(5, 5);
  return result;
}

// Of every body, 10·bodies, in the order of W's columns: the base first when it floats.
template <class S>
VectorX<S> inertial_parameters(const Model<S>& model) {
  VectorX<S> result(parameters_per_body * model.moving_bodies());
  const int first = model.joints() - model.moving_bodies();
  for (int k = first; k < model.joints(); ++k)
    result.template segment<parameters_per_body>(parameters_per_body * (k - first)) =
        inertial_parameters(k < 0 ? model.base : model.bodies[static_cast<size_t>(k)].inertia);
  return result;
}

// The inertia matrix A = [m·1, −[h]; [h], I] of parameters φ = (m, h, I), I about the origin.
template <class S>
Matrix6<S> inertia_matrix_of(const Eigen::Matrix<S, parameters_per_body, 1>& parameters) {
  const auto& p = parameters;
  const Matrix3<S> h = cross_matrix<S>(p.template segment<3>(1));
  Matrix3<S> I;
  I << p[4], p[5], p[6], p[5], p[7], p[8], p[6], p[8], p[9];
  Matrix6<S> A;
  A << Matrix3<S>(p[0] * Matrix3<S>::Identity()), -h, h, I;
  return A;
}

// Y, (base rows + joints) × 10·bodies. q, v, v_dot: of every joint, behind the base's.
template <class S>
MatrixX<S> expanded_regressor(const Model<S>& model, const Kinematics<S>& kinematics, const VectorX<S>& q, const VectorX<S>& v,
                              const VectorX<S>& v_dot) {
  using Parameters = Eigen::Matrix<S, parameters_per_body, 1>;
  const Accelerations<S> moving = accelerations(model, kinematics, q, v, v_dot);
  const MatrixX<S> W = expanded_wrench_influence(model, kinematics);
  const int count = model.moving_bodies(), first = model.joints() - count;
  MatrixX<S> Y(W.rows(), parameters_per_body * count);
  for (int b = 0; b < count; ++b) {
    const size_t at = static_cast<size_t>(std::max(0, first + b));
    const bool base = first + b < 0;
    const Vector6<S>&twist = base ? kinematics.base_twist : kinematics.bodies[at].V,
          &acceleration = base ? moving.base : moving.bodies[at];
    Eigen::Matrix<S, 6, parameters_per_body> wrenches;  // of a body with one parameter 1 and the others 0
    for (int p = 0; p < parameters_per_body; ++p)
      wrenches.col(p) = body_wrench<S>(inertia_matrix_of<S>(Parameters::Unit(p)), twist, acceleration);
    Y.template middleCols<parameters_per_body>(parameters_per_body * b) = W.template middleCols<6>(6 * b) * wrenches;
  }
  return Y;
}

}  // namespace dalembert::generic
