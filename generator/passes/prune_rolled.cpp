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

// What is read of the slots of a segment, or of the root's.
struct Slots {
  Values read;      // by the segment itself, by Phase III and by the results
  Values gathered;  // by the children, at their start
  bool operator==(const Slots&) const = default;

  bool keep(const ir::StateStore& s) const {
    const std::pair<int, int> value{s.role, s.component};
    return read.contains(value) || gathered.contains(value);
  }
};

// A component is carried when the paragraph itself needs it, or, inwards, when a parent reads it.
bool carries(const ir::StateStore& c, const Paragraph& p, const std::vector<Slots*>& parents, const Values& live) {
  const std::pair<int, int> value{c.role, c.component};
  return live.contains(value) ||
         (p.direction == Direction::inwards &&
          std::any_of(parents.begin(), parents.end(), [&](const Slots* s) { return s->read.contains(value); }));
}

// The carried values a paragraph needs for what it keeps; adds what it reads to `own` and to its parents.
Values follow(const Paragraph& p, Slots& own, const std::vector<Slots*>& parents, Values& root) {
  Values live;
  while (true) {
    std::vector<NodeId> roots;
    for (const auto& s : p.stores)
      if (own.keep(s)) roots.push_back(s.node);
    for (const auto& c : p.carried)
      if (carries(c, p, parents, live)) roots.push_back(c.node);
    const auto uses = ir::uses(p.graph, roots);
    const Values before = live;
    for (NodeId id = 0; id < p.graph.size(); ++id) {
      const ir::Node& n = p.graph[id];
      if (uses[static_cast<size_t>(id)] == 0 || n.op != ir::Op::input) continue;
      const int at = n.input.index;
      if (n.input.kind == InputKind::carried) live.insert({at, n.input.component});
      if (n.input.kind == InputKind::state) own.read.insert({at, n.input.component});
      if (n.input.kind == InputKind::velocity) root.insert({velocity, at});
    }
    if (live == before) break;
  }
  for (Slots* parent : parents) {
    if (p.direction == Direction::outwards) parent->gathered.insert(live.begin(), live.end());
    // What one parent reads is added to all of them.
    if (p.direction != Direction::inwards) continue;
    for (const auto& c : p.carried)
      if (carries(c, p, parents, live)) parent->read.insert({c.role, c.component});
  }
  return live;
}

// What Phase III's blocks and the final results read of every body.
Values read_by_results(const ir::RolledProgram& program, bool floating_base) {
  Values read;
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
  return read;
}

// What the base's own rows read.
Values read_by_base(const ir::RolledProgram& program) {
  Values read;
  std::vector<NodeId> roots;
  for (const auto& e : program.base_elements) roots.push_back(e.node);
  const auto uses = ir::uses(program.base_graph, roots);
  for (NodeId id = 0; id < program.base_graph.size(); ++id) {
    const ir::Node& n = program.base_graph[id];
    if (uses[static_cast<size_t>(id)] > 0 && n.op == ir::Op::input && n.input.kind == InputKind::state)
      read.insert({n.input.index, n.input.component});
  }
  return read;
}

}  // namespace

void prune_rolled(ir::RolledProgram& program, bool floating_base) {
  Slots root{read_by_base(program), {}};
  std::vector<Slots> slots(program.segments.size(), Slots{read_by_results(program, floating_base), {}});
  std::vector<std::vector<Slots*>> parents;
  for (const ir::SegmentCode& s : program.segments) {
    parents.emplace_back();
    for (int parent : s.parents) parents.back().push_back(parent < 0 ? &root : &slots[static_cast<size_t>(parent)]);
  }
  // Segments exchange values at branches: follow what is read until nothing new turns up, then drop the rest.
  const auto all = [&] { return std::pair(root, slots); };
  for (auto before = all();; before = all()) {
    for (size_t i = 0; i < slots.size(); ++i)
      for (size_t p = program.segments[i].paragraphs.size(); p-- > 0;)
        follow(program.segments[i].paragraphs[p], slots[i], parents[i], root.read);
    if (all() == before) break;
  }
  std::set<int> used;
  const auto use = [&](const ir::StateStore& s) { used.insert(s.role); };
  for (size_t i = 0; i < slots.size(); ++i) {
    ir::SegmentCode& s = program.segments[i];
    for (Paragraph& p : s.paragraphs) {
      const Values live = follow(p, slots[i], parents[i], root.read);
      std::erase_if(p.stores, [&](const ir::StateStore& x) { return !slots[i].keep(x); });
      std::erase_if(p.carried, [&](const ir::StateStore& x) { return !carries(x, p, parents[i], live); });
      std::for_each(p.stores.begin(), p.stores.end(), use);
    }
    std::erase_if(s.paragraphs, [](const Paragraph& p) { return p.stores.empty() && p.carried.empty(); });
    for (const auto& [role, component] : slots[i].read) used.insert(role);
  }
  std::erase_if(program.root.stores, [&](const ir::StateStore& s) { return !root.keep(s); });
  std::for_each(program.root.stores.begin(), program.root.stores.end(), use);
  for (const auto& [role, component] : root.read) used.insert(role);
  for (int role = 0; role < role_count; ++role)
    if (!used.contains(role)) program.roles[static_cast<size_t>(role)].name.clear();
}

}  // namespace dalembert::passes
