// `info --dump`: every stage is shown, and after it the effect of every pass.
#include "commands/dump.hpp"

#include <gtest/gtest.h>

#include "read_robot.hpp"

namespace dalembert {
namespace {

void expect_in_order(const std::string& text, std::initializer_list<const char*> parts) {
  size_t at = 0;
  for (const char* part : parts) {
    at = text.find(part, at);
    ASSERT_NE(at, text.npos) << part << " in\n" << text;
  }
}

TEST(Dump, EndsWithTheEffectOfTheSceneAndEveryPassWhateverTheStage) {
  const Model model = read_robot("quadruped", {{"outputs", "gravity"}}, "");
  for (size_t stage = 0; stage < std::size(stage_names); ++stage)
    expect_in_order(dump(model, static_cast<Stage>(stage)), {"\noperations of all outputs after", "\nthe whole URDF",
                                                             "\n+ scene", "\n+ fold", "\n+ share", "\n+ move_parameters"});
}

TEST(Dump, LeavesOutThePassesThatWereLeftOut) {
  Model model = read_robot("quadruped", {}, "");
  model.options.share = false;
  EXPECT_EQ(dump(model, Stage::plan).find("+ share"), std::string::npos);
}

TEST(Dump, ShowsWhatEachStageIsMadeOf) {
  const Model rolled = read_robot("quadruped", {}, "rolled"), straight = read_robot("quadruped", {}, "straight");
  expect_in_order(dump(rolled, Stage::tree), {" base ", "axis [", "mass "});
  expect_in_order(dump(rolled, Stage::normal_tree), {"rotation [", "half trace", "second ["});
  expect_in_order(dump(rolled, Stage::program), {"= input q[", "phase 1", "mass_matrix(0, 0) = %"});
  expect_in_order(dump(rolled, Stage::plan), {"rolled form, serial", "segment ", "lane 0 on base"});
  expect_in_order(dump(rolled, Stage::rolled), {"segment ", "constants per slot", "level 0, outwards", "R = Rp Rk Rz(q)",
                                                "level 1, inwards", "M_ik = F_k.J_i", "blocks of ", "with itself"});
  expect_in_order(dump(straight, Stage::plan), {"straight form"});
  const Model standing = read_robot(
      "quadruped", {{"outputs", "constrained_forward_dynamics"}, {"contacts", "front_left_3_shank=point"}}, "rolled");
  expect_in_order(dump(standing, Stage::rolled), {"segment ", "kernel solve_constrained", "\n  pivots is ",
                                                  "\n  to is constrained_forward_dynamics: the result"});
  expect_in_order(dump(straight, Stage::rolled), {"straight form: no loops"});
}

}  // namespace
}  // namespace dalembert
