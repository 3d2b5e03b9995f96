// The identities can fail: each wrong result below is caught by the identities named beside it.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "identities.hpp"
#include "load_robot.hpp"
#include "states.hpp"

namespace dalembert::testing {
namespace {

constexpr double tolerance = 1e-25;

const TestRobot& robot_named(const std::string& name) {
  return *std::find_if(std::begin(test_robots), std::end(test_robots), [&](const TestRobot& r) { return r.name == name; });
}

Dynamics evaluate(const Case& c) { return generic::evaluate<Multi>(c.model, c.q, c.v); }

// The result of a model that is wrong by one part in a million in one place.
Dynamics evaluate_wrong(const Case& c, const std::function<void(Model&)>& spoil) {
  Case wrong = c;
  spoil(wrong.model);
  return evaluate(wrong);
}

struct Mutation {
  const char* name;
  std::function<Dynamics(const Case&)> result;
  std::vector<const char*> caught_by;
};

const Multi small_factor = 1 + Multi("1e-6");

const Mutation mutations[] = {
    {"a body's mass",
     [](const Case& c) { return evaluate_wrong(c, [](Model& m) { m.bodies.back().inertia.mass *= small_factor; }); },
     {"mass rate", "bias", "mass columns", "gravity", "energy", "restatement"}},
    {"a body's inertia",
     [](const Case& c) { return evaluate_wrong(c, [](Model& m) { m.bodies.back().inertia.inertia *= small_factor; }); },
     {"bias", "mass columns", "energy", "restatement"}},
    {"a centre of mass",
     [](const Case& c) { return evaluate_wrong(c, [](Model& m) { m.bodies.back().inertia.com[1] *= small_factor; }); },
     {"bias", "mass columns", "gravity", "energy", "restatement"}},
    {"an inertia turned the wrong way",
     [](const Case& c) {
       return evaluate_wrong(c, [](Model& m) {
         Matrix3<Multi>& I = m.bodies.back().inertia.inertia;
         I = (m.bodies.back().rotation * I * m.bodies.back().rotation.transpose()).eval();
       });
     },
     {"bias", "mass columns", "energy", "restatement"}},
    {"a joint's axis reversed",
     [](const Case& c) { return evaluate_wrong(c, [](Model& m) { m.bodies.back().axis *= -1; }); },
     {"mass columns", "gravity", "wrench influence", "restatement"}},
    {"gravity's sign", [](const Case& c) { return evaluate_wrong(c, [](Model& m) { m.gravity *= -1; }); }, {"bias", "gravity"}},
    {"C transposed",
     [](const Case& c) {
       Dynamics result = evaluate(c);
       result.coriolis_matrix.transposeInPlace();
       return result;
     },
     {"bias", "restatement"}},
    {"one element of C reversed",
     [](const Case& c) {
       Dynamics result = evaluate(c);
       result.coriolis_matrix(result.coriolis_matrix.rows() - 1, 0) *= -1;
       return result;
     },
     {"mass rate", "bias", "restatement"}},
    {"C plus what neither C + Cᵀ nor C v shows",
     [](const Case& c) {
       Dynamics result = evaluate(c);
       const Vector3<Multi> v = c.v.tail<3>();
       result.coriolis_matrix.bottomRightCorner<3, 3>() += cross_matrix<Multi>(v) * Multi("1e-6");
       return result;
     },
     {"restatement"}},
    {"one element of M",
     [](const Case& c) {
       Dynamics result = evaluate(c);
       result.mass_matrix(0, result.mass_matrix.cols() - 1) *= small_factor;
       return result;
     },
     {"mass columns", "symmetry", "energy"}},
    {"M negative",
     [](const Case& c) {
       Dynamics result = evaluate(c);
       result.mass_matrix *= -1;
       return result;
     },
     {"definiteness", "mass columns", "energy"}},
    {"g without one joint",
     [](const Case& c) {
       Dynamics result = evaluate(c);
       result.gravity[result.gravity.size() - 1] = 0;
       return result;
     },
     {"bias", "gravity"}},
    {"bias without velocity",
     [](const Case& c) {
       Dynamics result = evaluate(c);
       result.bias = result.gravity;
       return result;
     },
     {"bias"}},
    {"two bodies of W exchanged",
     [](const Case& c) {
       Dynamics result = evaluate(c);
       result.wrench_influence.leftCols<6>().swap(result.wrench_influence.rightCols<6>());
       return result;
     },
     {"wrench influence"}},
    {"linear and angular parts of W exchanged",
     [](const Case& c) {
       Dynamics result = evaluate(c);
       result.wrench_influence.leftCols<3>().swap(result.wrench_influence.middleCols<3>(3));
       return result;
     },
     {"wrench influence"}},
    {"an element between two branches",
     [](const Case& c) {
       Dynamics result = evaluate(c);
       // branch_below_base: bodies 2, 3 are one branch and 4, 5, 6 the other.
       result.mass_matrix(c.model.base_rows() + 2, c.model.base_rows() + 5) = Multi("1e-300");
       return result;
     },
     {"sparsity"}},
};

// Needs a floating base.
const Mutation base_mutations[] = {
    {"the base's mass",
     [](const Case& c) { return evaluate_wrong(c, [](Model& m) { m.base.mass *= small_factor; }); },
     {"mass columns", "momentum", "momentum rate", "gravity", "energy", "restatement"}},
    {"base rows of C in world axes",
     [](const Case& c) {
       Dynamics result = evaluate(c);
       const Matrix3<Multi> R = world_poses(c.model, c.q)[0].rotation;
       result.coriolis_matrix.topRows<3>() = (R * result.coriolis_matrix.topRows<3>()).eval();
       return result;
     },
     {"mass rate", "bias", "momentum rate", "restatement"}},
    {"base rows of M in world axes",
     [](const Case& c) {
       Dynamics result = evaluate(c);
       const Matrix3<Multi> R = world_poses(c.model, c.q)[0].rotation;
       result.mass_matrix.topRows<3>() = (R * result.mass_matrix.topRows<3>()).eval();
       return result;
     },
     {"mass columns", "symmetry", "momentum"}},
};

void expect_caught(const Mutation& mutation, bool floating) {
  const ir::KinematicTree tree = load_robot(robot_named("branch_below_base"), floating);
  const State state = moderate_state(tree, 1);
  const Case right{exact_model(tree, test_gravity), exact_position(tree, state.q), state.v.cast<Multi>()};
  const Dynamics wrong = mutation.result(right);
  for (const char* name : mutation.caught_by) {
    const auto identity = std::find_if(std::begin(identities), std::end(identities),
                                       [&](const Identity& i) { return std::string(i.name) == name; });
    ASSERT_NE(identity, std::end(identities)) << name;
    const double limit = identity->error == sparsity_error ? 0 : tolerance;
    EXPECT_GT(identity->error(right, wrong), limit) << name << " does not notice: " << mutation.name;
  }
}

TEST(Mutations, AreCaughtWithAFixedBase) {
  for (const Mutation& mutation : mutations) expect_caught(mutation, false);
}

TEST(Mutations, AreCaughtWithAFloatingBase) {
  for (const Mutation& mutation : mutations) expect_caught(mutation, true);
  for (const Mutation& mutation : base_mutations) expect_caught(mutation, true);
}

TEST(Mutations, LeaveNoIdentityUntried) {
  for (const Identity& identity : identities) {
    const auto catches = [&](const Mutation& m) {
      return std::any_of(m.caught_by.begin(), m.caught_by.end(),
                         [&](const char* name) { return std::string(identity.name) == name; });
    };
    EXPECT_TRUE(std::any_of(std::begin(mutations), std::end(mutations), catches) ||
                std::any_of(std::begin(base_mutations), std::end(base_mutations), catches))
        << identity.name;
  }
}

}  // namespace
}  // namespace dalembert::testing
