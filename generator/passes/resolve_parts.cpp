#include "passes/resolve_parts.hpp"

#include <algorithm>
#include <set>

#include "diagnostics.hpp"
#include "ir/moved_links.hpp"

namespace dalembert::passes {
namespace {

// The joint that moves a body is called so in the URDF, in the scene or in what is printed.
bool is_called(const ir::Body& body, const std::string& name) {
  return ir::matches(name, body.joint) || (!body.of.empty() && ir::matches(name, body.of)) ||
         (!body.elastic.empty() && ir::matches(name, body.elastic));
}

[[noreturn]] void refuse(const std::string& result, const std::string& message, const std::string& remedy) {
  throw InputError({Severity::error, "", "part of " + result, message, remedy});
}

void resolve(ir::Part& part, const std::string& result, const ir::KinematicTree& tree) {
  if (!tree.linkages.empty())
    refuse(result, "loop '" + tree.linkages.front().loops.front().name + "' is embedded, and results of it are whole",
           "ask for the whole here, or leave 'independent' out of the loop");
  part.coordinates.clear();
  part.bodies.clear();
  part.some_coordinates = part.names_joints();
  part.some_links = !part.links.empty();
  if (part.some_coordinates) {
    const bool named = !part.joints.empty() || !part.subtrees.empty();
    bool base = part.base.value_or(false);
    std::vector<bool> wanted(tree.bodies.size(), !named && !base);
    for (const std::string& link : part.subtrees) {
      const ir::LinkPlacement* const at = tree.find_link(link);
      if (!at) continue;
      if (at->body < 0 && !part.base) base = true;
      for (int k = 0; k < tree.joints(); ++k)
        if (at->body < 0 || tree.is_above(at->body, k)) wanted[static_cast<std::size_t>(k)] = true;
      // Of a joint of several coordinates all of them move the link, and of an elastic one motor and spring.
      const auto has_more_above = [&](int k) {
        const ir::Body& body = tree.bodies[static_cast<std::size_t>(k)];
        return body.part > 0 || !body.elastic.empty();
      };
      for (int k = at->body; k > 0 && has_more_above(k);) wanted[static_cast<std::size_t>(--k)] = true;
    }
    for (std::size_t k = 0; k < wanted.size(); ++k)
      for (const std::string& name : part.joints) wanted[k] = wanted[k] || is_called(tree.bodies[k], name);
    for (int j = 0; base && j < tree.base_coordinates(); ++j) part.coordinates.push_back(j);
    const std::vector<int> coordinates = tree.coordinates();
    for (std::size_t k = 0; k < wanted.size(); ++k)
      if (wanted[k] && !tree.bodies[k].driven()) part.coordinates.push_back(tree.base_coordinates() + coordinates[k]);
    if (part.coordinates.empty())
      refuse(result, "no joint that is named moves", "name joints that move, or the base where it floats");
  }
  if (!part.some_links) return;
  const std::vector<int> numbers = ir::numbers_of_links(tree);
  std::set<int> bodies;
  for (const std::string& link : part.links) {
    const ir::LinkPlacement* const at = tree.find_link(link);
    if (!at) continue;
    if (at->body < 0 && tree.base_coordinates() == 0)
      refuse(result, "link '" + link + "' does not move: the base is fixed", "name a descendant of a joint that moves");
    const std::string& own = at->body < 0 ? tree.base_link : tree.bodies[static_cast<std::size_t>(at->body)].name;
    // Parameters are a body's, about the origin of the link that it is named after.
    if (own != link)
      refuse(result, "link '" + link + "' is welded to '" + own + "', and they are one body", "name '" + own + "'");
    bodies.insert(at->body < 0 ? 0 : numbers[static_cast<std::size_t>(at->body)]);
  }
  part.bodies.assign(bodies.begin(), bodies.end());
}

}  // namespace

void resolve_parts(ir::Scene& scene, const ir::KinematicTree& tree) {
  const auto of_quantities = [&](std::map<ir::Quantity, ir::Part>& parts) {
    for (auto& [quantity, part] : parts) resolve(part, std::string(ir::name_of(quantity)), tree);
  };
  const auto of_links = [&](std::vector<ir::LinkOutput>& outputs) {
    for (ir::LinkOutput& output : outputs)
      if (output.part) resolve(*output.part, ir::name_of(output), tree);
  };
  of_quantities(scene.parts);
  of_links(scene.frames);
  for (ir::NamedFunction& function : scene.functions) {
    of_quantities(function.parts);
    of_links(function.of_links);
  }
}

}  // namespace dalembert::passes
