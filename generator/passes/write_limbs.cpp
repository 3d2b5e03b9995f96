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
      : segment_(segment), code_(code), paragraph_(paragraph), alone_(segment.width == 1) {}

  std::vector<LimbStep> run() const {
    std::vector<LimbStep> steps;
    const bool inwards = paragraph_.loop.direction == Direction::inwards;
    Handed handed;
    for (const Carried& c : paragraph_.carried)
      handed[{c.role, c.component}] = inwards ? std::optional<double>(0) : common(c.initial);
    for (int i = 0; i < segment_.steps; ++i) {
      steps.push_back(step(paragraph_.loop.step(i), i == 0 && !inwards, handed));
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

  // What all lanes have that are read.
  std::optional<double> common(const std::vector<std::optional<double>>& of_lanes) const {
    const std::optional<double> first = of_lanes[static_cast<std::size_t>(paragraph_.live_lanes.front())];
    const bool same = std::all_of(paragraph_.live_lanes.begin(), paragraph_.live_lanes.end(),
                                  [&](int lane) { return of_lanes[static_cast<std::size_t>(lane)] == first; });
    return same ? first : std::nullopt;
  }
  std::optional<double> common(const ir::Column& column, int place) const {
    std::vector<std::optional<double>> of_lanes;
    for (int lane = 0; lane < segment_.width; ++lane)
      of_lanes.emplace_back(column.values[static_cast<std::size_t>(place * segment_.width + lane)]);
    return common(of_lanes);
  }

  // Where the first step of a limb that stands alone has from what others have from the step before.
  ir::Address parent_of(const ir::Input& in) const {
    return std::find_if(paragraph_.carried.begin(), paragraph_.carried.end(),
                        [&](const Carried& c) { return c.role == in.index && c.component == in.component; })
        ->from.front();
  }

  LimbStep step(int place, bool from_parent, const Handed& handed) const {
    LimbStep s;
    s.place = place;
    s.body = segment_.bodies[static_cast<std::size_t>(paragraph_.live_lanes.front())][static_cast<std::size_t>(place)];
    ir::Copy copy(paragraph_.graph, s.graph);
    const auto input = [&](ir::Input in) {
      switch (in.kind) {
        case InputKind::table:
          if (const auto known = common(code_.columns[static_cast<std::size_t>(in.index)], place))
            return s.graph.constant(*known);
          return s.graph.input(in);
        case InputKind::carried:
          if (const std::optional<double>& known = handed.at({in.index, in.component}); known) return s.graph.constant(*known);
          return s.graph.input(from_parent && alone_ ? parent_of(in).input() : in);
        case InputKind::kept:
          if (in.body == ir::Address::own && alone_) in.body = s.body;
          return s.graph.input(in);
        default: return s.graph.input(in);
      }
    };
    copy.nodes(paragraph_.roots(), input);
    for (const auto& [to, node] : paragraph_.stores)
      s.stores.push_back({{to.role, to.component, alone_ ? s.body : ir::Address::own}, copy.node(node, input)});
    for (Carried c : paragraph_.carried) {
      c.node = copy.node(c.node, input);
      s.carried.push_back(c);
    }
    return s;
  }

  const ir::Segment& segment_;
  const ir::SegmentCode& code_;
  const ir::Paragraph& paragraph_;
  const bool alone_;
};

long operations(const ir::Graph& graph, const std::vector<NodeId>& roots) {
  return ir::count(graph, ir::uses(graph, roots)).total();
}

// A loop over limbs side by side that could be written out.
struct Candidate {
  ir::Paragraph* loop;
  std::vector<LimbStep> steps;
  double left = 1;  // of its operations
  long longer = 0;  // its text, in operations
};

Candidate candidate(ir::Paragraph& loop, std::vector<LimbStep> steps) {
  long written = 0;
  for (const LimbStep& step : steps) written += operations(step.graph, step.roots());
  const long of_step = operations(loop.graph, loop.roots());
  return {&loop, std::move(steps), static_cast<double>(written) / static_cast<double>(std::max(1L, of_step * loop.loop.steps)),
          written - of_step};
}

// Those that pay, the ones of which the least is left first. Measured: what a loop itself takes is worth what a tenth of a
// short one takes, but text beyond what the nearest caches hold is fetched anew in every call.
void write_out(std::vector<Candidate> candidates) {
  constexpr double most_left = 0.9;
  constexpr long room = 1200;
  std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) { return a.left < b.left; });
  long taken = 0;
  for (Candidate& c : candidates) {
    if (c.left > most_left || taken + c.longer > room) continue;
    taken += std::max(0L, c.longer);
    c.loop->written = std::move(c.steps);
  }
}

}  // namespace

void write_limbs(const ir::Plan& plan, ir::RolledProgram& program) {
  if (!plan.write_limbs) return;
  std::vector<Candidate> side_by_side;
  for (std::size_t i = 0; i < plan.segments.size(); ++i) {
    ir::SegmentCode& code = program.segments[i];
    for (ir::SegmentStage& stage : code.stages)
      for (ir::Paragraph& p : stage.paragraphs) {
        if (!p.loop.by_steps() || p.loop.steps > most_steps) continue;
        std::vector<LimbStep> steps = LimbWriter(plan.segments[i], code, p).run();
        // A limb that stands alone has no lanes to fill: its loop gains nothing.
        if (p.loop.width == 1) p.written = std::move(steps);
        else side_by_side.push_back(candidate(p, std::move(steps)));
      }
  }
  write_out(std::move(side_by_side));
}

}  // namespace dalembert::passes
