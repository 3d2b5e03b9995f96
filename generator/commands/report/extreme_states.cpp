#include "commands/report/extreme_states.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace dalembert::reporting {
namespace {

// Angles uniform up to `largest`, as the state's are up to π; slides stay.
void scale_angles(const ir::KinematicTree& tree, State& state, double largest) {
  Eigen::Index at = first_joint(tree);
  for (const ir::Body& body : tree.bodies) {
    if (!body.driven() && !body.of_quaternion() && body.turns()) state.q[at] *= largest / std::numbers::pi;
    at += body.positions();
  }
}

// All joints' numbers; quaternions at no turn.
void set_joints(const ir::KinematicTree& tree, State& state, double value) {
  state.q.tail(state.q.size() - first_joint(tree)).setConstant(value);
  for (const int first : tree.quaternions())
    if (first >= first_joint(tree)) state.q.segment<4>(first) << 0, 0, 0, 1;
}

// A driven joint's position as code in the scalar has it.
template <class Scalar>
double rounded_position(const ir::Body& body, double driver, bool fused) {
  const Scalar multiplier = static_cast<Scalar>(body.multiplier), offset = static_cast<Scalar>(body.offset),
               q = static_cast<Scalar>(driver);
  if (fused) return std::fma(multiplier, q, offset);
  const volatile Scalar product = multiplier * q;  // or this very sum is fused
  return product + offset;
}

void scale_speeds(State& state, double largest) { state.v *= largest / 2; }

}  // namespace

const std::vector<ExtremeCase>& extreme_cases() {
  using Tree = ir::KinematicTree;
  static const std::vector<ExtremeCase> cases = {
      {"random states", [](const Tree&, State&) {}},
      {"all joints at zero", [](const Tree& tree, State& s) { set_joints(tree, s, 0); }},
      {"statics: all speeds zero", [](const Tree&, State& s) { s.v.setZero(); }},
      {"angles to 1e6 rad", [](const Tree& tree, State& s) { scale_angles(tree, s, 1e6); }, true},
      {"angles to 1e15 rad", [](const Tree& tree, State& s) { scale_angles(tree, s, 1e15); }, true},
      {"speeds to 1e3", [](const Tree&, State& s) { scale_speeds(s, 1e3); }},
      {"speeds to 1e8", [](const Tree&, State& s) { scale_speeds(s, 1e8); }},
      {"speeds to 1e-9", [](const Tree&, State& s) { scale_speeds(s, 1e-9); }},
      {"joints and speeds denormal",
       [](const Tree& tree, State& s) {
         set_joints(tree, s, std::numeric_limits<double>::denorm_min());
         s.v.setConstant(std::numeric_limits<double>::denorm_min());
       }},
  };
  return cases;
}

ir::KinematicTree with_rounded_angles(ir::KinematicTree tree, const State& state, ir::ScalarType scalar, bool fused) {
  const std::vector<int> coordinates = tree.positions();
  for (size_t k = 0; k < tree.bodies.size(); ++k) {
    ir::Body& body = tree.bodies[k];
    if (!body.driven()) continue;
    const double q = state.q[first_joint(tree) + coordinates[k]];
    const double position =
        scalar == ir::ScalarType::float32 ? rounded_position<float>(body, q, fused) : rounded_position<double>(body, q, fused);
    body.offset = std::fma(-body.multiplier, q, position);
  }
  return tree;
}

}  // namespace dalembert::reporting
