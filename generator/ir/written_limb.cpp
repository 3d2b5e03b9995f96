#include "ir/written_limb.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

namespace dalembert::ir {
namespace {

// Longer limbs' text is fetched anew in every call, which takes longer than what folds.
constexpr int most_steps = 12;

// What a step reads of the one before: constants where they are known.
using Handed = std::map<std::pair<int, int>, std::optional<double>>;

class LimbWriter {
 public:
  LimbWriter(const Segment& segment, const SegmentCode& code, const Paragraph& paragraph)
      : segment_(segment), code_(code), paragraph_(paragraph) {}

  std::vector<LimbStep> run() const {
    std::vector<LimbStep> steps;
    const bool inwards = paragraph_.direction == Direction::inwards;
    Handed handed;
    for (const Carried& c : paragraph_.carried)
      handed[{c.role, c.component}] = inwards ? std::optional<double>(0) : c.initial.front();
    for (int i = 0; i < segment_.steps; ++i) {
      const int place = inwards ? segment_.steps - 1 - i : i;
      steps.push_back(step(place, i == 0 && !inwards, handed));
      for (const Carried& c : steps.back().carried) {
        const Node& n = steps.back().graph[c.node];
        handed[{c.role, c.component}] = n.op == Op::constant ? std::optional<double>(n.value) : std::nullopt;
      }
    }
    // From the last on, since what is handed to it may be of no use there.
    for (std::size_t i = steps.size(); i-- > 0;) {
      const LimbStep* const next = i + 1 < steps.size() ? &steps[i + 1] : nullptr;
      std::erase_if(steps[i].carried, [&](const Carried& c) { return next ? !reads(*next, c) : !inwards || !hands_on(c); });
    }
    return steps;
  }

 private:
  static bool reads(const LimbStep& step, const Carried& c) {
    const std::vector<std::int32_t> used = uses(step.graph, step.roots());
    for (NodeId id = 0; id < step.graph.size(); ++id)
      if (const Node& n = step.graph[id]; used[static_cast<std::size_t>(id)] > 0 && n.op == Op::input &&
                                          n.input == Input{InputKind::carried, c.role, c.component})
        return true;
    return false;
  }
  bool hands_on(const Carried& c) const {
    return std::any_of(code_.handed.begin(), code_.handed.end(), [&](const HandedOn& h) { return h.role == c.role; });
  }

  LimbStep step(int place, bool from_parent, const Handed& handed) const {
    LimbStep s;
    s.body = segment_.bodies.front()[static_cast<std::size_t>(place)];
    Copy copy(paragraph_.graph, s.graph);
    const auto input = [&](Input in) {
      switch (in.kind) {
        case InputKind::table:
          return s.graph.constant(code_.columns[static_cast<std::size_t>(in.index)].values[static_cast<std::size_t>(place)]);
        case InputKind::carried:
          if (const std::optional<double>& known = handed.at({in.index, in.component}); known) return s.graph.constant(*known);
          if (from_parent) in = {InputKind::of_body, in.index, in.component, segment_.parents.front()};
          return s.graph.input(in);
        case InputKind::state: return s.graph.input({InputKind::of_body, in.index, in.component, s.body});
        case InputKind::received: return s.graph.input({InputKind::received, in.index, in.component, s.body});
        default: return s.graph.input(in);
      }
    };
    std::vector<NodeId> wanted;
    for (const Value& v : paragraph_.stores) wanted.push_back(v.node);
    for (const Carried& c : paragraph_.carried) wanted.push_back(c.node);
    copy.nodes(wanted, input);
    for (Value v : paragraph_.stores) {
      v.node = copy.node(v.node, input);
      s.stores.push_back(v);
    }
    for (Carried c : paragraph_.carried) {
      c.node = copy.node(c.node, input);
      s.carried.push_back(c);
    }
    return s;
  }

  const Segment& segment_;
  const SegmentCode& code_;
  const Paragraph& paragraph_;
};

}  // namespace

std::vector<NodeId> LimbStep::roots() const {
  std::vector<NodeId> nodes;
  for (const Value& v : stores) nodes.push_back(v.node);
  for (const Carried& c : carried) nodes.push_back(c.node);
  return nodes;
}

std::vector<LimbStep> written_limb(const Plan& plan, const RolledProgram& program, std::size_t segment,
                                   const Paragraph& paragraph) {
  const Segment& s = plan.segments[segment];
  if (!plan.write_limbs || s.width != 1 || s.steps > most_steps || paragraph.direction == Direction::anywhere) return {};
  return LimbWriter(s, program.segments[segment], paragraph).run();
}

}  // namespace dalembert::ir
