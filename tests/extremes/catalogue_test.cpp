// Every robot of the catalogue keeps what its row promises, and every extreme state its outcome; shortened: few states, quick
// compilation. The whole: build/release/bin/extreme_catalogue.
#include <gtest/gtest.h>

#include <vector>

#include "extremes.hpp"
#include "long_tests.hpp"

namespace dalembert::extremes {
namespace {

constexpr const char* quickly = "-O1 -march=native -std=c++17 " PRECOMPILED_EIGEN;

std::vector<Robot> quick_robots() {
  std::vector<Robot> list = robots();
  std::erase_if(list, [](const Robot& robot) { return robot.slow; });
  return one_in(3, list);
}

class Catalogue : public testing::TestWithParam<Robot> {};

TEST_P(Catalogue, KeepsItsPromise) {
  const Robot& robot = GetParam();
  const Figures figures = measure(robot, 3, quickly);
  EXPECT_TRUE(figures.finite);
  for (size_t o = 0; o < figures.ulp.size(); ++o) EXPECT_LE(figures.ulp[o], robot.ulp) << robot.what << ": " << quantities[o];
  EXPECT_LE(figures.forward, 1) << robot.what << ": forward dynamics";
  EXPECT_FALSE(figures.reported) << robot.what << ": M counts as singular";
  if (robot.normalised > 0) {
    EXPECT_LE(figures.normalised[0], robot.normalised) << robot.what;
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, Catalogue, testing::ValuesIn(quick_robots()),
                         [](const testing::TestParamInfo<Robot>& info) { return info.param.name; });

}  // namespace
}  // namespace dalembert::extremes
