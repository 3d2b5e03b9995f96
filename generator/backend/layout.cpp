#include "backend/layout.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "backend/emit_embedded.hpp"
#include "backend/emit_notes.hpp"
#include "backend/literals.hpp"
#include "ir/identifier.hpp"

namespace dalembert::backend {
namespace {

// What joints with quaternions and dependent ones have, which is not one number in q and one in v.
std::string other_joints(const CodeInput& code) {
  const ir::KinematicTree& tree = *code.robot;
  if (!tree.linkages.empty()) return dependent_joints(code);
  std::string text;
  const std::vector<int> positions = tree.positions(), coordinates = tree.coordinates();
  for (std::size_t k = 0; k < tree.bodies.size(); ++k) {
    const ir::Body& body = tree.bodies[k];
    if (body.parts < 2 || body.part > 0) continue;
    const int q = code.robot->base_positions() + positions[k], v = code.robot->base_coordinates() + coordinates[k];
    const bool flies = body.displacements() > 0;
    if (body.of_quaternion())
      text += comment_lines(
          fmt::format("{}: {}quaternion x y z w q[{}] to q[{}]; {}angular velocity along its own axes v[{}] to v[{}].", body.of,
                      flies ? fmt::format("position q[{}] to q[{}], ", q, q + 2) : "", flies ? q + 3 : q, flies ? q + 6 : q + 3,
                      flies ? fmt::format("linear v[{}] to v[{}], ", v, v + 2) : "", flies ? v + 3 : v, flies ? v + 5 : v + 2),
          0, 2);
  }
  return text;
}

// Where each coordinate's position stands in q; of a joint with a quaternion where its quaternion begins.
std::vector<int> position_places(const CodeInput& code) {
  std::vector<int> first;
  const std::vector<int> positions = code.robot->positions();
  for (std::size_t k = 0; k < code.robot->bodies.size(); ++k)
    if (code.robot->bodies[k].independent()) first.push_back(code.robot->base_positions() + positions[k]);
  return first;
}

}  // namespace

std::vector<const ir::Body*> own_coordinates(const CodeInput& code) {
  std::vector<const ir::Body*> bodies;
  for (const ir::Body& b : code.robot->bodies)
    if (b.independent()) bodies.push_back(&b);
  return bodies;
}

// Where a joint's numbers are: in a row, but where quaternions have one more than their joints have coordinates.
std::string joint_indices(const CodeInput& code) {
  const std::string others = other_joints(code);
  if (!code.robot->linkages.empty())
    return "// Joints with a coordinate in v, in its order: a joint's position is q[q_index(joint)], its rate "
           "v[v_index(joint)].\n" +
           others;
  if (code.robot->any_quaternion())
    return "// Joints' coordinates, in the order of v: a coordinate's rate is v[v_index(joint)].\n" + others;
  return "// Joints, in the order of q and v: a joint's position is q[q_index(joint)], its rate v[v_index(joint)].\n";
}

std::string position_layout(const CodeInput& code) {
  return code.robot->base_coordinates() > 0 ? "base position in the world (3), quaternion x y z w (4), joints [m, rad]"
                                            : "joints [m, rad]";
}
std::string velocity_layout(const CodeInput& code) {
  return code.robot->base_coordinates() > 0 ? "base linear (3), angular (3) in base axes, joint rates [m/s, rad/s]"
                                            : "joint rates [m/s, rad/s]";
}

std::string c_layout(const CodeInput& code) {
  std::vector<std::string> items{fmt::format("{}_q_size = {}", code.name, code.robot->nq()),
                                 fmt::format("{}_v_size = {}", code.name, code.robot->nv())};
  if (const int rows = code.scene.constraint_rows(); rows > 0)
    items.push_back(fmt::format("{}_constraint_rows = {}", code.name, rows));
  const std::vector<int> places = position_places(code);
  int rate = code.robot->base_coordinates();
  for (const ir::Body* body : own_coordinates(code)) {
    const std::string joint = ir::identifier(body->joint);
    const auto at = static_cast<std::size_t>(rate - code.robot->base_coordinates());
    items.push_back(fmt::format("{}_q_index_{} = {}", code.name, joint, places[at]));
    items.push_back(fmt::format("{}_v_index_{} = {}", code.name, joint, rate++));
  }
  return comment_lines(
             fmt::format("Sizes, and where joints stand. q: {}; v: {}.", position_layout(code), velocity_layout(code))) +
         other_joints(code) + followers_and_constraints(code) + fmt::format("enum {{\n  {}\n}};\n", fmt::join(items, ",\n  "));
}

std::string quaternion_joints(const CodeInput& code) {
  std::vector<std::string> all;
  for (const auto& [q, v, slides] : code.robot->quaternion_joints()) all.push_back(fmt::format("{{{}, {}, {}}}", q, v, slides));
  if (all.empty()) return "";
  return fmt::format(
      "// Joints with a quaternion, for dalembert/integrators: a member of that name of your dynamics.\n"
      "inline constexpr dalembert::QuaternionJoint quaternion_joints[] = {{\n    {}}};\n\n",
      wrapped(all, 4));
}
std::string position_index(const CodeInput& code) {
  if (!code.robot->any_quaternion() && code.robot->linkages.empty()) return "nq - joints + static_cast<int>(joint)";
  const std::vector<int> places = position_places(code);
  return fmt::format("std::array<int, {}>{{{}}}[static_cast<std::size_t>(joint)]", places.size(), fmt::join(places, ", "));
}

}  // namespace dalembert::backend
