// Branches of a fixed base that have another body's frame for theirs than the first's.
#include <algorithm>

#include "passes/parameters.hpp"
#include "passes/unroll.hpp"

namespace dalembert::passes {

using ir::InputKind;
using ir::no_node;
using ir::NodeId;

// Poses go out from the body, and from it up to the first of its branch. Of the first body M and what is made of it know only
// what turns or slides at its own joint: a number, but for payloads.
void Unroll::refer_to(int body) {
  int first = body;
  towards_[static_cast<std::size_t>(body)] = body;
  for (int above = body; (above = tree_.bodies[static_cast<std::size_t>(first)].parent) >= 0; first = above)
    towards_[static_cast<std::size_t>(above)] = first;
  const ir::NormalBody& n = normal_.bodies[static_cast<std::size_t>(first)];
  const bool massless_turn = n.sliding == 0 && n.moments.mass == 0, slide = n.turning == 0;
  const auto& added = payload_[place(first, -1)];
  const bool loaded = std::any_of(added.begin(), added.end(), [](const auto& p) { return is_of_moments(p.first); });
  const bool asked_for = std::any_of(algorithm_.sweeps.begin(), algorithm_.sweeps.end(),
                                     [](const ir::Sweep& sweep) { return sweep.first_at_its_joint; });
  at_its_joint_[static_cast<std::size_t>(first)] = asked_for && !loaded && (massless_turn || slide);
}

// The poses of a body above the one whose frame is that of reference, the next one to it having its own.
void Unroll::place_from_below(int sweep, int body) {
  const ir::Back& back = *algorithm_.sweeps[static_cast<std::size_t>(sweep)].back;
  const int below = towards_[static_cast<std::size_t>(body)];
  const std::vector<ir::Value>& stores = below == body ? back.at_reference : back.stores;
  const auto at = [&](const ir::Value& v) -> NodeId& { return values_[index(place(body, -1), v.role, v.component)]; };
  if (at(stores.front()) != no_node) return;
  if (below != body) place_from_below(sweep, below);
  program_.graph.set_tag(tag_ = {static_cast<std::int16_t>(sweep), body});
  ir::Copy copy(back.graph, program_.graph);
  for (const ir::Value& v : stores) {
    at(v) = copy.node(v.node, [&](const ir::Input& in) {
      return in.kind == InputKind::parameter ? parameter(in.index, below) : value(in.index, in.component, below);
    });
    name(at(v), algorithm_.roles[static_cast<std::size_t>(v.role)], v.component, body);
  }
}

}  // namespace dalembert::passes
