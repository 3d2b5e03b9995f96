// Which form is chosen, and when a task graph stands beside it.
#include "passes/plan.hpp"

#include <gtest/gtest.h>

#include "frontend/urdf_reader.hpp"
#include "passes/build_tree.hpp"

namespace dalembert::passes {
namespace {

ir::KinematicTree mahru() {
  Diagnostics warnings;
  return build_tree(frontend::read_urdf(MAHRU, warnings), {}, warnings);
}

// `operations`: those of the straight form.
ir::Plan plan_of(const ir::KinematicTree& tree, ir::Parallel parallel, long operations) {
  ir::Scene scene;
  scene.parallel = parallel;
  return plan(tree, scene, {.add = operations / 2, .multiply = operations / 2}, {});
}

TEST(Plan, ChoosesTasksWhereTheWorkIsWorthThem) {
  const ir::KinematicTree tree = mahru();
  EXPECT_FALSE(plan_of(tree, ir::Parallel::automatic, 400000).tasks);
  EXPECT_TRUE(plan_of(tree, ir::Parallel::automatic, 600000).tasks);
  EXPECT_FALSE(plan_of(tree, ir::Parallel::serial, 600000).tasks);
  EXPECT_TRUE(plan_of(tree, ir::Parallel::tasks, 1000).tasks);
}

TEST(Plan, RollsLargeCodeAndWhatRunsInTasks) {
  const ir::KinematicTree tree = mahru();
  EXPECT_EQ(plan_of(tree, ir::Parallel::automatic, 1000).form, ir::Form::straight);
  EXPECT_EQ(plan_of(tree, ir::Parallel::automatic, 10000).form, ir::Form::rolled);
  EXPECT_EQ(plan_of(tree, ir::Parallel::tasks, 1000).form, ir::Form::rolled);
}

// `limbs` on the base, of `joints` each.
ir::KinematicTree star(int limbs, int joints) {
  ir::KinematicTree tree;
  for (int limb = 0; limb < limbs; ++limb)
    for (int joint = 0; joint < joints; ++joint) {
      ir::Body body;
      body.joint = "j";
      body.parent = joint == 0 ? -1 : static_cast<int>(tree.bodies.size()) - 1;
      tree.bodies.push_back(body);
    }
  return tree;
}

TEST(Plan, LaysUpToEightLimbsSideBySide) {
  const auto widths = [](int limbs, int joints) {
    std::vector<int> found;
    for (const ir::Segment& s : plan_of(star(limbs, joints), ir::Parallel::automatic, 10000).segments) found.push_back(s.width);
    return found;
  };
  EXPECT_EQ(widths(3, 4), (std::vector{4}));
  EXPECT_EQ(widths(5, 4), (std::vector{8}));
  EXPECT_EQ(widths(8, 12), (std::vector{8}));
  EXPECT_EQ(widths(9, 4), (std::vector{8, 1}));
  EXPECT_EQ(widths(8, 13), (std::vector{4, 4})) << "long limbs stand by fours";
}

TEST(Plan, ComputesNoMoreLanesThanLimbsNeed) {
  const ir::Plan plan = plan_of(star(5, 2), ir::Parallel::automatic, 10000);
  const ir::Segment& s = plan.segments.front();
  EXPECT_EQ(s.limbs(), 5);
  EXPECT_EQ(s.computed(8), 8);
  EXPECT_EQ(s.computed(4), 5);
  EXPECT_EQ(s.computed(2), 5);
  EXPECT_EQ(s.computed_of_tiles(4), 8);
  EXPECT_EQ(s.computed_of_tiles(2), 6);
}

}  // namespace
}  // namespace dalembert::passes
