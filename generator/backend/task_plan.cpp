#include "backend/task_plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "backend/code_text.hpp"
#include "backend/emit_rolled.hpp"
#include "backend/estimate.hpp"

namespace dalembert::backend {
namespace {

using ir::Task;
using ir::TaskPlan;

// Of what threads divide: the least part, ns, of columns that take more the further down they are, and of a limb that has to be
// copied.
constexpr double part_of_columns = 1000, part_of_limb = 2000;
constexpr int most_parts = 64;  // of a segment's columns

int depth(const CodeInput& code, int body) {
  int count = 0;
  for (; body >= 0; body = code.tree.bodies[static_cast<size_t>(body)].parent) ++count;
  return count;
}

// A segment's limbs, one after another.
struct Limb {
  int joints;
  double nanoseconds;  // its share
};
std::vector<Limb> limbs_of(const CodeInput& code, const ir::Segment& s, double nanoseconds) {
  std::vector<Limb> limbs;
  double all = 0;
  for (size_t lane = 0; lane < s.bodies.size(); ++lane) {
    const auto& limb = s.bodies[lane];
    const int joints = static_cast<int>(std::count_if(limb.begin(), limb.end(), [](int b) { return b >= 0; }));
    limbs.push_back({joints, joints * (joints + 2.0 * depth(code, s.parents[lane]))});
    all += limbs.back().nanoseconds;
  }
  for (Limb& limb : limbs) limb.nanoseconds *= nanoseconds / all;
  return limbs;
}

// Columns of limbs side by side, as shares of what all of them take: they take more the further down they are.
struct ColumnRange {
  int begin, end;
  double share;
};
std::vector<ColumnRange> columns_side_by_side(const CodeInput& code, const ir::Segment& s, int parts) {
  const int columns = s.columns();
  int above = 0;
  for (const int parent : s.parents) above = std::max(above, depth(code, parent));
  const auto cost = [&](int column) { return column + 4.0 + above; };
  double all = 0, sum = 0, before = 0;
  for (int c = 0; c < columns; ++c) all += cost(c);
  parts = std::clamp(parts, 1, std::min(most_parts, std::max(1, (columns + 3) / 4)));
  std::vector<ColumnRange> ranges;
  int begin = 0;
  for (int c = 0; c < columns; c += 4) {  // tiles of four
    const int end = std::min(c + 4, columns);
    for (int k = c; k < end; ++k) sum += cost(k);
    if (end < columns && sum < all * static_cast<double>(ranges.size() + 1) / parts) continue;
    ranges.push_back({begin, end, (sum - before) / all});
    begin = end, before = sum;
  }
  return ranges;
}

// Parts of a segment's columns: of limbs one after another whole limbs, or parts of one; else parts that take about as long.
std::vector<std::pair<int, int>> column_ranges(const CodeInput& code, const ir::Segment& s, double nanoseconds) {
  if (!code.plan.join_tasks) nanoseconds = 1e9;  // as many as there can be
  if (!s.splits_columns()) return {{0, s.columns()}};
  std::vector<std::pair<int, int>> ranges;
  if (s.limb_after_limb) {
    double waiting = 0;  // of limbs that are too short for a part of their own
    int begin = 0, at = 0;
    const std::vector<Limb> limbs = limbs_of(code, s, nanoseconds);
    for (size_t lane = 0; lane < limbs.size(); ++lane) {
      const auto& [joints, time] = limbs[lane];
      // Parts of one limb each copy it, where limbs stand side by side.
      const int parts = std::clamp(static_cast<int>(time / (s.width > 1 ? 2 * ir::task_grain : ir::task_grain)), 1,
                                   std::min(most_parts, std::max(1, joints / 4)));
      for (int part = 1; part < parts; ++part) {
        const int end = at + joints * part / parts / 4 * 4;
        if (end > begin) ranges.emplace_back(begin, end);
        begin = end;
      }
      at += joints;
      waiting = parts > 1 ? ir::task_grain : waiting + time;
      if (waiting < ir::task_grain && lane + 1 < limbs.size()) continue;
      if (at > begin) ranges.emplace_back(begin, at);
      begin = at, waiting = 0;
    }
    return ranges;
  }
  for (const auto& [begin, end, share] : columns_side_by_side(code, s, static_cast<int>(nanoseconds / ir::task_grain)))
    ranges.emplace_back(begin, end);
  return ranges;
}

// Which stages must have run before another: it follows from what they are, of which segment and at which level.
class StageOrder {
 public:
  StageOrder(const CodeInput& code, const std::vector<Stage>& stages)
      : code_(code), stages_(stages), segment_of_(code.tree.bodies.size(), -1) {
    const std::vector<ir::Segment>& segments = code.plan.segments;
    for (size_t s = 0; s < segments.size(); ++s)
      for (const std::vector<int>& limb : segments[s].bodies)
        for (const int body : limb)
          if (body >= 0) segment_of_[static_cast<size_t>(body)] = static_cast<int>(s);
    for (size_t s = 0; s < segments.size(); ++s) {  // parents before children
      std::set<int> parents, on, above{static_cast<int>(s)};
      for (size_t lane = 0; lane < segments[s].parents.size(); ++lane)
        if (segments[s].bodies[lane].front() >= 0) parents.insert(segments[s].parents[lane]);
      for (const int parent : parents)
        if (parent >= 0) on.insert(segment_of_[static_cast<size_t>(parent)]);
      // Who adds to nothing shares nothing: limbs on a base that stands.
      std::set<int> added;
      for (const ir::SegmentStage& stage : code.rolled.segments[s].stages)
        for (const ir::Paragraph& p : stage.paragraphs)
          for (const ir::HandedOn& h : p.handed) added.insert(h.to.body);
      for (const int other : on)
        above.insert(above_[static_cast<size_t>(other)].begin(), above_[static_cast<size_t>(other)].end());
      adds_to_.push_back(std::move(added));
      on_.push_back(std::move(on));
      above_.push_back(std::move(above));
    }
  }

  // Stages that must have run before stage `of`, by their numbers.
  std::set<size_t> before(size_t of) const {
    const Stage& s = stages_[of];
    std::set<size_t> all;
    const auto add = [&](const auto& wanted) {
      for (size_t i = 0; i < of; ++i)
        if (wanted(stages_[i])) all.insert(i);
    };
    switch (s.kind) {
      case Stage::Kind::base:
        add([&](const Stage& t) { return t.kind == Stage::Kind::segment || t.kind == Stage::Kind::base; });
        break;
      case Stage::Kind::segment: segment(s, add); break;
      case Stage::Kind::elements:
        // Its own factors, and those of the limbs above it.
        add([&](const Stage& t) { return t.kind == Stage::Kind::segment && is_above(t.segment, s.segment); });
        add([&](const Stage& t) { return t.kind == Stage::Kind::base && t.level == 0; });
        break;
      case Stage::Kind::results: add([](const Stage&) { return true; }); break;
    }
    return all;
  }

 private:
  template <class Add>
  void segment(const Stage& s, const Add& add) const {
    add([&](const Stage& t) { return t.kind == Stage::Kind::base && t.level <= s.level; });
    add([&](const Stage& t) { return t.kind == Stage::Kind::segment && t.segment == s.segment; });
    const bool outwards = s.level % 2 == 0;
    add([&](const Stage& t) {
      if (t.kind != Stage::Kind::segment || t.segment == s.segment) return false;
      if (outwards) return hangs_on(s.segment, t.segment);
      // What hangs on it; and, so that sums are the same however tasks run, whatever adds to the same bodies before.
      return t.level == s.level && (hangs_on(t.segment, s.segment) || add_to_one(s.segment, t.segment));
    });
    for (const ir::SegmentStage& stage : code_.rolled.segments[static_cast<size_t>(s.segment)].stages)
      for (const ir::Paragraph& p : stage.paragraphs)
        for (ir::NodeId id = 0; id < p.graph.size() && stage.level == s.level; ++id) {
          const ir::Node& n = p.graph[id];
          if (n.op != ir::Op::input || n.input.kind != ir::InputKind::kept || n.input.body < 0) continue;
          const int other = segment_of_[static_cast<size_t>(n.input.body)];
          add([&](const Stage& t) { return t.kind == Stage::Kind::segment && t.segment == other && t.level < s.level; });
        }
  }

  bool hangs_on(int segment, int other) const { return on_[static_cast<size_t>(segment)].contains(other); }
  bool add_to_one(int a, int b) const {
    for (const int parent : adds_to_[static_cast<size_t>(a)])
      if (adds_to_[static_cast<size_t>(b)].contains(parent)) return true;
    return false;
  }
  bool is_above(int segment, int below) const { return above_[static_cast<size_t>(below)].contains(segment); }

  const CodeInput& code_;
  const std::vector<Stage>& stages_;
  std::vector<int> segment_of_;         // per body
  std::vector<std::set<int>> adds_to_;  // per segment: bodies that it hands sums on to
  std::vector<std::set<int>> on_;       // … the segments of those that its limbs hang on
  std::vector<std::set<int>> above_;    // … itself and all segments above
};

// The vectors as the graph holds them between calls; what a section takes of those before it stands in the workspace.
std::string held_arguments(const CodeInput& code) {
  const ir::Section& section = code.algorithm.section;
  if (section.is_first()) return fmt::format("{}_", fmt::join(vectors_of(code), "_, "));
  return "q_, v_, w->" + code.algorithm.arrays[static_cast<size_t>(section.accelerations)].name;
}

ir::ThreadCosts costs_of(const CodeInput& code) { return code.plan.costs ? code.plan.costs->threads : ir::ThreadCosts{}; }

double stored_bytes(const CodeInput& code, const Stage& s) {
  const ir::Segment& segment = code.plan.segments[static_cast<size_t>(s.segment)];
  size_t components = 0;
  for (const ir::SegmentStage& stage : code.rolled.segments[static_cast<size_t>(s.segment)].stages)
    for (const ir::Paragraph& p : stage.paragraphs)
      if (stage.level == s.level) components += p.stores.size();
  return (code.scene.scalar == ir::ScalarType::float32 ? 4.0 : 8.0) * static_cast<double>(components) * segment.slots();
}

// Of a section, whose tasks' names begin with `prefix`; nothing joined yet.
std::vector<Task> tasks_of(const CodeInput& code, const std::string& prefix) {
  if (!code.is_rolled()) {  // one piece of code, one task
    const std::string& name = code.algorithm.section.name;
    return {{name,
             {fmt::format("{}::{}({}, *w)", code.name, name, held_arguments(code))},
             true,
             estimate(code, usual_lanes(code)),
             0,
             {}}};
  }
  std::vector<Task> tasks;
  const std::vector<Stage> stages = rolled_stages(code);
  const StageOrder order(code, stages);
  std::vector<std::vector<int>> tasks_of_stage;
  for (size_t i = 0; i < stages.size(); ++i) {
    const Stage& s = stages[i];
    const double nanoseconds = estimate(code, s, usual_lanes(code));
    const std::string first = s.reads_state ? held_arguments(code) + ", *w" : "*w";
    std::vector<int> after;
    for (const size_t before : order.before(i))
      after.insert(after.end(), tasks_of_stage[before].begin(), tasks_of_stage[before].end());
    tasks_of_stage.emplace_back();
    const double handed_on = s.kind == Stage::Kind::segment ? stored_bytes(code, s) : 0;
    const auto add = [&](const std::string& name, const std::string& arguments, double time) {
      tasks_of_stage.back().push_back(static_cast<int>(tasks.size()));
      const std::string call = fmt::format("{}::{}({}{})", own_name(code, "stages"), s.name, first, arguments);
      tasks.push_back({prefix + name, {call}, s.reads_state, time, handed_on, after});
    };
    if (s.kind != Stage::Kind::elements) {
      add(s.name, "", nanoseconds);
      continue;
    }
    const ir::Segment& segment = code.plan.segments[static_cast<size_t>(s.segment)];
    const auto ranges = column_ranges(code, segment, nanoseconds);
    for (const auto& [begin, end] : ranges)
      add(fmt::format("{}_{}", s.name, begin), segment.splits_columns() ? fmt::format(", {}, {}", begin, end) : "",
          nanoseconds / static_cast<double>(ranges.size()));
  }
  return tasks;
}

// Elements that threads divide, after preparations: parts of which each column takes about the same.
void add_elements(const CodeInput& code, const Stage& stage, double nanoseconds, const std::vector<int>& after,
                  std::vector<Task>& tasks) {
  const ir::Segment& segment = code.plan.segments[static_cast<size_t>(stage.segment)];
  const std::string call = fmt::format("{}::{}(scratch, *w", own_name(code, "stages"), stage.name);
  if (!segment.splits_columns()) {
    tasks.push_back({stage.name, {call + ")"}, false, nanoseconds, 0, after});
    return;
  }
  const double least = code.plan.weigh_tasks ? part_of_columns : 1;
  const auto add = [&](int from, int to, double time, int step) {
    const std::string first = from > 0 ? fmt::format("{} + ", from) : "";
    tasks.push_back({from > 0 ? fmt::format("{}_{}", stage.name, from) : stage.name,
                     {fmt::format("{}, {}begin, {}end)", call, first, first)},
                     false,
                     time,
                     0,
                     after,
                     to - from,
                     step});
  };
  if (segment.limb_after_limb) {
    int at = 0;
    for (const Limb& limb : limbs_of(code, segment, nanoseconds)) {
      if (limb.joints == 0) continue;
      // Each piece copies what it reads of its limb, where limbs stand side by side.
      const int pieces = std::max(1, static_cast<int>(limb.nanoseconds / part_of_limb));
      add(at, at + limb.joints, limb.nanoseconds, segment.width > 1 ? (limb.joints / pieces + 3) / 4 * 4 : 4);
      at += limb.joints;
    }
    return;
  }
  for (const auto& [begin, end, share] : columns_side_by_side(code, segment, static_cast<int>(nanoseconds / least)))
    add(begin, end, nanoseconds * share, 4);
}

// Of threads that sweep for themselves: sweeps and the base, of which each does what its elements come after; and the results.
TaskPlan plan_apart(const CodeInput& code) {
  TaskPlan plan{{}, {}, Task{"results", {}, true, 0, 0, {}}, costs_of(code)};
  const std::vector<Stage> stages = rolled_stages(code);
  const StageOrder order(code, stages);
  std::vector<std::set<int>> needs(stages.size());  // preparations; those of preparations with themselves
  for (size_t i = 0; i < stages.size(); ++i) {
    const Stage& s = stages[i];
    const double nanoseconds = estimate(code, s, usual_lanes(code));
    if (s.kind != Stage::Kind::results)
      for (const size_t before : order.before(i)) needs[i].insert(needs[before].begin(), needs[before].end());
    if (s.kind == Stage::Kind::elements) {
      add_elements(code, s, nanoseconds, {needs[i].begin(), needs[i].end()}, plan.tasks);
      continue;
    }
    const std::string call =
        fmt::format("{}::{}({}scratch, *w{})", own_name(code, "stages"), s.name,
                    s.reads_state ? held_arguments(code) + ", " : "", s.kind == Stage::Kind::base ? ", place == 0" : "");
    if (s.kind == Stage::Kind::results) {
      plan.end->calls.push_back(call);
      plan.end->nanoseconds += nanoseconds;
      continue;
    }
    needs[i].insert(static_cast<int>(plan.preparations.size()));
    plan.preparations.push_back({s.name, {call}, s.reads_state, nanoseconds, 0, {}});
  }
  // The base's elements are the caller's.
  for (const ir::BaseStage& b : code.rolled.base)
    if (!b.elements.empty() && plan.end->calls.empty())
      plan.end->calls.push_back("static_cast<void>(scratch), static_cast<void>(w)");
  return plan;
}

// Of tasks of which some come after others, a task's sweeps being for all.
TaskPlan plan_with_edges(const CodeInput& code) {
  std::vector<Task> tasks = tasks_of(code, "");
  std::string prefix;
  // Section by section. Straight code calls the next one itself.
  if (code.is_rolled())
    for (const CodeInput* section = code.next; section; section = section->next) {
      const int before = static_cast<int>(tasks.size());
      std::set<int> last;
      for (int i = 0; i < before; ++i) last.insert(i);
      for (const Task& t : tasks)
        for (const int a : t.after) last.erase(a);
      for (Task t : tasks_of(*section, prefix += "then_")) {
        if (t.after.empty()) t.after.assign(last.begin(), last.end());
        else
          for (int& a : t.after) a += before;
        tasks.push_back(std::move(t));
      }
    }
  const ir::ThreadCosts costs = costs_of(code);
  tasks = ir::in_order(tasks);
  if (code.plan.join_tasks) tasks = ir::joined(tasks, costs);
  return {std::move(tasks), {}, {}, costs};
}

}  // namespace

int threads_of(const CodeInput& code, const TaskPlan& plan) {
  if (plan.divided()) return code.plan.weigh_tasks ? ir::useful_threads(plan) : 4;
  return code.plan.join_tasks ? ir::useful_threads(plan) : static_cast<int>(plan.tasks.size());
}

TaskPlan plan_tasks(const CodeInput& code) { return code.plan.sweeps_apart ? plan_apart(code) : plan_with_edges(code); }

bool better_apart(const CodeInput& code) {
  // Without what is joined every stage is to be a task.
  if (!code.plan.join_tasks || !can_sweep_apart(code)) return false;
  const TaskPlan apart = plan_apart(code);
  if (apart.tasks.empty() || !code.plan.weigh_tasks) return !apart.tasks.empty();
  if (!ir::worth_a_graph(apart)) return false;
  const TaskPlan divided = plan_with_edges(code);
  double sum = 0;
  for (const int threads : ir::usual_threads)
    sum += ir::schedule_tasks(apart, threads).nanoseconds - ir::schedule_tasks(divided, threads).nanoseconds;
  return sum < 0;
}

}  // namespace dalembert::backend
