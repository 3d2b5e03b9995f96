// Eigenvalues of symmetric matrices: Eigen's solver takes ten seconds to compile, so that it is compiled once.
#pragma once

#include <Eigen/Core>

namespace dalembert::reference {

// Of a symmetric matrix (n × n, its lower half is read), in increasing order. Not finite where an element is not.
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& symmetric);

}  // namespace dalembert::reference
