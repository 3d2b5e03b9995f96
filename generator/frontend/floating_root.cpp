#include "frontend/floating_root.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

namespace dalembert::frontend {

namespace {

using Children = std::unordered_map<std::string, std::vector<const JointOutline*>>;

// Names of the links at and beyond `root`, stopping short of the floating joint's child.
std::unordered_set<std::string> in_the_world(const Children& children, const std::string& root, const JointOutline& floating) {
  std::unordered_set<std::string> links{root};
  std::vector<std::string> rest{root};
  while (!rest.empty()) {
    const std::string link = std::move(rest.back());
    rest.pop_back();
    if (const auto below = children.find(link); below != children.end())
      for (const JointOutline* joint : below->second)
        if (joint != &floating && links.insert(joint->child).second) rest.push_back(joint->child);
  }
  return links;
}

}  // namespace

void take_floating_root(const std::string& file, UrdfOutline& outline, Diagnostics& warnings) {
  Children children;
  std::unordered_map<std::string, const JointOutline*> above;
  std::vector<const JointOutline*> floating;
  for (const JointOutline& joint : outline.joints) {
    children[joint.parent].push_back(&joint);
    above.emplace(joint.child, &joint);
    if (joint.type == ir::JointType::floating) floating.push_back(&joint);
  }
  if (floating.empty()) return;
  // One behind a joint that moves is a joint of the tree, and so are all where the world has more that moves.
  std::erase_if(floating, [&](const JointOutline* joint) {
    auto up = above.find(joint->parent);
    while (up != above.end() && up->second->type == ir::JointType::fixed) up = above.find(up->second->parent);
    return up != above.end();
  });
  if (floating.size() != 1) return;
  const JointOutline& joint = *floating.front();
  std::string root = joint.parent;
  for (auto up = above.find(root); up != above.end(); up = above.find(root)) root = up->second->parent;
  const std::unordered_set<std::string> lost = in_the_world(children, root, joint);
  const bool moves_beside = std::any_of(outline.joints.begin(), outline.joints.end(), [&](const JointOutline& other) {
    return &other != &joint && lost.count(other.parent) && other.type != ir::JointType::fixed;
  });
  if (moves_beside) return;
  std::vector<std::string> with_mass;
  for (const LinkOutline& link : outline.links)
    if (lost.count(link.name) && link.inertial) with_mass.push_back("'" + link.name + "'");
  if (!with_mass.empty())
    warnings.push_back({Severity::warning, file, place(joint),
                        fmt::format("the inertia of link{} {} above this floating joint is not used: what is above it is the "
                                    "world and does not move",
                                    with_mass.size() > 1 ? "s" : "", fmt::join(with_mass, ", ")),
                        "give it to the link below the joint"});
  if (!joint.origin.xyz.isZero(0) || !joint.origin.rpy.isZero(0) || joint.origin.rotation)
    warnings.push_back({Severity::warning, file, place(joint), "the <origin> of this floating joint is not used",
                        "q gives the pose of its child in the world"});
  if (joint.damping != 0 || joint.friction != 0)
    warnings.push_back({Severity::warning, file, place(joint), "the <dynamics> of this floating joint is not used",
                        "a base has neither damping nor friction here: a run-time wrench can act on its link"});

  std::erase_if(outline.joints, [&](const JointOutline& j) { return lost.count(j.parent) > 0; });
  std::erase_if(outline.links, [&](const LinkOutline& link) { return lost.count(link.name) > 0; });
  outline.floating_root = joint.name;
}

}  // namespace dalembert::frontend
