// Where a user's program has Eigen's matrices row by row unless they say otherwise, results and what is solved for stand in the
// workspace column by column all the same.
#define EIGEN_DEFAULT_TO_ROW_MAJOR
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "factors/dynamics.hpp"

namespace dalembert::testing {
namespace {

using factors::nv;
static_assert(Eigen::MatrixXd::IsRowMajor);

class RowMajor : public ::testing::Test {
 protected:
  RowMajor() {
    factors::VectorQ q;
    q.setLinSpaced(-1, 1);
    q.segment<4>(3).normalize();
    factors::evaluate(q, factors::VectorV::Zero(), workspace);
  }

  factors::Workspace workspace;
};

TEST_F(RowMajor, ResultsAreNotTransposed) {
  const auto U = factors::mass_matrix_factor(workspace);
  double largest = 0;
  for (int column = 0; column < nv; ++column)
    for (int row = 0; row < nv; ++row) {
      EXPECT_EQ(U(row, column), workspace.mass_matrix_factor[row + column * nv]);
      if (row > column) {
        EXPECT_EQ(U(row, column), 0);
      } else if (row < column) {
        largest = std::max(largest, std::abs(U(row, column)));
      }
    }
  EXPECT_GT(largest, 0.01);  // it is not the same transposed
}

TEST_F(RowMajor, SolvesColumns) {
  using Columns = Eigen::Matrix<double, nv, 3, Eigen::ColMajor>;
  const Columns right = Columns::NullaryExpr([](Eigen::Index i, Eigen::Index j) { return std::sin(double(1 + i + 20 * j)); });
  Columns x = right;
  ASSERT_TRUE(factors::solve(x, workspace));
  const Eigen::MatrixXd back = factors::mass_matrix(workspace) * x;
  EXPECT_LT((back - right).cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace dalembert::testing
