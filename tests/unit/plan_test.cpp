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

}  // namespace
}  // namespace dalembert::passes
