#include "reference/solvable.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include "passes/joints_without_mass.hpp"
#include "reference/motion_without_mass.hpp"

namespace dalembert::reference {

namespace {

// "base 'pelvis', joints 'hip', 'knee' and 3 more"
std::string place(const ir::KinematicTree& tree, const MotionWithoutMass& motion) {
  constexpr size_t most = 5;
  std::vector<std::string> joints;
  for (const int k : motion.bodies)
    if (joints.size() < most) joints.push_back(passes::in_words(tree.bodies[static_cast<size_t>(k)]));
  std::string text = motion.base ? fmt::format("base '{}'", tree.base_link) : "";
  if (joints.empty()) return text;
  text += fmt::format("{}joint{} {}", motion.base ? ", " : "", joints.size() > 1 ? "s" : "", fmt::join(joints, ", "));
  return motion.bodies.size() > most ? fmt::format("{} and {} more", text, motion.bodies.size() - most) : text;
}

std::string remedy(const ir::KinematicTree& tree, const MotionWithoutMass& motion) {
  std::string text = !motion.base ? "give the links that move <inertial> with a mass and an extent"
                     : tree.base.mass == 0
                         ? fmt::format("give link '{}' an <inertial> with a mass and an extent", tree.base_link)
                         : fmt::format("give link '{}' moments of inertia about every axis", tree.base_link);
  if (motion.base && tree.independent_joints() > 0) text += ", or ask for --base fixed";  // else nothing would move
  if (!motion.bodies.empty())
    text += motion.bodies.size() > 1 ? "; or lock one of the joints, or give it an armature"
                                     : "; or lock the joint, or give it an armature";
  return text;
}

constexpr const char* moves_nothing =
    "can move without moving any mass, wherever the robot stands: the mass matrix is singular";

}  // namespace

void check_solvable(const ir::RobotDescription& robot, const ir::KinematicTree& tree, const ir::Scene& scene,
                    Diagnostics& warnings) {
  const std::vector<ir::Quantity> asked = scene.quantities();
  const auto solved =
      std::find_if(asked.begin(), asked.end(), [](ir::Quantity q) { return ir::is_solved(ir::row_of(q).scale); });
  const bool any_solved = solved != asked.end();
  if (!any_solved && std::find(asked.begin(), asked.end(), ir::Quantity::mass_matrix) == asked.end()) return;
  const char* name = any_solved ? ir::row_of(*solved).name : "";
  std::vector<std::string> massless;
  for (const int joint : passes::joints_without_mass(tree, scene))  // coordinates of one stand side by side
    if (std::string words = passes::in_words(tree.bodies[static_cast<size_t>(joint)]);
        massless.empty() || massless.back() != words)
      massless.push_back(std::move(words));
  if (!massless.empty() && !any_solved) return;  // passes/build_tree has warned of them
  if (!massless.empty())
    throw InputError(
        {Severity::error, robot.file, fmt::format("joint{} {}", massless.size() > 1 ? "s" : "", fmt::join(massless, ", ")),
         fmt::format("{} no mass: the mass matrix is singular, and there is no {}", massless.size() > 1 ? "move" : "moves",
                     name),
         massless.size() > 1
             ? "give their descendants <inertial> with a mass, the joints an armature, or lock them (massless: lock)"
             : "give its descendants <inertial> with a mass, the joint an armature, or lock it (massless: lock)"});
  if (!tree.linkages.empty()) return;  // who follows may move what has none
  const std::optional<MotionWithoutMass> motion = motion_without_mass(tree, scene);
  if (!motion) return;
  if (any_solved)
    throw InputError({Severity::error, robot.file, place(tree, *motion),
                      fmt::format("{}, and there is no {}", moves_nothing, name), remedy(tree, *motion)});
  if (motion->base)  // of joints alone passes/build_tree has warned
    warnings.push_back({Severity::warning, robot.file, place(tree, *motion), moves_nothing, remedy(tree, *motion)});
}

}  // namespace dalembert::reference
