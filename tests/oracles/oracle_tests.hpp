// What every oracle's test program checks, written once: `make(case, tree)` builds the oracle with its gravity.
#pragma once

#include <gtest/gtest.h>

#include "agreement.hpp"
#include "load_robot.hpp"
#include "states.hpp"

namespace dalembert::oracle {

inline constexpr double tolerance = 1e-10;  // of the largest element
inline constexpr int states_per_case = 5;

// An engine of ours and the oracle agree in several random states.
template <class Oracle>
void expect_agreement(Oracle& oracle, const ir::KinematicTree& tree, const Engine& engine, double limit = tolerance) {
  for (int seed = 1; seed <= states_per_case; ++seed) {
    const testing::State state = testing::moderate_state(tree, static_cast<std::uint64_t>(seed));
    const Dynamics ours = engine(state.q, state.v);
    for (const Error& error : compare(ours, oracle.evaluate(state.q, state.v), testing::test_gravity, state.v)) {
      EXPECT_LE(error.value, limit) << error.quantity << ", state " << seed;
    }
  }
}

template <class Oracle>
void expect_agreement(Oracle& oracle, const ir::KinematicTree& tree, const Responder& respond, double limit = tolerance) {
  for (int seed = 1; seed <= states_per_case; ++seed) {
    const auto number = static_cast<std::uint64_t>(seed);
    const Question question = question_at(testing::moderate_state(tree, number), number);
    for (const Error& error : compare(respond(question), oracle.respond(question))) {
      EXPECT_LE(error.value, limit) << error.quantity << ", state " << seed;
    }
  }
}

// The comparison can fail: every mutation is noticed where it should be.
template <class Make>
void expect_mutations_noticed(const Make& make) {
  for (const Base base : {Base::floating, Base::fixed}) {
    const Case c = mutated_case(base);
    const ir::KinematicTree tree = tree_of(c);
    auto oracle = make(c, tree);
    const testing::State state = testing::moderate_state(tree, 1);
    const Dynamics right = oracle.evaluate(state.q, state.v);
    for (const Mutation& mutation : mutations(base)) {
      ir::KinematicTree wrong = tree;
      mutation.spoil(wrong);
      auto errors =
          compare(generic_engine(wrong, testing::test_gravity)(state.q, state.v), right, testing::test_gravity, state.v);
      const Question question = question_at(state, 1);
      const auto more = compare(generic_responder(wrong, testing::test_gravity)(question), oracle.respond(question));
      errors.insert(errors.end(), more.begin(), more.end());
      for (const char* quantity : mutation.noticed_in) {
        EXPECT_GT(error_in(errors, quantity), tolerance)
            << mutation.name << " is not noticed in " << quantity << ", " << name_of(c);
      }
    }
    if (base == Base::floating) {
      const Dynamics turned = in_world_axes(generic_engine(tree, testing::test_gravity)(state.q, state.v), state.q);
      for (const Error& error : compare(turned, right, testing::test_gravity, state.v)) {
        EXPECT_GT(error.value, 10 * tolerance) << "world axes are not noticed in " << error.quantity;
      }
    }
  }
}

inline std::string case_name(const ::testing::TestParamInfo<Case>& info) { return name_of(info.param); }

}  // namespace dalembert::oracle
