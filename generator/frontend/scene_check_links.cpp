// What links carry and are held by, and frames on them.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "frontend/scene_check.hpp"
#include "frontend/scene_checks.hpp"
#include "ir/identifier.hpp"

namespace dalembert::frontend {

void SceneCheck::cut() {
  std::vector<int> beyond;
  for (const std::string& name : scene_.cut) {
    if (!known("cut", "link", name, links_)) continue;
    const int link = links_.at(name);
    if (link == robot_.root)
      error("cut/" + name, fmt::format("link '{}' is the root: nothing would be left", name), "name a link below a joint");
    beyond.push_back(link);
  }
  while (!beyond.empty()) {
    const size_t link = static_cast<size_t>(beyond.back());
    beyond.pop_back();
    if (is_cut_[link]) continue;
    is_cut_[link] = true;
    for (int j : robot_.children[link]) beyond.push_back(robot_.joints[static_cast<size_t>(j)].child);
  }
}

void SceneCheck::placed() {
  scene_.placed.insert(scene_.placed.end(), document_.placed_by_functions.begin(), document_.placed_by_functions.end());
  for (const ir::Link& link : robot_.links) in_order_.push_back(link.name);
  if (scene_.placed.size() > most_links_asked)
    return error("frames",
                 fmt::format("there are {} frames; no more than {} are supported", scene_.placed.size(), most_links_asked),
                 "name fewer of them");
  std::map<std::string, std::string> names;  // as identifiers
  for (const ir::Link& link : robot_.links) names.emplace(ir::identifier(link.name), "link '" + link.name + "'");
  for (const ir::Frame& frame : scene_.placed) {
    const std::string key = place_of(frame);
    const std::string link = key + part_of_entry + "link";
    if (frame.name.empty()) error("frames", "a frame has an empty name", "give it one");
    if (const auto other = names.find(ir::identifier(frame.name)); other != names.end())
      error(key, fmt::format("frame '{}' is called as {} is", frame.name, other->second),
            links_.contains(frame.name) ? fmt::format("give it a name of its own: {{my_frame: {{link: {}, ...}}}}", frame.link)
                                        : "call one of them otherwise; what stands under frames, functions may name");
    else names.emplace(ir::identifier(frame.name), "frame '" + frame.name + "'");
    if (frame.link == frame.name && !links_.contains(frame.link))
      error(key, fmt::format("frame '{}' does not say which link it is on", frame.name), "write link: left_foot");
    else if (const auto other = frames_.find(frame.link); other != frames_.end())
      error(document_.places.count(link) ? link : key, fmt::format("'{}' is a frame, and frames are on links", frame.link),
            fmt::format("write link: {}, and where on it", robot_.links[static_cast<size_t>(other->second)].name));
    else kept_link(document_.places.count(link) ? link : key, frame.link);
    const auto on = links_.find(frame.link);
    frames_.emplace(frame.name, on == links_.end() ? robot_.root : on->second);
    in_order_.push_back(frame.name);
  }
}

std::string SceneCheck::place_of(const ir::Frame& frame) const {
  if (document_.places.count("frames/" + frame.name)) return "frames/" + frame.name;
  for (const ir::NamedFunction& function : scene_.functions)
    if (const std::string key = "functions/" + function.name + part_of_entry + frame.name; document_.places.count(key))
      return key;
  return "frames";
}

void SceneCheck::links_asked(const std::string& key, const std::vector<std::string>& links) {
  if (links.size() > most_links_asked)
    return error(key, fmt::format("there are {} links; no more than {} are supported", links.size(), most_links_asked),
                 "name fewer of them");
  for (const std::string& link : links) kept_link(key, link);
}

void SceneCheck::wrenches() {
  std::vector<std::string> links;
  for (const ir::ExternalWrench& wrench : scene_.wrenches) links.push_back(wrench.link);
  links_asked("wrenches", links);
}

void SceneCheck::contacts() {
  std::set<std::string> names;
  for (const ir::Contact& contact : scene_.contacts) {
    const std::string key = "contacts/" + contact.name;
    const std::string link = key + part_of_entry + "link";
    kept_link(document_.places.count(link) ? link : key, contact.link);
    if (contact.name.empty()) error("contacts", "a contact has an empty name", "give it one");
    if (const std::string id = ir::identifier(contact.name); !names.insert(id).second)
      error(key, fmt::format("two contacts would be called '{}' in C++", id), "call one of them otherwise");
  }
  if (!document_.given.count("loops"))
    std::erase_if(scene_.loops, [&](const ir::Loop& loop) {
      return std::any_of(loop.links.begin(), loop.links.end(),
                         [&](const std::string& link) { return is_cut_[static_cast<size_t>(links_.at(link))]; });
    });
  std::set<std::string> loops;
  for (const std::vector<ir::Loop>* list : {&scene_.loops, &scene_.embedded})
    for (const ir::Loop& loop : *list) {
      const std::string key = "loops/" + loop.name;
      if (loop.name.empty()) error("loops", "a loop has an empty name", "give it one");
      for (const std::string& link : loop.links) kept_link(key + part_of_entry + "links", link);
      for (const std::string& joint : loop.independent) free_joint(key + part_of_entry + "independent", joint);
      if (const std::string id = ir::identifier(loop.name); !loops.insert(id).second)
        error(key, fmt::format("two loops would be called '{}' in C++", id), "call one of them otherwise");
    }
  embedded();
  if (const int rows = scene_.constraint_rows(); rows > ir::most_constraint_rows)
    error(scene_.loops.empty() ? "contacts" : "loops",
          fmt::format("contacts and loops have {} rows; no more than {} are supported", rows, ir::most_constraint_rows),
          "name fewer of them, or take three points or more of one link as one weld");
}

void SceneCheck::embedded() {
  if (scene_.embedded.empty()) return;
  const std::string& name = scene_.embedded.front().name;
  const std::string own = "loops/" + name + part_of_entry + "independent";
  if (scene_.any_constraint())
    error(own,
          fmt::format("loop '{}' is embedded, and {} '{}' has rows: both together are not computed", name,
                      scene_.contacts.empty() ? "loop" : "contact",
                      scene_.contacts.empty() ? scene_.loops.front().name : scene_.contacts.front().name),
          scene_.contacts.empty()
              ? "give all loops independent joints, or none"
              : fmt::format("leave 'independent' out of loop '{}': it has rows beside those of contacts then", name));
  if (scene_.batch)
    error("batch", fmt::format("loop '{}' is embedded, and batches are of robots without", name),
          "leave batch out, or 'independent' of all loops");
  if (scene_.parallel == ir::Parallel::tasks)
    error("parallel", fmt::format("loop '{}' is embedded, and task graphs are of robots without", name),
          "leave parallel: tasks out");
  if (scene_.forward_dynamics == ir::Solver::articulated_bodies)
    error("forward_dynamics", fmt::format("loop '{}' is embedded: what is solved with M is solved by factorization", name),
          "leave the key out, or write forward_dynamics: factorization");
}

}  // namespace dalembert::frontend
