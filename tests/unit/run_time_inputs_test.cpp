// What a scene has given at run time: the table that declarations, batches and interfaces are made of.
#include "ir/run_time_inputs.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace dalembert::ir {
namespace {

Scene scene() {
  Scene scene;
  scene.gravity_kind = GravityKind::run_time;
  scene.payloads = {"left hand"};
  scene.wrenches = {{"tool", true}, {"foot", false}};
  scene.contacts = {Contact{"sole", "foot", ContactType::point}};
  Loop& rod = scene.loops.emplace_back();
  rod.name = "rod", rod.links = {"a", "b"}, rod.type = LoopType::hinge;
  return scene;
}

TEST(RunTimeInputs, StandInOneOrder) {
  std::vector<std::string> names, each;
  for (const RunTimeInput& input : run_time_inputs(scene())) names.push_back(input.name), each.push_back(input.each);
  EXPECT_EQ(names, (std::vector<std::string>{"gravity_vector", "payload_left_hand", "wrench_tool", "wrench_foot",
                                             "contact_sole", "loop_rod"}));
  EXPECT_EQ(each, (std::vector<std::string>{"gravity_vectors", "payloads_left_hand", "wrenches_tool", "wrenches_foot",
                                            "contacts_sole", "loops_rod"}));
  EXPECT_TRUE(run_time_inputs(Scene{}).empty());
}

TEST(RunTimeInputs, HaveANumberToStartWithForEachOfTheirMembers) {
  for (const RunTimeInput& input : run_time_inputs(scene())) {
    int numbers = 0;
    for (const RunTimeInput::Member& member : input.members) {
      numbers += member.count();
      EXPECT_TRUE(member.name == input.name || member.name.starts_with(input.name + ".")) << member.name;
    }
    EXPECT_EQ(numbers, input.size()) << input.name;
    const int behind = input.kind == InputKind::constraint ? input.size() - 1 : input.size();
    EXPECT_NE(input.element(behind - 1), "") << input.name;
    EXPECT_EQ(input.element(behind), "") << input.name;
  }
}

// Programs know them by components: builders of sweeps number these, and whoever prints or reads a program looks them up.
TEST(RunTimeInputs, ElementsAreWhatProgramsKnowByComponents) {
  const auto element = [&](InputKind kind, int index, int component) {
    const RunTimeInput input = run_time_input(scene(), {kind, index, component});
    EXPECT_EQ(input.kind, kind);
    EXPECT_EQ(input.index, index);
    return input.element(component);
  };
  EXPECT_EQ(element(InputKind::gravity, 0, 2), "gravity_vector[2]");
  EXPECT_EQ(element(InputKind::payload, 0, 0), "payload_left_hand.mass");
  EXPECT_EQ(element(InputKind::payload, 0, 3), "payload_left_hand.com[2]");
  EXPECT_EQ(element(InputKind::payload, 0, 4), "payload_left_hand.inertia[0]");
  EXPECT_EQ(element(InputKind::wrench, 1, 5), "wrench_foot[5]");
  EXPECT_EQ(element(InputKind::constraint, 0, contact_kp), "contact_sole.kp");
  EXPECT_EQ(element(InputKind::constraint, 0, contact_kd), "contact_sole.kd");
  EXPECT_EQ(element(InputKind::constraint, 0, contact_restitution), "contact_sole.restitution");
  EXPECT_EQ(element(InputKind::constraint, 0, contact_anchor + 6), "contact_sole.anchor[6]");
  EXPECT_EQ(element(InputKind::constraint, 0, contact_active), "contact_sole.active");
  EXPECT_EQ(element(InputKind::constraint, 0, contact_rows + 2), "contact_sole.regularization[2]");
  EXPECT_EQ(element(InputKind::constraint, 1, contact_kd), "loop_rod.kd");
  EXPECT_EQ(element(InputKind::constraint, 1, loop_rows), "loop_rod.regularization[0]");
  EXPECT_THROW(run_time_input(scene(), {InputKind::velocity, 0, 0}), std::logic_error);
}

}  // namespace
}  // namespace dalembert::ir
