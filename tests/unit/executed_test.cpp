// The count of operations that generated code executes, against generated code that counts: compiled with a Scalar that does
// (counting.hpp), in lanes of four.
#include "backend/executed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <ostream>
#include <robots.hpp>

#include "commands/compiler.hpp"
#include "compile.hpp"
#include "long_tests.hpp"

namespace dalembert {
namespace {

struct Case {
  const char *name, *robot, *form;
  std::vector<frontend::Setting> settings;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

const char* const everything = "mass_matrix,coriolis_matrix,gravity,bias,wrench_influence";

const Case cases[] = {
    {"mahru", "mahru", "", {{"base", "floating"}, {"outputs", everything}}},
    {"mahru_on_a_stand", "mahru", "rolled", {{"base", "fixed"}, {"outputs", everything}}},
    {"mahru_with_all",
     "mahru",
     "rolled",
     {{"outputs", everything},
      {"payloads", "left_hand"},
      {"jacobians", "left_foot"},
      {"gravity", "run_time"},
      {"armature", "left_knee=0.1,waist=0.2"},
      {"stiffness", "{waist: {k: 40, rest: 0.1}}"},
      {"damping", "left_knee=0.1"},  // no friction: the sign it is multiplied with is a whole number, which does not count
      {"mimic", "{right_elbow: {of: left_elbow}, left_knee: {of: right_hip_yaw, multiplier: 0.5, offset: 0.1}}"}}},
    {"inverse_dynamics", "mahru", "rolled", {{"outputs", "inverse_dynamics"}}},
    {"springs",
     "mahru",
     "rolled",
     {{"outputs", "bias,potential_energy,inverse_dynamics_dq"}, {"stiffness", "left_knee=40,waist=9"}}},
    {"straight_springs",
     "chain_7",
     "straight",
     {{"outputs", "bias,potential_energy"}, {"stiffness", "{link_03_joint: {k: 40, rest: 0.1}}"}}},
    {"forward_dynamics", "mahru", "rolled", {{"outputs", "forward_dynamics"}}},
    {"pushed",
     "mahru",
     "rolled",
     {{"outputs", "inverse_dynamics,inverse_dynamics_dq,forward_dynamics"}, {"wrenches", "left_hand=world,right_foot=link"}}},
    {"straight_forward_dynamics", "chain_7", "straight", {{"outputs", "forward_dynamics"}}},
    {"inverse_dynamics_dq", "mahru", "rolled", {{"outputs", "inverse_dynamics_dq"}}},
    {"inverse_mass_matrix", "mahru", "rolled", {{"outputs", "inverse_mass_matrix"}}},
    {"forward_dynamics_dq", "quadruped", "rolled", {{"outputs", "forward_dynamics_dq"}}},
    {"small_inverse_mass_matrix", "pendulum", "straight", {{"base", "fixed"}, {"outputs", "inverse_mass_matrix"}}},
    {"factored", "mahru", "rolled", {{"outputs", "mass_matrix_factor,inverse_mass_matrix"}}},
    {"forward_dynamics_by_factors",
     "mahru",
     "rolled",
     {{"outputs", "forward_dynamics"}, {"forward_dynamics", "factorization"}}},
    {"forward_dynamics_driven",
     "mahru",
     "rolled",
     {{"outputs", "forward_dynamics"},
      {"mimic", "{right_elbow: {of: left_elbow}, left_knee: {of: right_hip_yaw, multiplier: 0.5, offset: 0.1}}"}}},
    {"derivatives_driven",
     "quadruped",
     "rolled",
     {{"outputs", "forward_dynamics_dq,forward_dynamics_dv"},
      {"mimic", "{hind_left_2_thigh_joint: {of: front_left_2_thigh_joint, multiplier: 2}}"}}},
    {"straight_derivatives_driven",
     "chain_7",
     "straight",
     {{"outputs", "forward_dynamics,forward_dynamics_dq"}, {"mimic", "{link_03_joint: {of: link_05_joint, multiplier: 2}}"}}},
    {"straight_forward_dynamics_by_factors",
     "chain_7",
     "straight",
     {{"outputs", "forward_dynamics"}, {"forward_dynamics", "factorization"}}},
    {"humanoid_55", "humanoid_55", "", {{"outputs", "mass_matrix,coriolis_matrix"}}},
    {"straight_arm", "chain_7", "straight", {{"outputs", everything}}},
    {"straight_arm_driven", "chain_7", "straight", {{"mimic", "{link_03_joint: {of: link_05_joint, multiplier: 2}}"}}},
    {"rolled_arm", "chain_7", "rolled", {{"outputs", everything}}},
    {"rolled_arm_driven", "chain_7", "rolled", {{"mimic", "{link_03_joint: {of: link_05_joint, multiplier: 2}}"}}},
    {"long_chain", "chain_50", "rolled", {{"base", "fixed"}, {"outputs", everything}}},
    {"long_floating_chain", "chain_50", "rolled", {{"base", "floating"}, {"outputs", "mass_matrix,coriolis_matrix"}}},
    {"slides", "gantry_arms", "rolled", {{"outputs", everything}, {"base", "fixed"}}},
    {"fingers", "hand", "rolled", {{"base", "fixed"}}},
    {"legs", "hexapod", "rolled", {{"outputs", everything}}},
    {"loop_of_driven_arms",
     "mahru",
     "rolled",
     {{"outputs", "constraint_jacobian"},
      {"loops", "{grip: {links: [left_hand, right_hand], type: point}}"},
      {"mimic", "{right_elbow: {of: left_elbow}}"}}},
};

Model model_of(const Case& c) {
  Request request;
  const auto robot = std::find_if(std::begin(test_robots), std::end(test_robots),
                                  [&](const TestRobot& r) { return std::string(r.name) == c.robot; });
  request.robot = robot->urdf;
  request.name = "counting";
  request.form = c.form;
  request.settings = c.settings;
  Diagnostics warnings;
  return read_model(request, warnings);
}

std::string text_of(const std::string& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

// add, multiply, divide, sincos of one evaluation.
std::array<long, 4> counted(const Model& model) {
  std::vector<backend::OutputFile> files;
  for (backend::OutputFile file : compile_without_self_test(model)) {
    if (file.name == "dynamics.hpp") {
      const std::string scalar = "using Scalar = double;";
      file.text.replace(file.text.find(scalar), scalar.size(), "using Scalar = dalembert::Counted;");
      file.text.insert(file.text.find("#include"), "#include \"counting.hpp\"\n");
    }
    if (file.name.starts_with("dynamics.")) files.push_back(file);
  }
  files.push_back({"counting.hpp", text_of(COUNTING)});
  const std::string function = lower(model).functions.front().name();
  files.push_back({"count.cpp", "#define CALL " + function + (function == "evaluate" ? "(q, v" : "(q, v, v") + R"(, workspace)
#include "dynamics.hpp"

extern "C" void count(long* counts) {
  static counting::Workspace workspace;
  static counting::Scalar q[counting::nq], v[counting::nv];
  for (int i = 0; i < counting::nq; ++i) q[i] = 0.1 * i;
  for (int i = 0; i < counting::nv; ++i) v[i] = 1 - 0.1 * i;
  using C = dalembert::Counted;
  const long before[] = {C::add, C::multiply, C::divide, C::sincos};
  counting::CALL;
  const long after[] = {C::add, C::multiply, C::divide, C::sincos};
  for (int i = 0; i < 4; ++i) counts[i] = after[i] - before[i];
}
)"});
  CompilerOptions options;
  options.flags = "-O0 -std=c++17 " PRECOMPILED_EIGEN;
#if defined(__x86_64__)
  options.flags += " -mavx";  // limbs side by side are computed by fours as well
#endif
  options.lanes = backend::counted_lanes;
  const LoadedCode code("counting", files, options);
  std::array<long, 4> counts{};
  code.function<void(long*)>("count")(counts.data());
  return counts;
}

class Executed : public ::testing::TestWithParam<Case> {};

TEST_P(Executed, IsWhatTheCodeCounts) {
  const Model model = model_of(GetParam());
  const Lowered lowered = lower(model);
  const ir::Operations said = executed_operations(model, lowered).front().second;
  const std::array<long, 4> counts = counted(model);
  EXPECT_EQ(said.add, counts[0]);
  EXPECT_EQ(said.multiply, counts[1]);
  EXPECT_EQ(said.divide, counts[2]);
  EXPECT_EQ(said.sincos, counts[3]);
}

INSTANTIATE_TEST_SUITE_P(Robots, Executed,
                         ::testing::ValuesIn(one_in(3, std::vector<Case>(std::begin(cases), std::end(cases)))),
                         [](const ::testing::TestParamInfo<Case>& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace dalembert
