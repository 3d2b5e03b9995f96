#include "passes/joints_without_mass.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>

namespace dalembert::passes {

namespace {

size_t at(int index) { return static_cast<size_t>(index); }

// What each body's joint moves, and first of all what the base does.
struct Moved {
  std::vector<bool> mass, inertia;
};

Moved moved(const ir::KinematicTree& tree, const ir::Scene& scene) {
  Moved moved{std::vector<bool>(tree.bodies.size() + 1, false), std::vector<bool>(tree.bodies.size() + 1, false)};
  for (const ir::LinkPlacement& link : tree.links)
    if (scene.has_payload(link.link)) moved.mass[at(link.body + 1)] = true;
  for (size_t k = tree.bodies.size() + 1; k-- > 0;) {
    const ir::Inertia& own = k == 0 ? tree.base : tree.bodies[k - 1].inertia;
    if (own.mass != 0) moved.mass[k] = true;
    if (!own.inertia.isZero(0)) moved.inertia[k] = true;
    if (k == 0) break;
    const size_t parent = at(tree.bodies[k - 1].parent + 1);
    if (moved.mass[k]) moved.mass[parent] = true;
    if (moved.inertia[k]) moved.inertia[parent] = true;
  }
  return moved;
}

}  // namespace

std::vector<int> joints_without_mass(const ir::KinematicTree& tree, const ir::Scene& scene) {
  const Moved moved = passes::moved(tree, scene);
  std::vector<bool> carries(tree.bodies.size(), false);
  for (size_t k = 0; k < carries.size(); ++k) {
    const ir::Body& body = tree.bodies[k];
    if (moved.mass[k + 1] || (body.turns() && moved.inertia[k + 1]) || body.armature > 0)
      carries[body.driven() ? at(body.driven_by) : k] = true;
  }
  std::vector<int> joints;
  for (size_t k = 0; k < carries.size(); ++k)
    if (!tree.bodies[k].driven() && !carries[k] && !tree.in_linkage(static_cast<int>(k))) joints.push_back(static_cast<int>(k));
  return joints;
}

bool moves_no_mass(const ir::KinematicTree& tree, const ir::Scene& scene) {
  if (tree.base_coordinates() > 0) {
    const Moved moved = passes::moved(tree, scene);
    if (moved.mass.front() || moved.inertia.front()) return false;
  }
  return static_cast<int>(joints_without_mass(tree, scene).size()) == tree.independent_joints();
}

std::string in_words(const ir::Body& body) {
  if (!body.elastic.empty()) return "'" + body.elastic + "' (spring)";
  return "'" + (body.of.empty() ? body.joint : body.of) + "'";
}

ir::Scene with_massless_locked(const ir::RobotDescription& robot, const ir::KinematicTree& tree, ir::Scene scene,
                               Diagnostics& warnings) {
  const std::vector<int> joints = joints_without_mass(tree, scene);
  const auto lock = [&](const std::string& joint, double position) {
    scene.locked[joint] = position;
    scene.mimic.erase(joint);
    scene.damping.erase(joint);
    scene.friction.erase(joint);
    scene.stiffness.erase(joint);
    scene.armature.erase(joint);  // of zero
  };
  std::vector<std::string> names;
  for (int k : joints) {
    const ir::Body& body = tree.bodies[at(k)];
    if (const auto elastic = scene.elastic.find(body.elastic); elastic != scene.elastic.end()) {
      scene.armature[body.elastic] = elastic->second.inertia;
      scene.elastic.erase(elastic);
      warnings.push_back({Severity::warning, robot.file, fmt::format("joint '{}'", body.elastic),
                          "its spring moves no mass: it is rigid and keeps the motor's inertia, as the scene says",
                          "leave it out of 'elastic'"});
      continue;
    }
    lock(body.of.empty() ? body.joint : body.of, 0);
    if (names.empty() || names.back() != in_words(body)) names.push_back(in_words(body));
    for (const ir::Body& driven : tree.bodies)
      if (driven.driven_by == k) lock(driven.joint, driven.offset);
  }
  if (!names.empty())
    warnings.push_back({Severity::warning, robot.file,
                        fmt::format("joint{} {}", names.size() > 1 ? "s" : "", fmt::join(names, ", ")),
                        "what moves no mass is locked, as the scene says", "lock it by name to choose where"});
  return scene;
}

namespace {

bool any_needs(const ir::Scene& scene, ir::Needs needs) {
  const std::vector<ir::Quantity> asked = scene.quantities();
  return std::any_of(asked.begin(), asked.end(), [&](ir::Quantity quantity) { return ir::row_of(quantity).needs == needs; });
}

bool has_center(const ir::KinematicTree& tree, const ir::Scene& scene) {
  const auto has_mass = [](const ir::Body& body) { return body.inertia.mass != 0; };
  return tree.base.mass != 0 || std::any_of(tree.bodies.begin(), tree.bodies.end(), has_mass) || !scene.payloads.empty();
}

}  // namespace

void check_mass(const ir::RobotDescription& robot, const ir::KinematicTree& tree, const ir::Scene& scene) {
  if (any_needs(scene, ir::Needs::center) && !has_center(tree, scene))
    throw InputError({Severity::error, robot.file, fmt::format("robot '{}'", robot.name),
                      "nothing that moves has a mass: there is no centre of mass",
                      "give the links <inertial> with a mass, or leave out what refers to the centre of mass"});
  const bool any = any_needs(scene, ir::Needs::mass) || any_needs(scene, ir::Needs::center);
  if (!any || !moves_no_mass(tree, scene)) return;
  throw InputError({Severity::error, robot.file, fmt::format("robot '{}'", robot.name),
                    "nothing that moves has a mass: there are no dynamics",
                    "give the links <inertial> with a mass, or ask for what needs none: --outputs wrench_influence, or "
                    "--outputs '' --jacobians LINK"});
}

}  // namespace dalembert::passes
