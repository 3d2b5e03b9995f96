// Eigenvalues of symmetric matrices: Eigen's solver takes ten seconds to compile, so that it is compiled once.
#pragma once

#include <Eigen/Core>

namespace dalembert::reference {

// Of a symmetric matrix (n × n, of finite numbers; its lower half is read), in increasing order.
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& symmetric);

}  // namespace dalembert::reference
