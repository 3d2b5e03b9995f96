// What is computed.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "frontend/function_names.hpp"
#include "frontend/nearest.hpp"
#include "frontend/scene_check.hpp"
#include "frontend/scene_checks.hpp"
#include "ir/aliases.hpp"
#include "ir/emitted_function.hpp"
#include "ir/identifier.hpp"

namespace dalembert::frontend {

void SceneCheck::outputs() {
  const bool given = document_.given.count("outputs") > 0;
  if (scene_.outputs.empty() && scene_.link_outputs().empty() && scene_.functions.empty())
    error("outputs", "no output is asked for", "name at least one quantity, such as mass_matrix");
  for (const ir::Quantity quantity : scene_.outputs) of_contacts("outputs/" + std::string(ir::name_of(quantity)), quantity);
  if (!scene_.rates_zero) return;
  if (!given) {
    scene_.outputs = {ir::Quantity::mass_matrix, ir::Quantity::gravity};
  } else if (std::count(scene_.outputs.begin(), scene_.outputs.end(), ir::Quantity::coriolis_matrix)) {
    error("outputs", "coriolis_matrix is zero when rates_zero is set",
          "remove one of the two; bias then knows no velocities, and may stay");
  }
}

void SceneCheck::of_contacts(const std::string& key, ir::Quantity quantity) {
  if (!scene_.embedded.empty() && !ir::is_of_linkages(quantity))
    return error(key,
                 fmt::format("{} is asked for, and loop '{}' is embedded: it is not computed of independent coordinates",
                             ir::name_of(quantity), scene_.embedded.front().name),
                 ir::is_of_constraints(quantity)
                     ? "leave 'independent' out of all loops: they have rows and forces then"
                     : "leave 'independent' out of all loops and ask for constrained_forward_dynamics and its derivatives");
  if (!scene_.any_constraint() && ir::is_of_constraints(quantity))
    error(key, fmt::format("{} is asked for, and there is neither a contact nor a loop", ir::name_of(quantity)),
          "say where the robot is held: contacts: {left_foot: weld}, or which links hold each other: loops");
}

void SceneCheck::parts() {
  for (const auto& [quantity, part] : scene_.parts) of_part("outputs/" + std::string(ir::name_of(quantity)), part);
  for (const ir::LinkOutput& output : scene_.frames)
    if (output.part) of_part("frames/" + output.link + part_of_entry + ir::row_of(output.quantity).name, *output.part);
  for (const ir::NamedFunction& function : scene_.functions) {
    const std::string inside = "functions/" + function.name + part_of_entry;
    for (const auto& [quantity, part] : function.parts) of_part(inside + std::string(ir::name_of(quantity)), part);
    for (const ir::LinkOutput& output : function.of_links)
      if (output.part) of_part(inside + output.link, *output.part);
  }
}

void SceneCheck::of_part(const std::string& where, const ir::Part& part) {
  for (const std::string& name : part.joints) {
    if (!ir::is_pattern(name)) {
      if (const auto relation = scene_.mimic.find(name); free_joint(where, name) && relation != scene_.mimic.end())
        error(where, fmt::format("joint '{}' mimics '{}', and has no row of its own", name, relation->second.of),
              fmt::format("name '{}', whose row has the sum", relation->second.of));
      continue;
    }
    std::vector<std::string> all;
    for (const ir::Joint& joint : robot_.joints)
      if (joint.type != ir::JointType::fixed && !is_cut(joint) && !scene_.locked.count(joint.name) &&
          !scene_.mimic.count(joint.name))
        all.push_back(joint.name);
    if (std::none_of(all.begin(), all.end(), [&](const std::string& joint) { return ir::matches(name, joint); })) {
      std::string letters = name;
      std::erase_if(letters, [](char c) { return c == '*' || c == '?'; });
      error(where, fmt::format("no joint that moves is called like '{}'", name), suggestion(letters, all));
    }
  }
  for (const std::string& link : part.subtrees) kept_link(where, link);
  for (const std::string& link : part.links) kept_link(where, link);
  if (part.base.value_or(false) && scene_.base == ir::Base::fixed)
    error(where, "the base is fixed, and has no rows", "leave 'base' out, or say base: floating in the scene");
}

void SceneCheck::names_differ() {
  std::set<std::string> names;
  for (const ir::LinkOutput& output : scene_.link_outputs())
    if (!names.insert(ir::name_of(output)).second)
      error("frames/" + output.link, fmt::format("two outputs would be called '{}'", ir::name_of(output)),
            "leave one of them out");
}

void SceneCheck::functions() {
  if (scene_.functions.size() > most_functions)
    return error("functions",
                 fmt::format("there are {} functions; no more than {} are supported", scene_.functions.size(), most_functions),
                 "name fewer of them");
  for (ir::NamedFunction& function : scene_.functions) of_frames(function);
  for (const ir::NamedFunction& function : scene_.functions)
    for (const ir::Quantity quantity : function.quantities)
      of_contacts("functions/" + function.name + part_of_entry + std::string(ir::name_of(quantity)), quantity);
  for (const auto& [function, taken] : taken_names(scene_))
    error("functions/" + function, fmt::format("the generated code has another '{}'", taken),
          fmt::format("call the function '{}' otherwise", function));
  for (const ir::NamedFunction& function : scene_.functions)
    if (scene_.rates_zero && std::count(function.quantities.begin(), function.quantities.end(), ir::Quantity::coriolis_matrix))
      error("functions/" + function.name + part_of_entry + "coriolis_matrix", "coriolis_matrix is zero when rates_zero is set",
            "remove one of the two");
}

void SceneCheck::plan() {
  std::vector<std::string> names;
  for (const ir::EmittedFunction& function : ir::functions_of(scene_)) names.push_back(function.name);
  for (const auto& [function, how] : scene_.plan)
    if (std::find(names.begin(), names.end(), function) == names.end())
      error("plan/" + function, fmt::format("the scene asks for no function '{}'", function), suggestion(function, names));
}

void SceneCheck::of_frames(ir::NamedFunction& function) {
  const auto all = document_.of_frames.find(function.name);
  if (all == document_.of_frames.end()) return;
  std::set<std::string> names;
  for (const AskedOfFrame& asked : all->second) {
    const std::string entry = asked.output ? asked.output->link : asked.name;
    const std::string where = "functions/" + function.name + part_of_entry + entry;
    for (const ir::LinkOutput& output : asked.output ? std::vector{*asked.output} : explained(where, asked.name)) {
      kept_link(where, output.link);
      if (!names.insert(ir::name_of(output)).second)
        error(where, fmt::format("two outputs would be called '{}_{}'", function.name, ir::name_of(output)),
              "leave one of them out");
      function.of_links.push_back(output);
    }
  }
  if (function.quantities.empty() && function.of_links.empty() && errors_.empty())
    error("functions/" + function.name, fmt::format("function '{}' computes nothing", function.name),
          "name at least one quantity, such as mass_matrix");
  if (function.of_links.size() > most_links_asked)
    error(
        "functions/" + function.name,
        fmt::format("there are {} results of links; no more than {} are supported", function.of_links.size(), most_links_asked),
        "name fewer of them");
}

std::vector<ir::LinkOutput> SceneCheck::explained(const std::string& where, const std::string& name) {
  const auto is = [](const std::string& link, std::string_view called) {
    return called == link || called == ir::identifier(link);
  };
  for (const ir::LinkOutput& output : scene_.link_outputs())
    if (ir::name_of(output) == ir::identifier(name)) return {{output.quantity, output.link}};
  std::vector<ir::LinkOutput> of_links;
  for (const ir::LinkQuantityRow& row : ir::link_quantities()) {
    const std::string prefix = std::string(row.name) + "_";
    if (!name.starts_with(prefix)) continue;
    for (const std::string& link : in_order_)
      if (is(link, std::string_view(name).substr(prefix.size()))) of_links.push_back({row.quantity, link});
  }
  if (of_links.size() > 1)
    error(where, fmt::format("'{}' is two things: {}, and {}", name, ir::help_of(of_links[0]), ir::help_of(of_links[1])),
          "ask for one of them in `frames`: the function takes that");
  if (!of_links.empty()) return {of_links.front()};
  for (const std::string& link : in_order_) {
    if (!is(link, name)) continue;
    std::vector<ir::LinkOutput> outputs;
    for (const ir::LinkOutput& output : scene_.link_outputs())
      if (output.link == link) outputs.push_back(output);
    if (!outputs.empty()) return outputs;
    for (const ir::LinkQuantityRow& row : ir::link_quantities())
      if (row.by_default) outputs.push_back({row.quantity, link});
    return outputs;
  }
  // Of no link: the longest quantity was meant.
  const ir::LinkQuantityRow* meant = nullptr;
  for (const ir::LinkQuantityRow& row : ir::link_quantities())
    if (const std::string prefix = std::string(row.name) + "_"; name.starts_with(prefix) && name != prefix)
      if (!meant || std::string_view(meant->name).size() < prefix.size()) meant = &row;
  if (meant) return {{meant->quantity, name.substr(std::string_view(meant->name).size() + 1)}};
  std::vector<std::string> known;
  for (const ir::QuantityRow& row : ir::quantities()) known.emplace_back(row.name);
  for (const ir::LinkQuantityRow& row : ir::link_quantities()) known.push_back(std::string(row.name) + "_LINK");
  for (const ir::Frame& frame : scene_.placed) known.push_back(frame.name);
  std::vector<std::string> also = ir::names_of(ir::quantity_aliases());
  for (const std::string& link : in_order_)
    for (const ir::LinkQuantityRow& row : ir::link_quantities())
      also.push_back(std::string(row.name) + "_" + ir::identifier(link));
  error(where, fmt::format("the quantity '{}' is unknown", name), suggestion(name, known, also));
  return {};
}

void SceneCheck::rollouts() {
  const std::string key = scene_.impacts ? "rollouts/impacts" : "rollouts/linearly_implicit";
  if (!scene_.linearly_implicit && !scene_.impacts) return;
  if (!scene_.batch)
    error(key, "rollouts are of batches, which are not asked for",
          "write batch: true, and leave out what says otherwise (--batch false; dalembert_add_robot() without BATCH)");
  const std::vector<ir::Quantity> all = scene_.quantities();
  const auto asked = [&](ir::Quantity quantity) { return std::find(all.begin(), all.end(), quantity) != all.end(); };
  if (scene_.impacts && !asked(ir::Quantity::constrained_forward_dynamics))
    error(key, "no function tells how the robot moves where contacts and loops hold it",
          "ask for constrained_forward_dynamics");
  if (scene_.impacts && !asked(ir::Quantity::impact))
    error(key, "no function tells what an impact does", "ask for impact, beside constrained_forward_dynamics");
  if (scene_.rates_zero)
    error(key, "velocities are zero, and nothing moves",
          std::string("leave rates_zero out, or ") + (scene_.impacts ? "impacts" : "linearly_implicit"));
  if (!scene_.linearly_implicit) return;
  if (!asked(ir::Quantity::forward_dynamics)) error(key, "no function tells how the robot moves", "ask for forward_dynamics");
  if (scene_.any_constraint())
    error(key,
          fmt::format("{} '{}' holds the robot, and linearly implicit steps are of robots that nothing holds",
                      scene_.contacts.empty() ? "loop" : "contact",
                      scene_.contacts.empty() ? scene_.loops.front().name : scene_.contacts.front().name),
          "leave linearly_implicit out, or the contacts and loops");
}

}  // namespace dalembert::frontend
