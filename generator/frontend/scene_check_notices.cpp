// What is taken or left out without a word of the scene.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "frontend/scene_checks.hpp"

namespace dalembert::frontend {

namespace {

std::string named(const std::vector<std::string>& joints) {
  return fmt::format("joint{} {}", joints.size() > 1 ? "s" : "", fmt::join(joints, ", "));
}

}  // namespace

void SceneCheck::say_what_base_is_taken() {
  const ir::Link& root = robot_.links[static_cast<size_t>(robot_.root)];
  if (document_.given.count("base") || !robot_.floating_root.empty() || root.name == "world") return;
  const bool floats = scene_.base == ir::Base::floating;
  const bool any_moves =
      std::any_of(robot_.joints.begin(), robot_.joints.end(), [&](const ir::Joint& joint) { return moves(joint); });
  warnings_.push_back({Severity::notice, robot_.file, fmt::format("link '{}'", root.name),
                       fmt::format("neither the scene nor the URDF says whether this base moves: {}",
                                   floats ? "it floats, for it has an inertia" : "it is fixed, for it has no inertia"),
                       !floats     ? "let it move with --base floating, or say --base fixed"
                       : any_moves ? "weld it to the world with --base fixed, or say --base floating"
                                   : "say --base floating: no joint would move of one that is fixed"});
}

void SceneCheck::say_what_loops_are_taken() {
  const bool given = document_.given.count("loops") > 0;
  std::vector<std::string> names, left_out;
  for (const ir::Loop& loop : robot_.loops) {
    const auto is_it = [&](const ir::Loop& other) { return other.name == loop.name; };
    const bool taken = std::any_of(scene_.loops.begin(), scene_.loops.end(), is_it) ||
                       std::any_of(scene_.embedded.begin(), scene_.embedded.end(), is_it);
    (taken ? names : left_out).push_back("'" + loop.name + "'");
  }
  if (!given && !names.empty())
    warnings_.push_back(
        {Severity::notice, robot_.file, named(names),
         names.size() > 1 ? "they close loops, which are the scene's of these names"
                          : "it closes a loop, which is the scene's of this name",
         "constrained dynamics keep to them, all else is of the tree without; loops in the scene says otherwise"});
  if (given && !left_out.empty() && !(scene_.loops.empty() && scene_.embedded.empty()))
    warnings_.push_back({Severity::warning, robot_.file, named(left_out), "what they hold together is left out",
                         "name them under loops too, or leave loops out of the scene to have them as the file says"});
}

void SceneCheck::warn_of_turned_rods() {
  if (!document_.given.count("loops")) return;
  for (const std::vector<ir::Loop>* list : {&scene_.loops, &scene_.embedded})
    for (const ir::Loop& loop : *list) {
      if (loop.type != ir::LoopType::distance || (loop.at[0].linear().isIdentity(0) && loop.at[1].linear().isIdentity(0)))
        continue;
      const Place place = place_of("loops/" + loop.name + part_of_entry + "at");
      warnings_.push_back({Severity::warning, place.file, place.element,
                           fmt::format("roll pitch yaw of loop '{}' are left out: a distance is between two points", loop.name),
                           "write x y z alone, or another type"});
    }
}

void SceneCheck::warn_of_mimic() {
  if (document_.urdf_mimic && scene_.mimic.empty()) warn_of_nothing_in_urdf("mimic");
  std::vector<std::string> still, joints;
  for (const ir::Joint& joint : robot_.joints)
    if (document_.urdf_mimic && joint.mimic && joint.type == ir::JointType::fixed && !is_cut(joint))
      still.push_back("'" + joint.name + "'");
  if (!still.empty())
    warnings_.push_back({Severity::warning, robot_.file, named(still), "a fixed joint follows no other: <mimic> is left out",
                         "remove it there, or give the joint another type"});
  for (const ir::Joint& joint : robot_.joints)
    if (joint.mimic && moves(joint) && !scene_.mimic.count(joint.name)) joints.push_back("'" + joint.name + "'");
  if (!joints.empty())
    warnings_.push_back({Severity::warning, robot_.file, named(joints),
                         joints.size() > 1 ? "their <mimic> is left out: they are joints of their own"
                                           : "its <mimic> is left out: it is a joint of its own",
                         "ask for it with mimic: urdf in the scene"});
}

void SceneCheck::warn_of_losses(const char* kind, bool asked, const std::map<std::string, double>& values,
                                double ir::Joint::*value) {
  if (asked) {
    if (std::none_of(robot_.joints.begin(), robot_.joints.end(),
                     [&](const ir::Joint& joint) { return joint.*value != 0 && moves(joint); }))
      warn_of_nothing_in_urdf(kind);
    return;
  }
  if (values.empty() && document_.given.count(kind)) return;
  std::vector<std::string> joints;
  for (const ir::Joint& joint : robot_.joints)
    if (joint.*value != 0 && moves(joint) && !values.count(joint.name)) joints.push_back("'" + joint.name + "'");
  if (!joints.empty())
    warnings_.push_back({Severity::warning, robot_.file, named(joints), fmt::format("<dynamics {}> is left out", kind),
                         values.empty() ? fmt::format("ask for it with {}: urdf in the scene", kind)
                                        : fmt::format("name them under {} too, with 0 where none is meant", kind)});
}

void SceneCheck::warn_of_nothing_in_urdf(const std::string& key) {
  const Place place = place_of(key);
  warnings_.push_back({Severity::warning, place.file, place.element,
                       fmt::format("no joint that moves has a {} in the URDF", key),
                       "remove the key, or write in the scene what is meant"});
}

}  // namespace dalembert::frontend
