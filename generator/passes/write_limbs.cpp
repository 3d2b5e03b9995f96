#include "passes/write_limbs.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace dalembert::passes {
namespace {

using ir::Carried;
using ir::Direction;
using ir::InputKind;
using ir::LimbStep;
using ir::NodeId;

// Longer limbs' text is fetched anew in every call, which takes longer than what folds.
constexpr int most_steps = 12;

// What a step reads of the one before: constants where they are known.
using Handed = std::map<std::pair<int, int>, std::optional<double>>;

class LimbWriter {
 public:
  LimbWriter(const ir::Segment& segment, const ir::SegmentCode& code, const ir::Paragraph& paragraph)
      : segment_(segment), code_(code), paragraph_(paragraph) {}

  std::vector<LimbStep> run() const {
    std::vector<LimbStep> steps;
    const bool inwards = paragraph_.loop.direction == Direction::inwards;
    Handed handed;
    for (const Carried& c : paragraph_.carried)
      handed[{c.role, c.component}] = inwards ? std::optional<double>(0) : c.initial.front();
    for (int i = 0; i < segment_.steps; ++i) {
      const int place = inwards ? segment_.steps - 1 - i : i;
      steps.push_back(step(place, i == 0 && !inwards, handed));
      for (const Carried& c : steps.back().carried) {
        const ir::Node& n = steps.back().graph[c.node];
        handed[{c.role, c.component}] = n.op == ir::Op::constant ? std::optional<double>(n.value) : std::nullopt;
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
    bool found = false;
    ir::each_input(step.graph, step.roots(), [&](const ir::Input& in) {
      found = found || in == ir::Input{InputKind::carried, c.role, c.component};
    });
    return found;
  }
  bool hands_on(const Carried& c) const {
    return std::any_of(paragraph_.handed.begin(), paragraph_.handed.end(),
                       [&](const ir::HandedOn& h) { return h.role == c.role; });
  }

  // Where the first step has from what others have from the step before.
  ir::Address parent_of(const ir::Input& in) const {
    return std::find_if(paragraph_.carried.begin(), paragraph_.carried.end(),
                        [&](const Carried& c) { return c.role == in.index && c.component == in.component; })
        ->from.front();
  }

  LimbStep step(int place, bool from_parent, const Handed& handed) const {
    LimbStep s;
    s.body = segment_.bodies.front()[static_cast<std::size_t>(place)];
    ir::Copy copy(paragraph_.graph, s.graph);
    const auto input = [&](ir::Input in) {
      switch (in.kind) {
        case InputKind::table:
          return s.graph.constant(code_.columns[static_cast<std::size_t>(in.index)].values[static_cast<std::size_t>(place)]);
        case InputKind::carried:
          if (const std::optional<double>& known = handed.at({in.index, in.component}); known) return s.graph.constant(*known);
          return s.graph.input(from_parent ? parent_of(in).input() : in);
        case InputKind::kept:
          if (in.body == ir::Address::own) in.body = s.body;
          return s.graph.input(in);
        default: return s.graph.input(in);
      }
    };
    copy.nodes(paragraph_.roots(), input);
    for (const auto& [to, node] : paragraph_.stores)
      s.stores.push_back({{to.role, to.component, s.body}, copy.node(node, input)});
    for (Carried c : paragraph_.carried) {
      c.node = copy.node(c.node, input);
      s.carried.push_back(c);
    }
    return s;
  }

  const ir::Segment& segment_;
  const ir::SegmentCode& code_;
  const ir::Paragraph& paragraph_;
};

}  // namespace

void write_limbs(const ir::Plan& plan, ir::RolledProgram& program) {
  if (!plan.write_limbs) return;
  for (std::size_t i = 0; i < plan.segments.size(); ++i) {
    ir::SegmentCode& code = program.segments[i];
    for (ir::SegmentStage& stage : code.stages)
      for (ir::Paragraph& p : stage.paragraphs)
        if (p.loop.by_steps() && p.loop.width == 1 && p.loop.steps <= most_steps)
          p.written = LimbWriter(plan.segments[i], code, p).run();
  }
}

}  // namespace dalembert::passes
