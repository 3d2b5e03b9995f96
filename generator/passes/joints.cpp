#include "passes/joints.hpp"

#include <fmt/format.h>

#include "passes/builder.hpp"

namespace dalembert::passes {

using ir::InputKind;
using ir::Shape;
using ir::Source;

std::string either_way(const std::string& turning, const std::string& sliding) {
  return fmt::format("{} ({}), {} ({})", turning, ir::word_of(true, false), sliding, ir::word_of(false, true));
}

JointRoles joint_roles(Builder& builder, bool reference) {
  const std::string slide = fmt::format("q of {} joints", ir::word_of(false, true));
  if (!reference || !builder.moves_reference())
    return {builder.role({"sine", "sin", "sin q", "", Shape::scalar, -1, Source::sine}),
            builder.role({"cosine", "cos", "cos q", "", Shape::scalar, -1, Source::cosine}),
            builder.role({"slide", "slide", slide, "m", Shape::scalar, -1, Source::slide})};
  const char* held = ", at rest where the joint carries the frame of reference";
  return {builder.role({"pose_sine", "sin", std::string("sin q") + held, "", Shape::scalar, -1, Source::sine, true}),
          builder.role({"pose_cosine", "cos", std::string("cos q") + held, "", Shape::scalar, -1, Source::cosine, true}),
          builder.role({"pose_slide", "slide", slide + held, "m", Shape::scalar, -1, Source::slide, true})};
}

int joint_position_role(Builder& builder) {
  return builder.role({"joint_position", "q", "q", "rad or m", Shape::scalar, -1, Source::position});
}

int joint_rate_role(Builder& builder) {
  return builder.role({"rate", "dq", "dq", "rad/s or m/s", Shape::scalar, -1, Source::rate});
}

int joint_acceleration_role(Builder& builder) {
  return builder.role({"joint_acceleration", "ddq", "ddq", "rad/s^2 or m/s^2", Shape::scalar, -1, Source::acceleration});
}

int joint_effort_role(Builder& builder) {
  return builder.role({"effort", "tau", "tau", "N m or N", Shape::scalar, -1, Source::effort});
}

ir::NodeId coordinate_node(ir::Graph& graph, const ir::Role& role, const ir::KinematicTree& tree,
                           const std::vector<int>& coordinates, const std::vector<int>& positions, bool rates_zero, int body) {
  const ir::Body& joint = tree.bodies[static_cast<std::size_t>(body)];
  const int coordinate = coordinates[static_cast<std::size_t>(body)],
            position = tree.base_positions() + positions[static_cast<std::size_t>(body)];
  if (role.source == Source::position)
    return joint.of_quaternion() ? graph.constant(0) : graph.input({InputKind::position, position, 0});
  if (role.source == Source::rate)
    return rates_zero ? graph.constant(0) : graph.input({InputKind::velocity, tree.base_coordinates() + coordinate, 0});
  if (role.source == Source::acceleration)
    return graph.input({InputKind::acceleration, tree.base_coordinates() + coordinate, 0});
  if (role.source == Source::effort) return graph.input({InputKind::effort, tree.base_coordinates() + coordinate, 0});
  const bool at_rest = role.held && tree.carries_reference(static_cast<std::size_t>(body));
  const bool moves = (role.source == Source::slide ? joint.slides() : joint.turns()) && !at_rest && !joint.of_quaternion();
  if (!moves) return graph.constant(role.source == Source::cosine ? 1 : 0);
  ir::NodeId q = graph.input({InputKind::position, position, 0});
  if (joint.driven()) {
    const ir::NodeId offset = graph.constant(joint.offset), scaled = graph.multiply(graph.constant(joint.multiplier), q);
    q = graph.add(scaled, offset);
  }
  switch (role.source) {
    case Source::sine: return graph.sine(q);
    case Source::cosine: return graph.cosine(q);
    default: return joint.turns() ? graph.multiply(graph.constant(joint.slide_per_unit()), q) : q;
  }
}

}  // namespace dalembert::passes
