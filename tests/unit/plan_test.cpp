// Which forms come into question, and how limbs stand side by side.
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
std::vector<ir::Form> forms_of(const ir::KinematicTree& tree, ir::Parallel parallel, long operations) {
  ir::Scene scene;
  scene.parallel = parallel;
  return forms(tree, scene, {.add = operations / 2, .multiply = operations / 2}, {});
}

TEST(Plan, ComparesFormsButOfLargeCodeAndWhatRunsInTasks) {
  const ir::KinematicTree tree = mahru();
  EXPECT_EQ(forms_of(tree, ir::Parallel::automatic, 10000), (std::vector{ir::Form::straight, ir::Form::rolled}));
  EXPECT_EQ(forms_of(tree, ir::Parallel::automatic, 100000), std::vector{ir::Form::rolled});
  EXPECT_EQ(forms_of(tree, ir::Parallel::tasks, 1000), std::vector{ir::Form::rolled});
  EXPECT_EQ(forms_of({}, ir::Parallel::automatic, 1000), std::vector{ir::Form::straight});
}

// Limbs on the base, of so many joints.
ir::KinematicTree star(const std::vector<int>& lengths) {
  ir::KinematicTree tree;
  for (const int joints : lengths)
    for (int joint = 0; joint < joints; ++joint) {
      ir::Body body;
      body.joint = "j";
      body.parent = joint == 0 ? -1 : static_cast<int>(tree.bodies.size()) - 1;
      tree.bodies.push_back(body);
    }
  return tree;
}
ir::KinematicTree star(int limbs, int joints) { return star(std::vector(static_cast<size_t>(limbs), joints)); }

std::vector<int> limbs_side_by_side(const ir::KinematicTree& tree) {
  std::vector<int> found;
  for (const ir::Segment& s : plan(tree, {}, ir::Form::rolled, {}).segments) found.push_back(s.limbs());
  return found;
}

TEST(Plan, LaysUpToEightLimbsSideBySide) {
  EXPECT_EQ(limbs_side_by_side(star(3, 4)), (std::vector{3}));
  EXPECT_EQ(limbs_side_by_side(star(5, 4)), (std::vector{5}));
  EXPECT_EQ(limbs_side_by_side(star(8, 12)), (std::vector{8}));
  EXPECT_EQ(limbs_side_by_side(star(9, 4)), (std::vector{8, 1}));
  EXPECT_EQ(limbs_side_by_side(star(8, 13)), (std::vector{4, 4})) << "long limbs stand by fours";
}

TEST(Plan, LaysUnlikeLimbsSideBySideWhereRegistersHaveRoom) {
  EXPECT_EQ(limbs_side_by_side(star({7, 2})), (std::vector{2})) << "two limbs, whatever their lengths";
  EXPECT_EQ(limbs_side_by_side(star({6, 6, 10, 10})), (std::vector{4})) << "four, of half the length";
  EXPECT_EQ(limbs_side_by_side(star({3, 3, 7, 7})), (std::vector{2, 2})) << "but no shorter";
  EXPECT_EQ(limbs_side_by_side(star({3, 3, 3, 3, 6})), (std::vector{1, 4})) << "none is taken out of its group";
  EXPECT_EQ(limbs_side_by_side(star({13, 2})), (std::vector{1, 1})) << "and none joins a long limb";
}

TEST(Plan, HasTilesOfWholeRegisters) {
  const ir::Plan plan = passes::plan(star(5, 2), {}, ir::Form::rolled, {});
  const ir::Segment& s = plan.segments.front();
  EXPECT_EQ(s.limbs(), 5);
  EXPECT_EQ(s.computed_of_tiles(4), 8);
  EXPECT_EQ(s.computed_of_tiles(2), 6);
}

}  // namespace
}  // namespace dalembert::passes
