// The generic engine in 100 decimal digits, compiled once: Eigen on Boost.Multiprecision is slow to compile.
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <dalembert/generic/dynamics.hpp>

#include "ir/kinematic_tree.hpp"

namespace dalembert::testing {

using Multi = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<100>, boost::multiprecision::et_off>;

// The robot with exactly unit axes and orthonormal rotations: identities then hold to 100 digits rather than to 16.
generic::Model<Multi> exact_model(const ir::KinematicTree& tree, const Eigen::Vector3d& gravity);

// The doubles as they are, but for the base's quaternion, which becomes of unit length.
VectorX<Multi> exact_position(const ir::KinematicTree& tree, const Eigen::VectorXd& q);

}  // namespace dalembert::testing

namespace dalembert::generic {
using MultiVector = VectorX<dalembert::testing::Multi>;
using MultiMatrix = MatrixX<dalembert::testing::Multi>;
using MultiModel = Model<dalembert::testing::Multi>;
using MultiIn = const MultiVector&;
extern template Dynamics<dalembert::testing::Multi> evaluate(const MultiModel&, MultiIn, MultiIn);
extern template MultiMatrix mass_matrix(const MultiModel&, MultiIn);
extern template MultiMatrix coriolis_matrix(const MultiModel&, MultiIn, MultiIn);
extern template MultiVector inverse_dynamics(const MultiModel&, MultiIn, MultiIn, MultiIn, MultiIn);
extern template InverseDynamicsDerivatives<dalembert::testing::Multi> inverse_dynamics_derivatives(const MultiModel&, MultiIn,
                                                                                                   MultiIn, MultiIn, MultiIn);
extern template MultiMatrix regressor(const MultiModel&, MultiIn, MultiIn, MultiIn);
extern template Solution<MultiMatrix> inverse_mass_matrix(const MultiModel&, MultiIn);
extern template Solution<MultiMatrix> mass_matrix_factor(const MultiModel&, MultiIn);
extern template Solution<MultiVector> forward_dynamics(const MultiModel&, MultiIn, MultiIn, MultiIn, MultiIn);
extern template ForwardDynamicsDerivatives<dalembert::testing::Multi> forward_dynamics_derivatives(const MultiModel&, MultiIn,
                                                                                                   MultiIn, MultiIn, MultiIn);
}  // namespace dalembert::generic
