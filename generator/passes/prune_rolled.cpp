#include "passes/prune_rolled.hpp"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "passes/roles.hpp"

namespace dalembert::passes {
namespace {

using ir::Direction;
using ir::InputKind;
using ir::NodeId;
using ir::Paragraph;

using Values = std::set<std::pair<int, int>>;  // (role, component)

// What later paragraphs read, from the slots' own values and across the start of a segment from its parents' slots.
struct Needed {
  Values read, gathered;
  bool operator==(const Needed&) const = default;
};

bool keeps(const ir::StateStore& s, const Needed& needed, bool has_children) {
  const std::pair<int, int> value{s.role, s.component};
  return needed.read.contains(value) || (has_children && needed.gathered.contains(value));
}

bool carries(const ir::StateStore& c, const Paragraph& p, const Needed& needed, const Values& live) {
  const std::pair<int, int> value{c.role, c.component};
  return live.contains(value) || (p.direction == Direction::inwards && needed.read.contains(value));
}

// The carried values a paragraph needs for what it keeps; adds what it reads to `needed`.
Values follow(const Paragraph& p, Needed& needed, bool has_children) {
  Values live;
  while (true) {
    std::vector<NodeId> roots;
    for (const auto& s : p.stores)
      if (keeps(s, needed, has_children)) roots.push_back(s.node);
    for (const auto& c : p.carried)
      if (carries(c, p, needed, live)) roots.push_back(c.node);
    const auto uses = ir::uses(p.graph, roots);
    const Values before = live;
    for (NodeId id = 0; id < p.graph.size(); ++id) {
      const ir::Node& n = p.graph[id];
      if (uses[static_cast<size_t>(id)] == 0 || n.op != ir::Op::input) continue;
      if (n.input.kind == InputKind::carried) live.insert({n.input.index, n.input.component});
      if (n.input.kind == InputKind::state) needed.read.insert({n.input.index, n.input.component});
    }
    if (live == before) break;
  }
  if (p.direction == Direction::outwards) needed.gathered.insert(live.begin(), live.end());
  return live;
}

// What Phase III's blocks, the base's rows and the final results read.
void read_by_results(const ir::RolledProgram& program, bool floating_base, Values& read) {
  const auto need = [&](int role) {
    for (int i = 0; i < program.roles[static_cast<size_t>(role)].components; ++i) read.insert({role, i});
  };
  const bool matrices = program.mass || program.coriolis;
  if (matrices || program.wrench) {
    need(joint_linear);
    if (!program.all_revolute) need(joint_angular);
    for (int i = 6; i < 9 && program.all_revolute; ++i) read.insert({rotation, i});
  }
  if (matrices) need(inertia_force);
  if (program.coriolis) {
    for (int role : {joint_rate, bias_force, transposed}) need(role);
    if (floating_base) need(below_force);
  }
  if (program.wrench) need(rotation), need(position);
  if (program.gravity) need(gravity_torque);
  if (program.bias) need(bias_torque);
  std::vector<NodeId> roots;
  for (const auto& e : program.base_elements) roots.push_back(e.node);
  const auto uses = ir::uses(program.base_graph, roots);
  for (NodeId id = 0; id < program.base_graph.size(); ++id) {
    const ir::Node& n = program.base_graph[id];
    if (uses[static_cast<size_t>(id)] > 0 && n.op == ir::Op::input && n.input.kind == InputKind::state)
      read.insert({n.input.index, n.input.component});
  }
}

}  // namespace

void prune_rolled(ir::RolledProgram& program, bool floating_base) {
  Needed needed;
  read_by_results(program, floating_base, needed.read);
  // Segments exchange values at branches: follow what is read until nothing new turns up, then drop the rest.
  for (Needed before; before != needed;) {
    before = needed;
    for (ir::SegmentCode& s : program.segments)
      for (size_t p = s.paragraphs.size(); p-- > 0;) follow(s.paragraphs[p], needed, s.has_children);
  }
  std::set<int> used;
  const auto use = [&](const ir::StateStore& s) { used.insert(s.role); };
  for (ir::SegmentCode& s : program.segments) {
    for (Paragraph& p : s.paragraphs) {
      const Values live = follow(p, needed, s.has_children);
      std::erase_if(p.stores, [&](const ir::StateStore& x) { return !keeps(x, needed, s.has_children); });
      std::erase_if(p.carried, [&](const ir::StateStore& x) { return !carries(x, p, needed, live); });
      std::for_each(p.stores.begin(), p.stores.end(), use);
    }
    std::erase_if(s.paragraphs, [](const Paragraph& p) { return p.stores.empty(); });
  }
  std::erase_if(program.root.stores, [&](const ir::StateStore& s) { return !keeps(s, needed, true); });
  std::for_each(program.root.stores.begin(), program.root.stores.end(), use);
  for (const auto& [role, component] : needed.read) used.insert(role);
  for (int role = 0; role < role_count; ++role)
    if (!used.contains(role)) program.roles[static_cast<size_t>(role)].name.clear();
}

}  // namespace dalembert::passes
