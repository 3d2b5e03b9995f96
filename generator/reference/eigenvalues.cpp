#include "reference/eigenvalues.hpp"

#include <Eigen/Eigenvalues>

namespace dalembert::reference {

Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace dalembert::reference
