#include "backend/emit_tasks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "backend/emit_blocks.hpp"
#include "backend/emit_rolled.hpp"
#include "backend/templates.hpp"

namespace dalembert::backend {
namespace {

struct Task {
  std::string name;
  std::string call;
};

struct Tasks {
  std::vector<Task> tasks;
  std::vector<std::pair<int, int>> edges;

  int find(const std::string& name) const {
    for (size_t i = 0; i < tasks.size(); ++i)
      if (tasks[i].name == name) return static_cast<int>(i);
    return -1;
  }
  void edge(const std::string& before, const std::string& after) {
    const std::pair<int, int> e{find(before), find(after)};
    if (e.first >= 0 && e.second >= 0 && std::find(edges.begin(), edges.end(), e) == edges.end()) edges.push_back(e);
  }
};

// Multiply-adds of Phase III that make a task worth its hand-over: a few microseconds.
constexpr int pairs_per_task = 600;

// Splits a segment's columns so that each part has about the same number of elements.
std::vector<std::pair<int, int>> column_ranges(const CodeInput& code, const ir::Segment& s) {
  int above = 0;
  for (int parent : s.parents) {
    int depth = 0;
    for (int b = parent; b >= 0; b = code.tree.bodies[static_cast<size_t>(b)].parent) ++depth;
    above = std::max(above, depth);
  }
  if (!elements_split(s)) return {{0, s.steps}};
  std::vector<std::pair<int, int>> ranges;
  int begin = 0, pairs = 0;
  for (int c = 0; c < s.steps; c += 4) {
    pairs += 4 * (c + 4 + above);
    const int end = std::min(c + 4, s.steps);
    if (pairs < pairs_per_task && end < s.steps) continue;
    ranges.emplace_back(begin, end);
    begin = end;
    pairs = 0;
  }
  return ranges;
}

Tasks tasks_of(const CodeInput& code) {
  Tasks t;
  if (code.plan.form != ir::Form::rolled) {  // one piece of code, one task
    t.tasks.push_back({"evaluate", fmt::format("{}::evaluate(q_, v_, *w)", code.name)});
    return t;
  }
  const auto& segments = code.plan.segments;
  for (const Stage& stage : rolled_stages(code)) {
    const bool elements = stage.name.starts_with("elements_");
    if (!elements) {
      std::string arguments = stage.call == "q, v, workspace" ? "q_, v_, *w" : stage.call == "v, workspace" ? "v_, *w" : "*w";
      t.tasks.push_back({stage.name, fmt::format("stages::{}({})", stage.name, arguments)});
      continue;
    }
    for (const ir::Segment& s : segments) {
      if (stage.name != "elements_" + s.name) continue;
      for (const auto& [begin, end] : column_ranges(code, s))
        t.tasks.push_back({fmt::format("{}_{}", stage.name, begin),
                           elements_split(s) ? fmt::format("stages::{}(*w, {}, {})", stage.name, begin, end)
                                             : fmt::format("stages::{}(*w)", stage.name)});
    }
  }

  std::map<int, std::string> last_into;  // body (-1: base) → the last task that adds to its sums
  for (const ir::Segment& s : segments) {
    t.edge("prepare", "outwards_" + s.name);
    t.edge("outwards_" + s.name, "inwards_" + s.name);
    t.edge("inwards_" + s.name, "base");
    t.edge("inwards_" + s.name, "results");
    for (int parent : s.parents)
      if (const int at = code.plan.segment_of(parent); at >= 0) {
        const std::string& above = segments[static_cast<size_t>(at)].name;
        t.edge("outwards_" + above, "outwards_" + s.name);
        t.edge("inwards_" + s.name, "inwards_" + above);
      }
    for (const auto& [begin, end] : column_ranges(code, s)) {
      t.edge("inwards_" + s.name, fmt::format("elements_{}_{}", s.name, begin));
      t.edge(fmt::format("elements_{}_{}", s.name, begin), "results");
    }
  }
  // Segments that add to the same sums do so one after another, as in the serial order: last segments first.
  for (size_t i = segments.size(); i-- > 0;) {
    std::map<int, std::string> mine;
    for (size_t lane = 0; lane < segments[i].parents.size(); ++lane)
      if (segments[i].bodies[lane].front() >= 0) mine[segments[i].parents[lane]] = "inwards_" + segments[i].name;
    for (const auto& [parent, task] : mine) {
      if (last_into.contains(parent)) t.edge(last_into[parent], task);
      last_into[parent] = task;
    }
  }
  t.edge("prepare", "results");
  t.edge("prepare", "base");
  return t;
}

}  // namespace

std::string tasks_header(const CodeInput& code, const std::string& banner) {
  return render("tasks.hpp", {{"banner", banner}, {"name", code.name}, {"tasks", std::to_string(tasks_of(code).tasks.size())}});
}

std::string tasks_source(const CodeInput& code, const std::string& banner) {
  const Tasks t = tasks_of(code);
  std::string nodes, edges;
  for (const Task& task : t.tasks) {
    const bool state = task.call.find("q_") != std::string::npos || task.call.find("v_") != std::string::npos;
    nodes += fmt::format("  const int {} = graph_.add([{}w] {{ {}; }});\n", task.name, state ? "this, " : "", task.call);
  }
  for (const auto& [before, after] : t.edges)
    edges += fmt::format("  graph_.edge({}, {});\n", t.tasks[static_cast<size_t>(before)].name,
                         t.tasks[static_cast<size_t>(after)].name);
  for (const Task& task : t.tasks) edges += fmt::format("  static_cast<void>({});\n", task.name);
  return render("tasks.cpp", {{"banner", banner}, {"name", code.name}, {"nodes", nodes}, {"edges", edges}});
}

}  // namespace dalembert::backend
