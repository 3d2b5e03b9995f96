#include "backend/task_plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "backend/code_text.hpp"
#include "backend/emit_rolled.hpp"
#include "backend/estimate.hpp"

namespace dalembert::backend {
namespace {

// What tasks cost beside what they compute, ns: each task; what one leaves in another core's caches; and of a call, each thread
// that is asked for help, and how long it takes to come. Read off when tasks began and ended, of trees of 200 to 500 joints on
// two cores (AMD EPYC, Zen 4).
constexpr double task_cost = 60, hand_over = 250, ask_cost = 100;
// ns a byte: of what other threads have read since the last call, each line is taken back from their caches before it is
// written.
constexpr double taken_back = 4.0 / 64;
// Smaller tasks are joined with others where that is not expected to make the whole slower.
constexpr double grain = 4000;
// Of what threads divide: a unit, ns; the least part of columns that take more the further down they are; and how much more
// columns take in pieces, several cores writing; and the least part of a limb that has to be copied.
constexpr double unit = 100, part_of_columns = 1000, part_of_limb = 2000, in_pieces = 1.08;
// More tasks are joined without weighing: what is weighed costs the square of their number, for every pair.
constexpr size_t most_tasks = 96;
constexpr int most_parts = 64;  // of a segment's columns
// For what choices of how many threads are weighed.
constexpr int usual_threads[] = {2, 4, 8};

struct Edges {
  std::vector<std::set<int>> after, before;  // of each task: those it comes after, those that come after it

  explicit Edges(const std::vector<Task>& tasks) : after(tasks.size()), before(tasks.size()) {
    for (size_t t = 0; t < tasks.size(); ++t)
      for (const int a : tasks[t].after) after[t].insert(a), before[static_cast<size_t>(a)].insert(static_cast<int>(t));
  }
};

// Of each task: ns from its beginning to the end of all, on the longest way.
std::vector<double> ways(const std::vector<Task>& tasks, const Edges& edges) {
  std::vector<double> way(tasks.size(), -1);
  const auto of = [&](const auto& self, size_t t) -> double {
    if (way[t] >= 0) return way[t];
    double longest = 0;
    for (const int b : edges.before[t]) longest = std::max(longest, self(self, static_cast<size_t>(b)));
    return way[t] = longest + tasks[t].nanoseconds + task_cost;
  };
  for (size_t t = 0; t < tasks.size(); ++t) of(of, t);
  return way;
}

// In an order they can run in, longest way first; without edges that follow from others.
std::vector<Task> in_order(const std::vector<Task>& tasks) {
  const Edges edges(tasks);
  const std::vector<double> way = ways(tasks, edges);
  std::vector<int> order(tasks.size()), number(tasks.size());
  std::iota(order.begin(), order.end(), 0);
  // A task's way is longer than that of any that comes after it.
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return way[static_cast<size_t>(a)] > way[static_cast<size_t>(b)]; });
  for (size_t i = 0; i < order.size(); ++i) number[static_cast<size_t>(order[i])] = static_cast<int>(i);
  std::vector<Task> sorted;
  std::vector<std::set<int>> closure(tasks.size());
  for (size_t i = 0; i < order.size(); ++i) {
    Task task = tasks[static_cast<size_t>(order[i])];
    for (int& a : task.after) a = number[static_cast<size_t>(a)];
    std::sort(task.after.begin(), task.after.end());
    for (const int a : task.after) {
      const auto& further = closure[static_cast<size_t>(a)];
      closure[i].insert(further.begin(), further.end());
    }
    std::erase_if(task.after, [&](int a) { return closure[i].contains(a); });
    closure[i].insert(task.after.begin(), task.after.end());
    sorted.push_back(std::move(task));
  }
  return sorted;
}

// Whether one can follow the other directly in one task: no third stands between them.
bool can_join(const Edges& edges, int a, int b) {
  const auto reaches = [&](int from, int to) {
    std::vector<int> todo(edges.before[static_cast<size_t>(from)].begin(), edges.before[static_cast<size_t>(from)].end());
    std::set<int> seen(todo.begin(), todo.end());
    seen.erase(to), std::erase(todo, to);  // directly is no matter
    while (!todo.empty()) {
      const int t = todo.back();
      todo.pop_back();
      for (const int next : edges.before[static_cast<size_t>(t)]) {
        if (next == to) return true;
        if (seen.insert(next).second) todo.push_back(next);
      }
    }
    return false;
  };
  return !reaches(a, b) && !reaches(b, a);
}

// One task in place of two; their calls in the order of the graph.
std::vector<Task> joined(const std::vector<Task>& tasks, int a, int b) {
  const int first = std::min(a, b), second = std::max(a, b);
  std::vector<Task> all = tasks;
  Task &into = all[static_cast<size_t>(first)], &from = all[static_cast<size_t>(second)];
  into.calls.insert(into.calls.end(), from.calls.begin(), from.calls.end());
  into.reads_state = into.reads_state || from.reads_state;
  into.nanoseconds += from.nanoseconds;
  into.handed_on += from.handed_on;
  into.after.insert(into.after.end(), from.after.begin(), from.after.end());
  all.erase(all.begin() + second);
  for (size_t t = 0; t < all.size(); ++t) {
    std::set<int> after;
    for (const int before : all[t].after) {
      const int now = before == second ? first : before - (before > second ? 1 : 0);
      if (now != static_cast<int>(t)) after.insert(now);
    }
    all[t].after.assign(after.begin(), after.end());
  }
  return in_order(all);
}

// Neighbours in an order that they can run in become one task: no third can stand between them. As little at a time as gives
// most_tasks.
std::vector<Task> neighbours_joined(const std::vector<Task>& tasks) {
  std::vector<int> group(tasks.size());
  int groups = static_cast<int>(tasks.size());
  for (double most = grain; static_cast<size_t>(groups) > most_tasks; most *= 2) {
    groups = 0;
    double time = 0;
    for (size_t t = 0; t < tasks.size(); ++t) {
      if (t > 0 && time + tasks[t].nanoseconds > most) ++groups, time = 0;
      time += tasks[t].nanoseconds;
      group[t] = groups;
    }
    ++groups;
  }
  if (static_cast<size_t>(groups) == tasks.size()) return tasks;
  std::vector<Task> all(static_cast<size_t>(groups));
  std::vector<std::set<int>> after(all.size());
  for (size_t t = 0; t < tasks.size(); ++t) {
    Task& into = all[static_cast<size_t>(group[t])];
    if (into.calls.empty()) into.name = tasks[t].name;
    into.calls.insert(into.calls.end(), tasks[t].calls.begin(), tasks[t].calls.end());
    into.reads_state = into.reads_state || tasks[t].reads_state;
    into.nanoseconds += tasks[t].nanoseconds;
    into.handed_on += tasks[t].handed_on;
    for (const int a : tasks[t].after)
      if (group[static_cast<size_t>(a)] != group[t]) after[static_cast<size_t>(group[t])].insert(group[static_cast<size_t>(a)]);
  }
  for (size_t t = 0; t < all.size(); ++t) all[t].after.assign(after[t].begin(), after[t].end());
  return in_order(all);
}

TaskSchedule schedule_of(const std::vector<Task>& tasks, const ir::ThreadCosts& costs, int threads) {
  const Edges edges(tasks);
  TaskSchedule schedule;
  schedule.runs.resize(tasks.size());
  std::vector<double> idle(static_cast<size_t>(std::max(threads, 1)));
  const double asked = tasks.size() > 1 ? ask_cost * (threads - 1) : 0;
  for (size_t t = 0; t < idle.size(); ++t) idle[t] = asked + (t > 0 ? costs.coming : 0);
  std::vector<bool> begun(tasks.size(), false);
  for (size_t count = 0; count < tasks.size(); ++count) {
    // Who can begin a task first takes the first of those that can run then.
    size_t thread = 0;
    int task = -1;
    double at = 0;
    for (size_t h = 0; h < idle.size(); ++h)
      for (size_t t = 0; t < tasks.size(); ++t) {
        if (begun[t]) continue;
        double ready = idle[h];
        bool can = true;
        for (const int a : tasks[t].after) {
          const Run& run = schedule.runs[static_cast<size_t>(a)];
          can = can && begun[static_cast<size_t>(a)];
          ready = std::max(ready, run.end + (run.thread == static_cast<int>(h) ? 0 : hand_over));
        }
        if (!can || (task >= 0 && ready >= at)) continue;
        thread = h, task = static_cast<int>(t), at = ready;
      }
    Run& run = schedule.runs[static_cast<size_t>(task)];
    const Task& begins = tasks[static_cast<size_t>(task)];
    run = {static_cast<int>(thread), at,
           at + task_cost + begins.nanoseconds + (threads > 1 ? taken_back * begins.handed_on : 0)};
    begun[static_cast<size_t>(task)] = true;
    idle[thread] = run.end;
    schedule.nanoseconds = std::max(schedule.nanoseconds, run.end);
  }
  return schedule;
}

double expected(const std::vector<Task>& tasks, const ir::ThreadCosts& costs) {
  double sum = 0;
  for (const int threads : usual_threads) sum += schedule_of(tasks, costs, threads).nanoseconds;
  return sum;
}

double sum_of(const std::vector<Task>& tasks) {
  double sum = 0;
  for (const Task& t : tasks) sum += t.nanoseconds;
  return sum;
}

// What a thread prepares that takes the tasks from one time to another of all of them, ns.
double prepared(const TaskPlan& plan, double from, double to) {
  std::set<int> needs;
  double at = 0;
  for (const Task& t : plan.tasks) {
    if (at < to && at + t.nanoseconds > from) needs.insert(t.after.begin(), t.after.end());
    at += t.nanoseconds;
  }
  double sum = 0;
  for (const int p : needs) sum += plan.preparations[static_cast<size_t>(p)].nanoseconds;
  return sum;
}

// Of tasks that threads divide as they come: all that take part are done at the same time.
TaskSchedule schedule_of_divided(const TaskPlan& plan, int threads) {
  TaskSchedule schedule;
  const double alone = sum_of(plan.tasks), elements = threads > 1 ? in_pieces * alone : alone;
  const double asked = threads > 1 ? ask_cost * (threads - 1) : 0;
  double begins = 0;  // the sum over those who take part
  for (int t = 0; t < std::max(threads, 1); ++t) {
    const double needs = t == 0 && !plan.end->calls.empty() ? sum_of(plan.preparations)
                                                            : prepared(plan, alone * t / threads, alone * (t + 1) / threads);
    const double from = asked + (t > 0 ? plan.costs.coming : 0), to = from + needs;
    if (t > 0 && (begins + elements) / t <= to) break;  // it finds nothing left
    begins += to;
    schedule.begins.push_back({t, from, to});
  }
  const double done =
      (begins + elements) / static_cast<double>(schedule.begins.size()) + (schedule.begins.size() > 1 ? plan.costs.parting : 0);
  for (const Run& begin : schedule.begins) schedule.runs.push_back({begin.thread, begin.end, done});
  schedule.end = Run{0, done, done + plan.end->nanoseconds};
  schedule.nanoseconds = schedule.end->end;
  return schedule;
}

std::vector<Task> joined_where_small(std::vector<Task> tasks, const ir::ThreadCosts& costs) {
  std::set<std::string> stay;  // small tasks that are better alone
  double now = expected(tasks, costs);
  while (tasks.size() > 1) {
    int smallest = -1;
    for (size_t t = 0; t < tasks.size(); ++t)
      if (tasks[t].nanoseconds < grain && !stay.contains(tasks[t].name) &&
          (smallest < 0 || tasks[t].nanoseconds < tasks[static_cast<size_t>(smallest)].nanoseconds))
        smallest = static_cast<int>(t);
    if (smallest < 0) break;
    const Edges edges(tasks);
    std::set<int> others = edges.after[static_cast<size_t>(smallest)];
    others.insert(edges.before[static_cast<size_t>(smallest)].begin(), edges.before[static_cast<size_t>(smallest)].end());
    // Of those beside it, which come after the same or before it, the one that takes least.
    int beside = -1;
    for (size_t t = 0; t < tasks.size(); ++t)
      if (static_cast<int>(t) != smallest &&
          (edges.after[t] == edges.after[static_cast<size_t>(smallest)] ||
           edges.before[t] == edges.before[static_cast<size_t>(smallest)]) &&
          (beside < 0 || tasks[t].nanoseconds < tasks[static_cast<size_t>(beside)].nanoseconds))
        beside = static_cast<int>(t);
    if (beside >= 0) others.insert(beside);
    std::vector<Task> best;
    double least = now * (1 + 1e-9);
    for (const int other : others) {
      if (!can_join(edges, smallest, other)) continue;
      std::vector<Task> then = joined(tasks, smallest, other);
      const double time = expected(then, costs);
      if (time > least) continue;
      least = time;
      best = std::move(then);
    }
    if (best.empty()) {
      stay.insert(tasks[static_cast<size_t>(smallest)].name);
      continue;
    }
    tasks = std::move(best);
    now = least;
  }
  return tasks;
}

// Tasks one after another that nothing else waits for, nor they for anything else.
std::vector<Task> chains_joined(std::vector<Task> tasks) {
  for (bool found = true; found;) {
    found = false;
    const Edges edges(tasks);
    for (size_t t = 0; t < tasks.size() && !found; ++t) {
      if (tasks[t].after.size() != 1 || edges.before[static_cast<size_t>(tasks[t].after[0])].size() != 1) continue;
      tasks = joined(tasks, tasks[t].after[0], static_cast<int>(t));
      found = true;
    }
  }
  return tasks;
}

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
      const int parts = std::clamp(static_cast<int>(time / (s.width > 1 ? 2 * grain : grain)), 1,
                                   std::min(most_parts, std::max(1, joints / 4)));
      for (int part = 1; part < parts; ++part) {
        const int end = at + joints * part / parts / 4 * 4;
        if (end > begin) ranges.emplace_back(begin, end);
        begin = end;
      }
      at += joints;
      waiting = parts > 1 ? grain : waiting + time;
      if (waiting < grain && lane + 1 < limbs.size()) continue;
      if (at > begin) ranges.emplace_back(begin, at);
      begin = at, waiting = 0;
    }
    return ranges;
  }
  for (const auto& [begin, end, share] : columns_side_by_side(code, s, static_cast<int>(nanoseconds / grain)))
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
    if (!b.elements.empty() && plan.end->calls.empty()) plan.end->calls.push_back("static_cast<void>(scratch)");
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
  tasks = in_order(tasks);
  if (code.plan.join_tasks) tasks = joined_where_small(chains_joined(neighbours_joined(tasks)), costs);
  return {std::move(tasks), {}, {}, costs};
}

}  // namespace

TaskSchedule schedule_tasks(const TaskPlan& plan, int threads) {
  return plan.divided() ? schedule_of_divided(plan, threads) : schedule_of(plan.tasks, plan.costs, threads);
}

bool worth_a_graph(const TaskPlan& plan) { return useful_threads(plan) > 1; }

int useful_threads(const TaskPlan& plan) {
  int best = 1;
  double least = serial_time(plan);
  const int most = plan.divided() ? 64 : std::min(static_cast<int>(plan.tasks.size()), 64);
  for (int threads = 2; threads <= most; ++threads) {
    const double time = schedule_tasks(plan, threads).nanoseconds;
    // Estimates err, and a second thread may be late: it has to be worth more than a further one.
    if (time < (best == 1 ? 0.85 : 0.97) * least) best = threads, least = time;
  }
  return best;
}

int threads_of(const CodeInput& code, const TaskPlan& plan) {
  if (plan.divided()) return code.plan.weigh_tasks ? useful_threads(plan) : 4;
  return code.plan.join_tasks ? useful_threads(plan) : static_cast<int>(plan.tasks.size());
}

int units_of(double nanoseconds) { return std::max(1, static_cast<int>(std::lround(nanoseconds / unit))); }

double serial_time(const TaskPlan& plan) {
  return sum_of(plan.tasks) + sum_of(plan.preparations) + (plan.end ? plan.end->nanoseconds : 0);
}

double critical_path(const TaskPlan& plan) {
  if (plan.divided()) {
    double longest = 0;
    for (const Task& t : plan.tasks) {
      double sum = 0;
      for (const int p : t.after) sum += plan.preparations[static_cast<size_t>(p)].nanoseconds;
      longest = std::max(longest, sum);
    }
    return (plan.end->calls.empty() ? longest : sum_of(plan.preparations)) + plan.end->nanoseconds;
  }
  const std::vector<double> way = ways(plan.tasks, Edges(plan.tasks));
  return way.empty() ? 0 : *std::max_element(way.begin(), way.end());
}

TaskPlan plan_tasks(const CodeInput& code) { return code.plan.sweeps_apart ? plan_apart(code) : plan_with_edges(code); }

bool better_apart(const CodeInput& code) {
  // Without what is joined every stage is to be a task.
  if (!code.plan.join_tasks || !can_sweep_apart(code)) return false;
  const TaskPlan apart = plan_apart(code);
  if (apart.tasks.empty() || !code.plan.weigh_tasks) return !apart.tasks.empty();
  if (!worth_a_graph(apart)) return false;
  const TaskPlan divided = plan_with_edges(code);
  double sum = 0;
  for (const int threads : usual_threads)
    sum += schedule_tasks(apart, threads).nanoseconds - schedule_tasks(divided, threads).nanoseconds;
  return sum < 0;
}

}  // namespace dalembert::backend
