// Blocks of long limbs against sums written out, element by element.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <dalembert/long_limbs.hpp>
#include <random>
#include <vector>

namespace dalembert {
namespace {

constexpr int width = 4, lower_factors = 5, upper_factors = 4;
using Elements = Matrices<Symmetric<Sum<Term<0, 0>, Term<1, 1>>>,
                          Square<Sum<Term<3, 0>, Term<4, 1>>, Sum<Term<0, 2>, Term<1, 3>, Term<2, 1>>>>;

// Limbs side by side, as many slots as the longest has joints, behind a limb that stands alone and is above all but the first.
template <class T>
struct Robot {
  std::vector<LongLimb> limbs, above;
  LongLimb trunk;
  int rows = 0, stride = 0;
  std::vector<T> numbers;

  Robot(const std::vector<int>& lengths, int trunk_length) : trunk{0, 1, 0, trunk_length} {
    int longest = 0, lane = 0;
    rows = trunk_length;
    for (const int length : lengths) {
      limbs.push_back({padded(trunk_length) + lane, width, rows, length});
      above.push_back(lane == 0 ? LongLimb{0, 1, 0, 0} : trunk);
      rows += length;
      ++lane;
      longest = std::max(longest, length);
    }
    stride = padded(trunk_length) + longest * width + 8;
    std::mt19937 engine(3);
    std::uniform_real_distribution<double> number(-1, 1);
    numbers.resize(static_cast<std::size_t>(3 * (lower_factors + upper_factors) * stride));
    for (T& x : numbers) x = static_cast<T>(number(engine));
  }
  const T* factor(int number) const { return numbers.data() + 3 * number * stride; }
  Factors<T, lower_factors> lower() const {
    Factors<T, lower_factors> all{{}, stride};
    for (int f = 0; f < lower_factors; ++f) all.at[f] = factor(f);
    return all;
  }
  Factors<T, upper_factors> upper() const {
    Factors<T, upper_factors> all{{}, stride};
    for (int f = 0; f < upper_factors; ++f) all.at[f] = factor(lower_factors + f);
    return all;
  }
  double dot(int lower_number, int below, int upper_number, int up) const {
    double sum = 0;
    for (int j = 0; j < 3; ++j)
      sum += static_cast<double>(factor(lower_number)[j * stride + below]) *
             static_cast<double>(factor(lower_factors + upper_number)[j * stride + up]);
    return sum;
  }
};

constexpr int untouched = 77;

template <class T>
struct Result {
  std::vector<T> M, C;
  explicit Result(int rows) : M(static_cast<std::size_t>(rows * rows), T(untouched)), C(M) {}
};

// All columns in the ranges that `cuts` divide them into.
template <class T, int together>
Result<T> computed(const Robot<T>& robot, const std::vector<int>& cuts) {
  Result<T> result(robot.rows);
  T* const matrices[] = {result.M.data(), result.C.data()};
  const int count = static_cast<int>(robot.limbs.size());
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    long_limb_blocks<Elements, T, together>(robot.lower(), robot.upper(), robot.limbs.data(), count, matrices, robot.rows,
                                            cuts[i], cuts[i + 1]);
    long_limb_cross_blocks<Elements, T, together>(robot.lower(), robot.upper(), robot.limbs.data(), robot.above.data(), count,
                                                  matrices, robot.rows, cuts[i], cuts[i + 1]);
  }
  long_limb_blocks<Elements, T, together>(robot.lower(), robot.upper(), &robot.trunk, 1, matrices, robot.rows, 0,
                                          robot.trunk.length);
  return result;
}

template <class T>
void expect_sums(const Robot<T>& robot, const Result<T>& result, double tolerance) {
  Result<T> expected(robot.rows);
  std::size_t elements = 0;
  const auto at = [&](std::vector<T>& matrix, int row, int column) -> T& {
    return matrix[static_cast<std::size_t>(column * robot.rows + row)];
  };
  const auto pair = [&](const LongLimb& below, int k, const LongLimb& above, int i) {
    const int low = below.first_slot + k * below.step, up = above.first_slot + i * above.step;
    const int row = above.first_row + i, column = below.first_row + k;
    const double m = robot.dot(0, low, 0, up) + robot.dot(1, low, 1, up);
    at(expected.M, row, column) = at(expected.M, column, row) = static_cast<T>(m);
    at(expected.C, column, row) =
        static_cast<T>(robot.dot(0, low, 2, up) + robot.dot(1, low, 3, up) + robot.dot(2, low, 1, up));
    at(expected.C, row, column) = static_cast<T>(robot.dot(3, low, 0, up) + robot.dot(4, low, 1, up));
    ++elements;
  };
  const auto own = [&](const LongLimb& limb) {
    for (int k = 0; k < limb.length; ++k)
      for (int i = 0; i <= k; ++i) pair(limb, k, limb, i);
  };
  own(robot.trunk);
  for (std::size_t l = 0; l < robot.limbs.size(); ++l) {
    own(robot.limbs[l]);
    for (int k = 0; k < robot.limbs[l].length; ++k)
      for (int i = 0; i < robot.above[l].length; ++i) pair(robot.limbs[l], k, robot.above[l], i);
  }
  ASSERT_GT(elements, 0u);
  for (std::size_t i = 0; i < expected.M.size(); ++i) {
    ASSERT_NEAR(result.M[i], expected.M[i], tolerance)
        << "M " << i % static_cast<std::size_t>(robot.rows) << ", " << i / static_cast<std::size_t>(robot.rows);
    ASSERT_NEAR(result.C[i], expected.C[i], tolerance)
        << "C " << i % static_cast<std::size_t>(robot.rows) << ", " << i / static_cast<std::size_t>(robot.rows);
  }
  const std::size_t rows = static_cast<std::size_t>(robot.rows);
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < row; ++column)
      ASSERT_EQ(result.M[column * rows + row], result.M[row * rows + column]);
}

template <class T, int together>
void expect_blocks(const std::vector<int>& lengths, int trunk, double tolerance) {
  const Robot<T> robot(lengths, trunk);
  int joints = 0;
  for (const int length : lengths) joints += length;
  const Result<T> whole = computed<T, together>(robot, {0, joints});
  expect_sums(robot, whole, tolerance);
  // In parts, of which some cross from one limb into the next: the same bits.
  std::vector<int> cuts{0};
  for (int step = 4; cuts.back() < joints; step = step % 28 + 8) cuts.push_back(std::min(joints, cuts.back() + step));
  const Result<T> parts = computed<T, together>(robot, cuts);
  EXPECT_EQ(std::memcmp(whole.M.data(), parts.M.data(), sizeof(T) * whole.M.size()), 0);
  EXPECT_EQ(std::memcmp(whole.C.data(), parts.C.data(), sizeof(T) * whole.C.size()), 0);
}

template <class T>
void expect_all(double tolerance) {
  for (const auto& [lengths, trunk] : std::vector<std::pair<std::vector<int>, int>>{
           {{1}, 1}, {{2, 1}, 2}, {{3, 7, 5, 9}, 4}, {{24, 8, 24, 12}, 31}, {{64, 60}, 129}, {{132, 128, 4, 140}, 128}}) {
    SCOPED_TRACE(testing::Message() << "limbs " << testing::PrintToString(lengths) << ", trunk " << trunk);
    expect_blocks<T, 1>(lengths, trunk, tolerance);
    expect_blocks<T, 2>(lengths, trunk, tolerance);
  }
}

TEST(LongLimbs, AreTheSumsOfProductsAndTouchNothingElse) { expect_all<double>(1e-14); }
TEST(LongLimbs, InFloat) { expect_all<float>(5e-6); }

}  // namespace
}  // namespace dalembert
