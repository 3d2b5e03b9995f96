// How far we are from an oracle, quantity by quantity; and wrong versions of us, each of which an oracle must notice.
#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "ir/kinematic_tree.hpp"
#include "oracle.hpp"
#include "robots.hpp"
#include "states.hpp"

namespace dalembert::oracle {

// A test robot and what is done with its root: the parameter of every oracle test.
struct Case {
  TestRobot robot;
  Base base = Base::floating;
};
std::vector<Case> all_cases();
std::string name_of(const Case& c);  // an identifier: "wam_fixed"
inline void PrintTo(const Case& c, std::ostream* out) { *out << name_of(c); }

ir::KinematicTree tree_of(const Case& c);
Request request_of(const Case& c, const ir::KinematicTree& tree, const Eigen::Vector3d& gravity);

// One of our two engines: answers (double) in an oracle's terms, C v from C itself, momentum from M's base rows.
using Engine = std::function<Dynamics(const Eigen::VectorXd& q, const Eigen::VectorXd& v)>;
Engine generic_engine(const ir::KinematicTree& tree, const Eigen::Vector3d& gravity);
// Whether there is such code: outside of the long run each robot's is compiled for one base.
bool code_is_expected(const Case& c);
// The code generated for the case, with testing::test_gravity; the library that generated_test also tests. Serial: the task
// graph gives the same bits, as generated_test shows.
Engine generated_engine(const Case& c);

WholeRobot generic_whole_robot(const ir::KinematicTree& tree, const Eigen::Vector3d& gravity, const Eigen::VectorXd& q,
                               const Eigen::VectorXd& v);

// The generic engine's answers (double).
using Responder = std::function<Response(const Question&)>;
Responder generic_responder(const ir::KinematicTree& tree, const Eigen::Vector3d& gravity);
Question question_at(const testing::State& state, std::uint64_t seed);  // accelerations, efforts and wrench within ±2

struct Error {
  const char* quantity;  // "M", "C v", "g", "bias", "momentum"; "inverse dynamics", "forward dynamics", "inverse of M"
  double value;          // largest difference, relative to the oracle's largest element
};
// A vector of nothing but rounding (g of a joint parallel to gravity) is measured against what a thousandth of the robot's
// inertia would need, so that rounding is not divided by rounding. Infinite when a number of ours is not finite.
std::vector<Error> compare(const Dynamics& ours, const Dynamics& oracle, const Eigen::Vector3d& gravity,
                           const Eigen::VectorXd& v);
std::vector<Error> compare(const Response& ours, const Response& oracle);
std::vector<Error> compare(const WholeRobot& ours, const WholeRobot& oracle);
double error_in(const std::vector<Error>& errors, const std::string& quantity);

// A slip such as a front end or an engine could make, small or only of sign.
struct Mutation {
  const char* name;
  std::function<void(ir::KinematicTree&)> spoil;
  std::vector<const char*> noticed_in;
};
std::vector<Mutation> mutations(Base base);
inline constexpr const char* mutated_robot = "branch_below_base";
Case mutated_case(Base base);

// Ours with C v of the base turned to world axes, as MuJoCo has it: a slip in conventions. Floating base.
Dynamics in_world_axes(const Dynamics& ours, const Eigen::VectorXd& q);

}  // namespace dalembert::oracle
