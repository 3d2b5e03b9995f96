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
using MultiModel = Model<dalembert::testing::Multi>;
extern template Dynamics<dalembert::testing::Multi> evaluate(const MultiModel&, const MultiVector&, const MultiVector&);
extern template MatrixX<dalembert::testing::Multi> mass_matrix(const MultiModel&, const MultiVector&);
extern template MatrixX<dalembert::testing::Multi> coriolis_matrix(const MultiModel&, const MultiVector&, const MultiVector&);
extern template MultiVector newton_euler(const MultiModel&, const MultiVector&, const MultiVector&, const MultiVector&);
}  // namespace dalembert::generic
