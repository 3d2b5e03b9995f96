// Spatial algebra of twists and wrenches, templated on the scalar.
//
// A twist V = [v; w] and a wrench F = [f; tau] are 6-vectors, linear part first (m/s, rad/s; N, N m), each expressed in the
// axes of one frame and taken at its origin. Equation numbers are those of Shin, Park, Park, "Explicit formulation of
// multibody dynamics based on principle of dynamical balance and its parallelization" (Multibody System Dynamics, 2016).
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace dalembert {

template <class S>
using Vector3 = Eigen::Matrix<S, 3, 1>;
template <class S>
using Matrix3 = Eigen::Matrix<S, 3, 3>;
template <class S>
using Vector6 = Eigen::Matrix<S, 6, 1>;
template <class S>
using Matrix6 = Eigen::Matrix<S, 6, 6>;
template <class S>
using VectorX = Eigen::Matrix<S, Eigen::Dynamic, 1>;
template <class S>
using MatrixX = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;

// Mass (kg), centre of mass (m, body axes) and rotational inertia about the centre of mass (kg m², body axes).
template <class S>
struct Inertia {
  S mass = S(0);
  Vector3<S> com = Vector3<S>::Zero();
  Matrix3<S> inertia = Matrix3<S>::Zero();
};

// Pose of frame k in frame p: x_p = rotation · x_k + translation (m).
template <class S>
struct Transform {
  Matrix3<S> rotation = Matrix3<S>::Identity();
  Vector3<S> translation = Vector3<S>::Zero();
};

// ᵃT_c = ᵃT_b · ᵇT_c
template <class S>
Transform<S> operator*(const Transform<S>& ab, const Transform<S>& bc) {
  return {ab.rotation * bc.rotation, ab.rotation * bc.translation + ab.translation};
}

// [a], the matrix of the cross product: [a] b = a × b.
template <class S>
Matrix3<S> cross_matrix(const Vector3<S>& a) {
  Matrix3<S> result;
  result << S(0), -a.z(), a.y(), a.z(), S(0), -a.x(), -a.y(), a.x(), S(0);
  return result;
}

// The rotation by `angle` (rad) about the unit axis: cos·1 + sin·[a] + (1 − cos)·a aᵀ.
template <class S>
Matrix3<S> rotation_about(const Vector3<S>& axis, const S& angle) {
  using std::cos;
  using std::sin;
  const S c = cos(angle), s = sin(angle);
  const Vector3<S> rest = (S(1) - c) * axis;
  Matrix3<S> result = cross_matrix<S>(axis) * s + rest * axis.transpose();
  for (int i = 0; i < 3; ++i) result(i, i) += c;
  return result;
}

// The rotation of a unit quaternion given as (x, y, z, w). Its length is not corrected.
template <class S>
Matrix3<S> rotation_of_quaternion(const S& x, const S& y, const S& z, const S& w) {
  const S one(1), two(2);
  Matrix3<S> result;
  result << one - two * (y * y + z * z), two * (x * y - w * z), two * (x * z + w * y),  //
      two * (x * y + w * z), one - two * (x * x + z * z), two * (y * z - w * x),        //
      two * (x * z - w * y), two * (y * z + w * x), one - two * (x * x + y * y);
  return result;
}

// ᵖAd_k = [R, [r]R; 0, R] (eq. 8): takes a twist from frame k to frame p. Its transpose takes a wrench from p to k.
template <class S>
Matrix6<S> adjoint(const Transform<S>& pose) {
  Matrix6<S> result;
  result << pose.rotation, cross_matrix<S>(pose.translation) * pose.rotation, Matrix3<S>::Zero(), pose.rotation;
  return result;
}

// (ᵖAd_k)⁻¹ = [Rᵀ, −Rᵀ[r]; 0, Rᵀ]
template <class S>
Matrix6<S> adjoint_inverse(const Transform<S>& pose) {
  const Matrix3<S> back = pose.rotation.transpose();
  Matrix6<S> result;
  result << back, -(back * cross_matrix<S>(pose.translation)), Matrix3<S>::Zero(), back;
  return result;
}

// ad(V) = [[w], [v]; 0, [w]]: ad(V) U is the rate of U seen from a frame moving with −V; ad(V) V = 0.
template <class S>
Matrix6<S> ad(const Vector6<S>& twist) {
  const Matrix3<S> v = cross_matrix<S>(twist.template head<3>()), w = cross_matrix<S>(twist.template tail<3>());
  Matrix6<S> result;
  result << w, v, Matrix3<S>::Zero(), w;
  return result;
}

// A = [m·1, −m[ρ]; m[ρ], I + m[ρ][ρ]ᵀ] (eq. 12): the inertia matrix of a body in its own frame, ρ its centre of mass.
template <class S>
Matrix6<S> inertia_matrix(const Inertia<S>& body) {
  const Matrix3<S> rho = cross_matrix<S>(body.com), m_rho = body.mass * rho;
  Matrix6<S> result;
  result << Matrix3<S>(body.mass * Matrix3<S>::Identity()), -m_rho, m_rho, body.inertia + m_rho * rho.transpose();
  return result;
}

// B = [m[w], −m[w][ρ]; m[ρ][w], −[I w] + m[ρ][w][ρ]ᵀ] (eq. 13): skew-symmetric; F = A V̇ + B V (eq. 11).
template <class S>
Matrix6<S> bias_matrix(const Inertia<S>& body, const Vector6<S>& twist) {
  const Vector3<S> angular = twist.template tail<3>();
  const Matrix3<S> w = cross_matrix<S>(angular), rho = cross_matrix<S>(body.com);
  const Matrix3<S> m_w = body.mass * w, m_rho_w = rho * m_w;
  Matrix6<S> result;
  result << m_w, -(m_w * rho), m_rho_w, m_rho_w * rho.transpose() - cross_matrix<S>(body.inertia * angular);
  return result;
}

// B of the same body that makes C the one of Christoffel symbols (Echeandia and Wensing 2021), ½ (A ad(V) − ad(V)ᵀ A + [A V]),
// with [[f; n]] = [0, −[f]; −[f], −[n]]: skew-symmetric as well, and the same B V.
template <class S>
Matrix6<S> christoffel_bias_matrix(const Inertia<S>& body, const Vector6<S>& twist) {
  const Matrix6<S> A = inertia_matrix(body), moving = A * ad(twist);
  const Vector6<S> momentum = A * twist;
  const Matrix3<S> f = cross_matrix<S>(momentum.template head<3>());
  Matrix6<S> crossed;
  crossed << Matrix3<S>::Zero(), -f, -f, -cross_matrix<S>(momentum.template tail<3>());
  return (moving - moving.transpose() + crossed) / S(2);
}

}  // namespace dalembert
