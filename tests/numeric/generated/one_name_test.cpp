// Two uses of a robot under one name in one program: each library gets the numbers of its own.
#include <gtest/gtest.h>

template <int locked>
double inertia_of_first_joint();
template <int locked>
double inertia_in_batch();
template <int locked>
bool passes_self_test();

// All that moves, 4.3 kg and more, turns about the first joint; without its link and nearer to the axis about the second.
TEST(OneName, IsTwoRobotsInTwoLibraries) {
  EXPECT_GT(inertia_of_first_joint<2>(), 1.3 * inertia_of_first_joint<1>());
  EXPECT_GT(inertia_of_first_joint<1>(), 0);
}

TEST(OneName, HasBatchesAndSelfTestsOfItsOwn) {
  EXPECT_DOUBLE_EQ(inertia_in_batch<1>(), inertia_of_first_joint<1>());
  EXPECT_DOUBLE_EQ(inertia_in_batch<2>(), inertia_of_first_joint<2>());
  EXPECT_TRUE(passes_self_test<1>());
  EXPECT_TRUE(passes_self_test<2>());
}
