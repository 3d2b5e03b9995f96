// Lanes that nobody reads are not computed: of a robot with contacts on some of its legs, poses of these alone. That nothing
// else reads them, tests of both forms say: the interpreter leaves no numbers there.
#include "passes/live_lanes.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "both_forms.hpp"
#include "lower.hpp"

namespace dalembert {
namespace {

// Per leg that stands: its lanes as the loop over joints' axes has them, and how many legs it goes over.
struct Poses {
  std::vector<int> live;
  int limbs = 0;
  bool base_axes = false;  // whether the base's own, ones and zeros, are stored for it
};

Poses poses(const std::vector<const char*>& standing) {
  ir::Scene scene;
  scene.outputs = {ir::Quantity::constrained_inverse_dynamics};
  for (const char* leg : standing)
    scene.contacts.push_back({leg, std::string(leg) + "_3_shank", ir::ContactType::point, {0, 0, -0.2}, false});
  Model model = model_of(robot("quadruped"), scene);
  model.options.form = ir::Form::rolled;
  const Lowered lowered = lower(model);
  Poses found;
  for (const LoweredSection* section : lowered.all_sections()) {
    const auto is = [&](const ir::Store& store, const char* name) {
      return section->rolled.roles[static_cast<size_t>(store.to.role)].name == name;
    };
    for (const ir::SegmentCode& segment : section->rolled.segments)
      for (const ir::SegmentStage& stage : segment.stages)
        for (const ir::Paragraph& p : stage.paragraphs)
          for (const ir::Store& store : p.stores)
            if (is(store, "joint_linear")) found.live = p.live_lanes, found.limbs = p.loop.limbs;
    for (const ir::BaseStage& stage : section->rolled.base)
      for (const ir::Store& store : stage.stores) found.base_axes = found.base_axes || is(store, "rotation");
  }
  return found;
}

TEST(LiveLanes, AreThoseOfLegsThatStand) {
  const Poses all = poses({"front_left", "front_right", "hind_left", "hind_right"});
  EXPECT_EQ(all.live, (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(all.limbs, 4);
  const Poses front = poses({"front_left", "front_right"});
  EXPECT_EQ(front.live, (std::vector<int>{0, 1}));
  EXPECT_EQ(front.limbs, 2);
  const Poses hind = poses({"hind_left"});
  EXPECT_EQ(hind.live, (std::vector<int>{2}));
  EXPECT_EQ(hind.limbs, 3) << "those before the last that is read are computed beside it";
  EXPECT_FALSE(front.base_axes) << "known where they are read";
}

}  // namespace
}  // namespace dalembert
