// The runtime's factors of M along the tree, and what is solved with them, against what they were made from.
#include <gtest/gtest.h>

#include <algorithm>
#include <dalembert/factor.hpp>
#include <dalembert/solve.hpp>
#include <limits>
#include <random>
#include <vector>

namespace dalembert {
namespace {

// A base of six coordinates; on it a chain of eight, which goes on for three and for one, and a chain of five.
constexpr int tree_begin[] = {0, 6, 14, 17, 18, 23}, tree_above[] = {-1, 0, 1, 1, 0}, tree_depth[] = {0, 6, 14, 14, 6};
constexpr Chains tree{5, tree_begin, tree_above, tree_depth};
// An arm, and one coordinate.
constexpr int arm_begin[] = {0, 7}, arm_above[] = {-1}, arm_depth[] = {0};
constexpr Chains arm{1, arm_begin, arm_above, arm_depth};
constexpr int one_begin[] = {0, 1};
constexpr Chains one{1, one_begin, arm_above, arm_depth};
// More than is written out: eight chains one behind another, and two more on the second.
constexpr int large_begin[] = {0, 8, 16, 24, 32, 40, 48, 56, 64, 69, 72}, large_above[] = {-1, 0, 1, 2, 3, 4, 5, 6, 1, 1},
              large_depth[] = {0, 8, 16, 24, 32, 40, 48, 56, 16, 16};
constexpr Chains large{10, large_begin, large_above, large_depth};

// U with numbers where one coordinate stands above another, D, and M = U D U', n x n column by column.
struct System {
  int n;
  std::vector<double> U, M, D;

  explicit System(const Chains& chains)
      : n(chains.begin[chains.count]), U(static_cast<size_t>(n * n)), M(U), D(static_cast<size_t>(n)) {
    std::mt19937 engine(7);
    std::uniform_real_distribution<double> number(-1, 1);
    for (int c = 0; c < chains.count; ++c)
      for (int k = chains.begin[c]; k < chains.begin[c + 1]; ++k) {
        const auto draw = [&](int begin, int behind, int) {
          for (int i = begin; i < behind; ++i) at(U, i, k) = 0.3 * number(engine);
        };
        draw(chains.begin[c], k, 0);
        detail::each_above(chains, c, draw);
        at(U, k, k) = 1;
        D[static_cast<size_t>(k)] = 2 + number(engine);
      }
    for (int r = 0; r < n; ++r)
      for (int s = 0; s < n; ++s) {
        long double sum = 0;
        for (int k = 0; k < n; ++k)
          sum += static_cast<long double>(at(U, r, k)) * static_cast<long double>(D[static_cast<size_t>(k)] * at(U, s, k));
        at(M, r, s) = static_cast<double>(sum);
      }
  }
  double& at(std::vector<double>& matrix, int row, int column) const { return matrix[static_cast<size_t>(column * n + row)]; }
  double at(const std::vector<double>& matrix, int row, int column) const {
    return matrix[static_cast<size_t>(column * n + row)];
  }
};

template <int n, int longest, const Chains& chains, class T>
void expect_factors(double tolerance) {
  const System system(chains);
  ASSERT_EQ(system.n, n);
  const std::vector<T> M(system.M.begin(), system.M.end());
  // What lies behind is not written.
  alignas(64) T room[factor_stride(longest) * n + 8], factor[n * n + 8] = {}, pivots[n + 8], diagonal[n + 8], x[n + 8],
                                                                     several[3 * n];
  for (T& number : room) number = T(-7);
  factorise<n, longest, chains>(M.data(), room, factor, pivots, diagonal);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(room[factor_stride(longest) * n + i], T(-7));
  for (int k = 0; k < n; ++k) {
    EXPECT_NEAR(pivots[k], system.D[static_cast<size_t>(k)], tolerance) << k;
    EXPECT_EQ(factor[k * n + k], pivots[k]);
    EXPECT_EQ(diagonal[k], M[static_cast<size_t>(k * n + k)]);
    for (int i = 0; i < k; ++i) EXPECT_NEAR(factor[k * n + i], system.at(system.U, i, k), tolerance) << i << ' ' << k;
    for (int i = k + 1; i < n; ++i) EXPECT_EQ(factor[k * n + i], T(0)) << i << ' ' << k;
  }
  for (int k = 0; k < n + 8; ++k) x[k] = T(1 + k % 5);
  for (int k = 0; k < 3 * n; ++k) several[k] = T(1 + k % n % 5) * T(1 + k / n);
  solve_one<n, chains>(factor, x);
  EXPECT_TRUE(solve<n>(chains, factor, several, 3, n));
  for (int k = n; k < n + 8; ++k) EXPECT_EQ(x[k], T(1 + k % 5));
  for (int k = 0; k < 3 * n; ++k) EXPECT_NEAR(several[k], x[k % n] * T(1 + k / n), 100 * tolerance) << k;
  for (int r = 0; r < n; ++r) {
    double product = 0;
    for (int k = 0; k < n; ++k) product += system.at(system.M, r, k) * static_cast<double>(x[k]);
    EXPECT_NEAR(product, 1 + r % 5, 100 * tolerance) << r;
  }
}

TEST(FactorKernels, AreTheFactorsAndSolve) {
  expect_factors<1, 1, one, double>(1e-15);
  expect_factors<7, 7, arm, double>(1e-14);
  expect_factors<23, 17, tree, double>(1e-13);
  expect_factors<72, 64, large, double>(1e-12);
}

TEST(FactorKernels, InFloatToo) {
  expect_factors<7, 7, arm, float>(1e-5);
  expect_factors<23, 17, tree, float>(1e-4);
  expect_factors<72, 64, large, float>(1e-3);
}

// M's inverse, and minus its product with a matrix that has numbers where one coordinate stands above another. Twice: what the
// first time leaves beyond the matrix must not matter.
template <int n, const Chains& chains, class T>
void expect_inverse(double tolerance) {
  const System system(chains);
  const std::vector<T> U(system.U.begin(), system.U.end()), D(system.D.begin(), system.D.end());
  std::vector<T> inverse(static_cast<size_t>(inverse_size(n))), plain(static_cast<size_t>(n * n) + 8, T(-7)), b(plain),
      product(plain);
  const auto path_above = [](int c) {  // the nearest first
    std::vector<int> path;
    detail::each_above(chains, c, [&](int begin, int behind, int) {
      for (int i = begin; i < behind; ++i) path.push_back(i);
    });
    std::sort(path.rbegin(), path.rend());
    return path;
  };
  std::mt19937 engine(11);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int r = 0; r < n; ++r)
    for (int s = 0; s < n; ++s) {
      const bool related = r == s || system.at(system.U, std::min(r, s), std::max(r, s)) != 0;
      b[static_cast<size_t>(s * n + r)] = related ? T(number(engine)) : T(0);
    }
  for (int again = 0; again < 2; ++again) {
    detail::for_constants<chains.count>([&](auto chain) {
      constexpr int c = decltype(chain)::value, first = chains.begin[c], m = chains.begin[c + 1] - first;
      const std::vector<int> path = path_above(c);
      invert_chain<n, m>(first, {path.data(), static_cast<int>(path.size())}, U.data(), D.data(), inverse.data());
    });
    without_padding<n>(inverse.data(), plain.data());
    for (int r = 0; r < n; ++r)
      for (int s = 0; s < n; ++s) {
        double sum = 0;
        for (int k = 0; k < n; ++k)
          sum += system.at(system.M, r, k) * static_cast<double>(plain[static_cast<size_t>(s * n + k)]);
        EXPECT_NEAR(sum, r == s ? 1 : 0, tolerance) << r << ' ' << s;
      }
    for (int c = 0; c < chains.count; ++c) {
      const std::vector<int> path = path_above(c);
      int last = chains.begin[c + 1] - 1;  // the last coordinate that the chain's first stands above
      for (int k = last + 1; k < n; ++k)
        if (system.at(system.U, chains.begin[c], k) != 0) last = k;
      negative_product_chain<n>(chains.begin[c], chains.begin[c + 1], last, {path.data(), static_cast<int>(path.size())},
                                inverse.data(), b.data(), product.data());
    }
    for (int r = 0; r < n; ++r)
      for (int s = 0; s < n; ++s) {
        double sum = 0;
        for (int k = 0; k < n; ++k)
          sum -= static_cast<double>(plain[static_cast<size_t>(k * n + r)]) *
                 static_cast<double>(b[static_cast<size_t>(s * n + k)]);
        EXPECT_NEAR(product[static_cast<size_t>(s * n + r)], sum, tolerance) << r << ' ' << s;
      }
    for (int i = 0; i < 8; ++i) {
      EXPECT_EQ(plain[static_cast<size_t>(n * n + i)], T(-7));
      EXPECT_EQ(product[static_cast<size_t>(n * n + i)], T(-7));
    }
    const auto places = static_cast<size_t>(inverse_stride(n));
    for (size_t k = 0; k < static_cast<size_t>(n); ++k)
      std::fill(inverse.begin() + static_cast<long>(k * places + n), inverse.begin() + static_cast<long>((k + 1) * places),
                std::numeric_limits<T>::quiet_NaN());
  }
}

TEST(FactorKernels, InvertAndMultiplyAChainAtATime) {
  expect_inverse<1, one, double>(1e-15);
  expect_inverse<7, arm, double>(1e-14);
  expect_inverse<23, tree, double>(1e-13);
  expect_inverse<72, large, double>(1e-12);
  expect_inverse<7, arm, float>(1e-5);
  expect_inverse<23, tree, float>(1e-4);
  expect_inverse<72, large, float>(1e-3);
}

}  // namespace
}  // namespace dalembert
