// Columns of blocks, lane by lane, into a matrix.
#include <gtest/gtest.h>

#include <dalembert/columns.hpp>

namespace dalembert {
namespace {

// Four rows are stored at a time. Behind a lane's three stands the next lane's first, which is stored after it, or a row of
// some other limb, which nothing may touch.
template <class Put>
void expect_own_rows(const Put& put) {
  for (const int gap : {0, 1}) {
    double matrix[8];
    for (double& x : matrix) x = -1;
    put(detail::Line<2>{{0, 0}, {0, 3 + gap}, {3, 4}}, matrix);
    for (int r = 0; r < 3; ++r) EXPECT_EQ(matrix[r], 10 + r) << gap;
    if (gap > 0) {
      EXPECT_EQ(matrix[3], -1);
    }
    for (int r = 0; r < 4; ++r) EXPECT_EQ(matrix[3 + gap + r], 20 + r) << gap;
  }
}

TEST(Columns, StoreNoRowsButTheirOwn) {
  expect_own_rows([](const detail::Line<2>& at, double* matrix) {
    Lanes<double, 2> values[4];
    for (int r = 0; r < 4; ++r) values[r] = Lanes<double, 2>{10.0 + r, 20.0 + r};
    detail::put_line<2, double>(matrix, 8, at, values, 4);
  });
  expect_own_rows([](const detail::Line<2>& at, double* matrix) {
    const Lanes<double, 4> turned[2] = {{10, 11, 12, 13}, {20, 21, 22, 23}};
    detail::put_turned<2, double>(matrix, 8, at, turned);
  });
}

}  // namespace
}  // namespace dalembert
