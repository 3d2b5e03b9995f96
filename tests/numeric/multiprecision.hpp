// The generic engine in 100 decimal digits, compiled once: Eigen on Boost.Multiprecision is slow to compile.
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>

#include "ir/kinematic_tree.hpp"
#include "reference/instances.hpp"

namespace dalembert::testing {

using Multi = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<100>, boost::multiprecision::et_off>;

// The robot with exactly unit axes and orthonormal rotations: identities then hold to 100 digits rather than to 16.
generic::Model<Multi> exact_model(const ir::KinematicTree& tree, const Eigen::Vector3d& gravity);

// The doubles as they are, but for the base's quaternion, which becomes of unit length.
VectorX<Multi> exact_position(const ir::KinematicTree& tree, const Eigen::VectorXd& q);

}  // namespace dalembert::testing

namespace dalembert::generic {
DALEMBERT_GENERIC_ENGINE(extern template, dalembert::testing::Multi);
}  // namespace dalembert::generic
