// Generated code against the generic engine, and what generated code promises: repeatable bits, no heap, no needless reads.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <set>

#include "generated_robot.hpp"
#include "heap_count.hpp"
#include "pipeline.hpp"
#include "reference/engine.hpp"
#include "scale.hpp"
#include "states.hpp"

namespace dalembert::testing {
namespace {

// Relative to the largest element of each quantity. In float, rounding of constants and of the computation adds
// up along a chain: the tolerance is a thousand times float's epsilon.
constexpr double tolerance_double = 1e-12, tolerance_float = 1.2e-4;

Model read_case(const GeneratedCase& generated) {
  Request request;
  request.robot = generated.urdf;
  request.name = generated.name;
  for (const auto& [key, value] : generated.settings) request.settings.push_back({key, value});
  Diagnostics warnings;
  return read_model(request, warnings);
}

class Generated : public ::testing::TestWithParam<GeneratedCase> {
 protected:
  Generated() : model(read_case(GetParam())), robot(GetParam().make()) {}

  void evaluate(const State& state, Variant variant) {
    robot->set_state(state.q, state.v);
    robot->evaluate(variant);
  }
  // Moderate and extreme states, in numbers the robot's scalar can hold.
  std::vector<State> states() const {
    std::vector<State> all = extreme_states(model.tree);
    for (std::uint64_t seed = 1; seed <= 5; ++seed) all.push_back(moderate_state(model.tree, seed));
    if (robot->single_precision())
      for (State& state : all) {
        state.q = state.q.cast<float>().cast<double>().eval();
        state.v = state.v.cast<float>().cast<double>().eval();
      }
    return all;
  }
  bool floating() const { return model.tree.base_coordinates() > 0; }

  const Model model;
  const std::unique_ptr<GeneratedRobot> robot;
};

// The robots that have a task graph beside the serial code.
class GeneratedTasks : public Generated {};

// By how much more than other quantities' a result may be off: what is solved for errs with M's condition.
double magnification(const Model& model, const reference::Inputs& inputs, ir::Quantity quantity) {
  if (ir::row_of(quantity).scale != ir::Scale::solved) return 1;
  const bool single = model.scene.scalar == ir::ScalarType::float32;
  const double rounding = single ? 0x1p-24 / tolerance_float : 0x1p-53 / tolerance_double;
  return std::max(1.0, 10 * reference::mass_condition(model.tree, model.scene, inputs) * rounding);
}

// Largest error of any quantity the scene asks for, relative to its largest element in `right` and to what it counts as at
// least; infinite where one is missing or of another shape.
double largest_error(const Results& ours, const Results& right, const Model& model, const State& state) {
  const reference::Inputs inputs{state.q, state.v};
  reference::LeastScale least(model.tree, model.scene, inputs);
  double worst = 0;
  for (const ir::Quantity quantity : model.scene.outputs) {
    const auto generated = ours.find(ir::row_of(quantity).name);
    const Eigen::MatrixXd& reference = right.at(ir::row_of(quantity).name);
    const bool same_shape =
        generated != ours.end() && generated->second.rows() == reference.rows() && generated->second.cols() == reference.cols();
    const double scale = std::max(largest(reference), least.of({quantity, ""})) * magnification(model, inputs, quantity);
    worst = std::max(
        worst, same_shape ? relative_error(generated->second, reference, scale) : std::numeric_limits<double>::infinity());
  }
  return worst;
}

Results generic_results(const Model& model, const State& state) {
  std::vector<reference::Wanted> wanted;
  for (const ir::Quantity quantity : model.scene.outputs) wanted.push_back({quantity, ""});
  const auto values = reference::evaluate(model.tree, model.scene, wanted, {state.q, state.v}, reference::Precision::float64);
  Results results;
  for (size_t i = 0; i < wanted.size(); ++i) results[ir::row_of(*wanted[i].quantity).name] = values[i];
  return results;
}

TEST_P(Generated, MatchesTheGenericEngine) {
  ASSERT_EQ(robot->nq(), model.tree.nq());
  ASSERT_EQ(robot->nv(), model.tree.nv());
  const double tolerance = robot->single_precision() ? tolerance_float : tolerance_double;
  double worst = 0;
  for (const State& state : states()) {
    evaluate(state, Variant::serial);
    const double error = largest_error(robot->results(Variant::serial), generic_results(model, state), model, state);
    EXPECT_EQ(robot->results(Variant::serial).size(), model.scene.outputs.size());
    EXPECT_LE(error, tolerance) << state.name;
    worst = std::max(worst, error);
  }
  std::printf("largest error %.2g\n", worst);
}

TEST_P(Generated, NamesJointsAndBodiesInOrder) {
  std::vector<std::string> joints, bodies;
  if (floating()) bodies.push_back(model.tree.base_link);
  for (const ir::Body& body : model.tree.bodies) {
    if (!body.driven()) joints.push_back(body.joint);
    bodies.push_back(body.name);
  }
  EXPECT_EQ(robot->joint_names(), joints);
  EXPECT_EQ(robot->body_names(), bodies);
}

TEST_P(Generated, GivesTheSameBitsEveryTime) {
  const State one = moderate_state(model.tree, 1), other = moderate_state(model.tree, 2);
  evaluate(one, Variant::serial);
  const auto first = robot->bits(Variant::serial);
  ASSERT_FALSE(first.empty());
  evaluate(one, Variant::serial);
  EXPECT_EQ(robot->bits(Variant::serial), first) << "evaluated twice";
  evaluate(other, Variant::serial);
  evaluate(one, Variant::serial);
  EXPECT_EQ(robot->bits(Variant::serial), first) << "after another state";
  robot->renew_workspaces();
  evaluate(one, Variant::serial);
  EXPECT_EQ(robot->bits(Variant::serial), first) << "in another workspace";
}

TEST_P(GeneratedTasks, GiveTheSameBitsAsSerial) {
  for (const State& state : states())
    for (int repetition = 0; repetition < 3; ++repetition) {
      evaluate(state, Variant::serial);
      evaluate(state, Variant::tasks);
      ASSERT_EQ(robot->bits(Variant::tasks), robot->bits(Variant::serial)) << state.name;
    }
}

// Right code passes, on every robot and in float, and with room to spare: what is allowed is many times the worst error.
TEST_P(Generated, PassesItsSelfTest) {
  SelfTestReport report;
  const std::uint64_t before = heap_allocations();
  const bool passed = robot->self_test(report);
  EXPECT_EQ(heap_allocations() - before, 0u);
  char text[512];
  describe(report, text, sizeof text);
  EXPECT_TRUE(passed) << text;
  EXPECT_LE(8 * report.error, report.tolerance) << text;
  std::printf("%s\n", text);
}

TEST_P(Generated, SerialEvaluationNeverAllocates) {
  const State state = moderate_state(model.tree, 1);
  robot->set_state(state.q, state.v);
  const std::uint64_t before = heap_allocations();
  for (int i = 0; i < 10; ++i) robot->evaluate(Variant::serial);
  EXPECT_EQ(heap_allocations() - before, 0u);
}

// oneTBB owns its memory, and how much it takes is no promise but a report; later evaluations do without, but for a few.
TEST_P(GeneratedTasks, DoNotAllocateMoreAndMore) {
  const State state = moderate_state(model.tree, 1);
  robot->set_state(state.q, state.v);
  const std::uint64_t start = heap_allocations();
  robot->evaluate(Variant::tasks);
  const std::uint64_t first = heap_allocations();
  for (int i = 0; i < 100; ++i) robot->evaluate(Variant::tasks);
  const double later = static_cast<double>(heap_allocations() - first) / 100;
  std::printf("task graph: %llu allocations in the first evaluation, %.2f in each later one\n",
              static_cast<unsigned long long>(first - start), later);
  EXPECT_LT(later, 1);
}

// Values that cannot matter are not read: a NaN in their place changes no bit.
TEST_P(Generated, ReadsNothingItDoesNotNeed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const State state = moderate_state(model.tree, 1);
  evaluate(state, Variant::serial);
  const auto expected = robot->bits(Variant::serial);
  const auto asked = [&](const std::set<std::string>& any) {
    return std::any_of(model.scene.outputs.begin(), model.scene.outputs.end(),
                       [&](ir::Quantity quantity) { return any.contains(ir::row_of(quantity).name); });
  };
  const bool rates = asked({"coriolis_matrix", "bias", "kinetic_energy", "momentum_bias", "center_of_mass_bias"});
  const bool base_position = asked({"potential_energy", "center_of_mass"});
  const bool world = asked({"gravity", "bias", "potential_energy", "center_of_mass", "center_of_mass_jacobian",
                            "momentum_matrix", "momentum_bias", "center_of_mass_bias"});
  const bool in_base = asked({"wrench_influence"});
  const auto expect_unread = [&](const State& spoilt, const char* what) {
    evaluate(spoilt, Variant::serial);
    EXPECT_EQ(robot->bits(Variant::serial), expected) << what;
  };

  State spoilt = state;
  if (!rates) {
    spoilt.v.setConstant(nan);
    expect_unread(spoilt, "the velocity");
  }
  if (floating()) {
    if (!base_position) {
      spoilt = state;
      spoilt.q.head<3>().setConstant(nan);
      expect_unread(spoilt, "the base's position");
    }
    if (!world) {
      spoilt = state;
      spoilt.q.head<7>().setConstant(nan);
      expect_unread(spoilt, "the base's pose");
    }
  } else if (!world && !in_base) {
    // M and C of a limb on the ground do not depend on where its first joint stands, nor on slides with only slides before
    // them.
    spoilt = state;
    std::vector<bool> only_slides;
    for (size_t k = 0; k < model.tree.bodies.size(); ++k) {
      const int parent = model.tree.bodies[k].parent;
      only_slides.push_back(!model.tree.bodies[k].turns() && (parent < 0 || only_slides[static_cast<size_t>(parent)]));
      if (parent < 0 || only_slides[k]) spoilt.q[static_cast<Eigen::Index>(k)] = nan;
    }
    expect_unread(spoilt, "the first joints' positions");
  }
}

std::string name_of(const ::testing::TestParamInfo<GeneratedCase>& info) { return info.param.name; }

std::vector<GeneratedCase> cases_with_tasks() {
  std::vector<GeneratedCase> cases;
  for (const GeneratedCase& one : generated_cases())
    if (one.make()->has_tasks()) cases.push_back(one);
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Robots, Generated, ::testing::ValuesIn(generated_cases()), name_of);
INSTANTIATE_TEST_SUITE_P(Robots, GeneratedTasks, ::testing::ValuesIn(cases_with_tasks()), name_of);

// The comparison can fail: an error of 1e-11 of the largest element, a missing row and a NaN are all seen.
TEST(GeneratedChecks, SeeWrongResults) {
  const GeneratedCase& one = generated_cases().front();
  const Model model = read_case(one);
  const State state = moderate_state(model.tree, 1);
  const Results right = generic_results(model, state);
  EXPECT_EQ(largest_error(right, right, model, state), 0);
  const auto error = [&](auto spoil) {
    Results wrong = right;
    spoil(wrong);
    return largest_error(wrong, right, model, state);
  };
  EXPECT_GT(error([](auto& d) { d["mass_matrix"](0, 0) += 1e-11 * largest(d["mass_matrix"]); }), tolerance_double);
  EXPECT_GT(error([](auto& d) { d["bias"] *= -1; }), tolerance_double);
  EXPECT_GT(error([](auto& d) { d["gravity"](0) = std::nan(""); }), tolerance_double);
  EXPECT_GT(error([](auto& d) { d["wrench_influence"](0, 0) = std::nan(""); }), tolerance_double);
  EXPECT_GT(error([](auto& d) { d.erase("kinetic_energy"); }), tolerance_double);
  EXPECT_GT(error([](auto& d) { d["coriolis_matrix"].conservativeResize(d["coriolis_matrix"].rows() + 1, Eigen::NoChange); }),
            tolerance_double);
}

// The trap sees every road to the heap. (Called through volatile pointers: compilers leave out what is freed unused.)
TEST(GeneratedChecks, HeapIsTrapped) {
  void* (*volatile const by_malloc)(size_t) = std::malloc;
  void* (*volatile const by_calloc)(size_t, size_t) = std::calloc;
  void* (*volatile const by_realloc)(void*, size_t) = std::realloc;
  void* (*volatile const by_aligned_alloc)(size_t, size_t) = std::aligned_alloc;
  void* (*volatile const by_new)(size_t) = ::operator new;
  const auto allocates = [](auto action) {
    const std::uint64_t before = heap_allocations();
    void* memory = action();
    const std::uint64_t after = heap_allocations();
    std::free(memory);
    return after > before;
  };
  EXPECT_TRUE(allocates([&] { return by_malloc(8); }));
  EXPECT_TRUE(allocates([&] { return by_calloc(1, 8); }));
  EXPECT_TRUE(allocates([&] { return by_realloc(nullptr, 8); }));
#ifndef __SANITIZE_THREAD__  // which tells its hooks nothing of this one
  EXPECT_TRUE(allocates([&] { return by_aligned_alloc(64, 64); }));
#else
  static_cast<void>(by_aligned_alloc);
#endif
  const std::uint64_t before = heap_allocations();
  ::operator delete(by_new(8));
  EXPECT_EQ(heap_allocations() - before, 1u);
}

}  // namespace
}  // namespace dalembert::testing
