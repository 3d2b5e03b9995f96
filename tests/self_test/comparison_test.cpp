// The comparison that every self-test makes. Compiled with -ffast-math.
#include <gtest/gtest.h>

#include <cfloat>
#include <cstring>
#include <set>
#include <string>

#include "dalembert/self_test.hpp"

namespace dalembert {
namespace {

constexpr SelfTestSubject subject{"mass_matrix", 1, 2, 1e-3};

double from_bits(std::uint64_t bits) {
  double x;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}

TEST(SelfTestComparison, AllowsAnErrorUpToTheToleranceRelativeToTheScale) {
  for (const double error : {0.0, 1.9e-3, 2.1e-3, -2.1e-3}) {
    const double expected[] = {1, 2, 3, 4, 5, 6}, obtained[] = {1, 2, 3, 4 + error, 5, 6};
    SelfTest<double> test;
    test.elements(subject, obtained, 2, nullptr, 3, expected);
    SelfTestReport report;
    EXPECT_EQ(test.finish(&report), std::abs(error) < 2e-3) << error;
    if (error == 0) continue;
    EXPECT_STREQ(report.output, "mass_matrix");
    EXPECT_EQ(report.state, 1);
    EXPECT_EQ(report.row, 1);
    EXPECT_EQ(report.column, 1);
    EXPECT_EQ(report.expected, 4);
    EXPECT_EQ(report.obtained, 4 + error);
    EXPECT_NEAR(report.error, std::abs(error) / 2, 1e-15);
    EXPECT_EQ(report.tolerance, 1e-3);
  }
}

TEST(SelfTestComparison, TakesWhatIsNotFiniteForAnError) {
  for (const std::uint64_t bits : {0x7ff8000000000000u, 0xfff8000000000001u, 0x7ff0000000000000u, 0xfff0000000000000u}) {
    const double expected[] = {1, 2}, obtained[] = {from_bits(bits), 2};
    SelfTest<double> test;
    test.elements(subject, obtained, 2, nullptr, 1, expected);
    SelfTestReport report;
    EXPECT_FALSE(test.finish(&report));
    EXPECT_EQ(report.row, 0);
    EXPECT_EQ(report.error, DBL_MAX);
    SelfTest<double> sums;
    sums.products(subject, obtained, 2, 1, expected);
    EXPECT_FALSE(sums.finish(nullptr));
  }
}

// Both halves of a symmetric matrix, of chosen columns those alone.
TEST(SelfTestComparison, ReadsColumnsAsTheyAreListed) {
  const double lower[] = {1, 2, 3, 4, 5, 6};
  for (int wrong = 0; wrong < 9; ++wrong) {
    double matrix[] = {1, 2, 3, 2, 4, 5, 3, 5, 6};
    matrix[wrong] += 1;
    SelfTest<double> test;
    test.symmetric_elements(subject, matrix, 3, nullptr, 3, lower);
    SelfTestReport report;
    EXPECT_FALSE(test.finish(&report)) << wrong;
    EXPECT_EQ(report.row, wrong % 3);
    EXPECT_EQ(report.column, wrong / 3);

    const int chosen[] = {0, 2};
    const double columns[] = {1, 2, 3, 3, 5, 6};
    SelfTest<double> sample;
    sample.elements(subject, matrix, 3, chosen, 2, columns);
    EXPECT_EQ(sample.finish(nullptr), wrong / 3 == 1) << wrong;
  }
}

TEST(SelfTestComparison, EveryElementCountsInItsRow) {
  const double matrix[] = {1, 2, 3, 4}, w0 = self_test_weight(0), w1 = self_test_weight(1);
  const double rows[] = {w0 * 1 + w1 * 3, w0 * 2 + w1 * 4};
  SelfTest<double> right;
  right.products(subject, matrix, 2, 2, rows);
  EXPECT_TRUE(right.finish(nullptr));
  const double swapped[] = {3, 2, 1, 4};
  SelfTest<double> wrong;
  wrong.products(subject, swapped, 2, 2, rows);
  SelfTestReport report;
  EXPECT_FALSE(wrong.finish(&report));
  EXPECT_EQ(report.row, 0);
  EXPECT_EQ(report.column, -1);

  std::set<double> weights;
  for (int i = 0; i < 1024; ++i) weights.insert(self_test_weight(i));
  EXPECT_EQ(weights.size(), 1024u);
}

// An element says more than a row, and one that passes clears nobody.
TEST(SelfTestComparison, ReportsAWrongElementBeforeAWrongRow) {
  const double one[] = {1}, two[] = {2}, ten[] = {10};
  SelfTest<double> test;
  test.elements(subject, two, 1, nullptr, 1, one);
  test.products(subject, ten, 1, 1, one);
  test.elements(subject, one, 1, nullptr, 1, one);
  SelfTestReport report;
  EXPECT_FALSE(test.finish(&report));
  EXPECT_EQ(report.column, 0);
  EXPECT_EQ(report.obtained, 2);
  char text[512];
  describe(report, text, sizeof text);
  EXPECT_STREQ(text, "mass_matrix(0, 0) at state 1 is 2, expected 1: error 0.5 of the largest element, allowed 0.001");
}

}  // namespace
}  // namespace dalembert
