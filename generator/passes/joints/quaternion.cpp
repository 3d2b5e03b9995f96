#include "passes/joints/quaternion.hpp"

#include "passes/joints.hpp"
#include "passes/parameters.hpp"

namespace dalembert::passes {

std::map<int, ir::NodeId> quaternion_parameters(ir::Graph& graph, const ir::KinematicTree& tree, const ir::NormalTree& normal,
                                                const std::vector<int>& positions, const std::vector<int>& coordinates,
                                                bool rates_zero, int body) {
  if (body < 0 || !tree.bodies[static_cast<size_t>(body)].has_quaternion()) return {};
  const auto k = static_cast<size_t>(body);
  const ir::NormalBody& n = normal.bodies[k];
  const int displacements = tree.bodies[k].displacements();
  const bool flies = displacements > 0;
  const auto constant = [&](double value) { return Sym{&graph, graph.constant(value)}; };
  const auto rows_of = [&](const Eigen::Matrix3d& m) {
    const auto row = [&](int i) { return Vec3{constant(m(i, 0)), constant(m(i, 1)), constant(m(i, 2))}; };
    return Mat3{row(0), row(1), row(2)};
  };
  const auto three = [&](ir::InputKind kind, int first) {
    const auto one = [&](int i) { return Sym{&graph, graph.input({kind, first + i, 0})}; };
    return Vec3{one(0), one(1), one(2)};
  };
  const Mat3 placed = rows_of(n.rotation), to_body = rows_of(n.link_rotation);
  const int q = tree.base_positions() + positions[k], quaternion = q + displacements;
  // Along the body's axes, of which the joint's own is z: the same rotation.
  const Vec3 vector = to_body * three(ir::InputKind::position, quaternion);
  const Mat3 turned = base_rotation(
      [&](int i) {
        return i < 3 ? vector[static_cast<std::size_t>(i)]
                     : Sym{&graph, graph.input({ir::InputKind::position, quaternion + 3, 0})};
      },
      constant);
  const Mat3 rotation = placed * turned;
  Vec3 translation{constant(n.translation[0]), constant(n.translation[1]), constant(n.translation[2])};
  if (flies) {
    const Vec3 moved = placed * (to_body * three(ir::InputKind::position, q));
    translation = translation + moved;
  }
  std::map<int, ir::NodeId> given;
  const bool reference = tree.base_coordinates() == 0 && n.parent < 0;
  for (const int first : {static_cast<int>(rotation_p), static_cast<int>(pose_rotation_p)}) {
    if (first == pose_rotation_p && reference) continue;
    for (int i = 0; i < 9; ++i)
      given[first + i] = rotation[static_cast<std::size_t>(i / 3)][static_cast<std::size_t>(i % 3)].id;
    for (int i = 0; i < 3 && flies; ++i) given[first + 9 + i] = translation[static_cast<std::size_t>(i)].id;
  }
  if (rates_zero) return given;
  const int v = tree.base_coordinates() + coordinates[k];
  const auto put = [&](int first, int from) {
    const Vec3 along = to_body * three(ir::InputKind::velocity, from);
    for (int i = 0; i < 3; ++i) given[joint_twist_p + first + i] = along[static_cast<std::size_t>(i)].id;
  };
  if (flies) put(0, v);
  put(3, v + displacements);
  return given;
}

Bracket bracket(const ir::Body& lower, const ir::Body& upper) {
  const int turns = upper.displacements();  // where the angles begin
  if (lower.part < turns) return {};
  const int a = lower.part - turns, b = upper.part < turns ? upper.part : upper.part - turns;
  if (a == b) return {};
  const int c = 3 - a - b;
  return {upper.part < turns ? c : c + turns, (a + 1) % 3 == b ? 1 : -1};
}

}  // namespace dalembert::passes
