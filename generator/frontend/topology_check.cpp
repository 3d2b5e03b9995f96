#include "frontend/topology_check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <unordered_map>

#include "frontend/nearest.hpp"

namespace dalembert::frontend {

namespace {

class TopologyCheck {
 public:
  TopologyCheck(const std::string& file, const UrdfOutline& outline) : file_(file), outline_(outline) {
    for (size_t i = 0; i < outline.links.size(); ++i) index_.emplace(outline.links[i].name, static_cast<int>(i));
    joint_above_.assign(outline.links.size(), -1);
  }

  void run() {
    check_count();
    for (size_t j = 0; j < outline_.joints.size(); ++j) check_joint(static_cast<int>(j));
    stop_on_errors();
    check_cycles();
    stop_on_errors();
    check_roots();
    stop_on_errors();
  }

 private:
  void check_count() const {
    const auto refuse = [&](const char* kind, size_t count) -> void {
      if (count > most_links)
        throw InputError({Severity::error, file_, fmt::format("robot '{}'", outline_.robot),
                          fmt::format("there are {} {}; no more than {} are allowed", count, kind, most_links),
                          "leave out links that neither move nor have a mass"});
    };
    refuse("links", outline_.links.size());
    refuse("joints", outline_.joints.size());
  }

  void check_joint(int j) {
    const JointOutline& joint = outline_.joints[static_cast<size_t>(j)];
    const bool parent_known = check_link(joint, "parent", joint.parent);
    if (!check_link(joint, "child", joint.child) || !parent_known) return;
    if (joint.parent == joint.child)
      return error(place(joint), fmt::format("the joint connects link '{}' to itself", joint.parent),
                   "name two different links");
    int& above = joint_above_[static_cast<size_t>(index_.at(joint.child))];
    if (above < 0) {
      above = j;
      return;
    }
    error(place(joint),
          fmt::format("link '{}' is already the child of {}", joint.child, place(outline_.joints[static_cast<size_t>(above)])),
          "a link has one parent: remove one of the two joints, and say in the scene what they hold together: loops");
  }

  bool check_link(const JointOutline& joint, const char* role, const std::string& name) {
    if (index_.count(name)) return true;
    std::vector<std::string> names;
    for (const LinkOutline& link : outline_.links) names.push_back(link.name);
    error(place(joint), fmt::format("its {} link '{}' does not exist", role, name),
          fmt::format("add the link, or {}", suggestion(name, names)));
    return false;
  }

  // Walks from each link toward the root; meeting a link of the same walk again closes a cycle.
  void check_cycles() {
    std::vector<int> walk_of(outline_.links.size(), -1);
    for (size_t start = 0; start < outline_.links.size(); ++start) {
      int link = static_cast<int>(start);
      while (link >= 0 && walk_of[static_cast<size_t>(link)] < 0) {
        walk_of[static_cast<size_t>(link)] = static_cast<int>(start);
        link = parent(link);
      }
      if (link >= 0 && walk_of[static_cast<size_t>(link)] == static_cast<int>(start)) report_cycle(link);
    }
  }

  void report_cycle(int link) {
    std::vector<std::string> names;
    for (int l = link; names.empty() || l != link; l = parent(l)) names.push_back(outline_.links[static_cast<size_t>(l)].name);
    names.push_back(names.front());
    const JointOutline& joint = outline_.joints[static_cast<size_t>(joint_above_[static_cast<size_t>(link)])];
    error(place(joint), fmt::format("the joints form a cycle: each link's parent is the next of {}", fmt::join(names, ", ")),
          "remove one joint of the cycle, so that one root link remains");
  }

  void check_roots() {
    std::vector<std::string> roots;
    for (size_t i = 0; i < outline_.links.size(); ++i)
      if (joint_above_[i] < 0) roots.push_back(place(outline_.links[i]));
    if (roots.size() > 1)
      error(fmt::format("robot '{}'", outline_.robot),
            fmt::format("there are {} root links: {}", roots.size(), fmt::join(roots, ", ")),
            "make all but one of them the child of a joint, or remove them");
  }

  int parent(int link) const {
    const int joint = joint_above_[static_cast<size_t>(link)];
    return joint < 0 ? -1 : index_.at(outline_.joints[static_cast<size_t>(joint)].parent);
  }

  void error(std::string element, std::string message, std::string remedy) {
    add_error(errors_, {Severity::error, file_, std::move(element), std::move(message), std::move(remedy)});
  }
  void stop_on_errors() const {
    if (!errors_.empty()) throw InputError(errors_);
  }

  const std::string& file_;
  const UrdfOutline& outline_;
  std::unordered_map<std::string, int> index_;  // link name → index
  std::vector<int> joint_above_;                // per link: the joint whose child it is
  Diagnostics errors_;
};

}  // namespace

void check_topology(const std::string& file, const UrdfOutline& outline) { TopologyCheck(file, outline).run(); }

}  // namespace dalembert::frontend
