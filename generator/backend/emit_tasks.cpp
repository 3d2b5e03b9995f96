#include "backend/emit_tasks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "backend/code_text.hpp"
#include "backend/emit_pairs.hpp"
#include "backend/emit_rolled.hpp"
#include "backend/templates.hpp"

namespace dalembert::backend {
namespace {

struct Task {
  std::string name;
  std::string call;
  bool reads_state = false;
};

struct Tasks {
  std::vector<Task> tasks;
  std::vector<std::pair<int, int>> edges;
};

// Multiply-adds of matrices of pairs that make a task worth its hand-over: a few microseconds.
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

// The graph's edges follow from what the stages are: of which segment, at which level.
class Edges {
 public:
  Edges(const CodeInput& code, const std::vector<Stage>& stages) : code_(code), stages_(stages) {}

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
      return t.level == s.level && (hangs_on(t.segment, s.segment) || share_parent(s.segment, t.segment));
    });
    for (const ir::SegmentStage& stage : code_.rolled.segments[static_cast<size_t>(s.segment)].stages)
      for (const ir::Paragraph& p : stage.paragraphs)
        for (ir::NodeId id = 0; id < p.graph.size() && stage.level == s.level; ++id) {
          const ir::Node& n = p.graph[id];
          if (n.op != ir::Op::input || n.input.kind != ir::InputKind::of_body || n.input.body < 0) continue;
          const int other = code_.plan.segment_of(n.input.body);
          add([&](const Stage& t) { return t.kind == Stage::Kind::segment && t.segment == other && t.level < s.level; });
        }
  }

  const ir::Segment& at(int segment) const { return code_.plan.segments[static_cast<size_t>(segment)]; }
  std::set<int> parents(int segment) const {
    std::set<int> bodies;
    for (size_t lane = 0; lane < at(segment).parents.size(); ++lane)
      if (at(segment).bodies[lane].front() >= 0) bodies.insert(at(segment).parents[lane]);
    return bodies;
  }
  bool hangs_on(int segment, int other) const {
    for (int parent : parents(segment))
      if (parent >= 0 && code_.plan.segment_of(parent) == other) return true;
    return false;
  }
  bool share_parent(int a, int b) const {
    const std::set<int> of_b = parents(b);
    for (int parent : parents(a))
      if (of_b.contains(parent)) return true;
    return false;
  }
  bool is_above(int segment, int below) const {
    if (segment == below) return true;
    for (int parent : parents(below))
      if (parent >= 0 && is_above(segment, code_.plan.segment_of(parent))) return true;
    return false;
  }

  const CodeInput& code_;
  const std::vector<Stage>& stages_;
};

// Without what follows from others.
std::vector<std::set<size_t>> reduced(std::vector<std::set<size_t>> before) {
  std::vector<std::set<size_t>> closure = before;
  for (size_t i = 0; i < before.size(); ++i)
    for (size_t j : std::set<size_t>(before[i])) closure[i].insert(closure[j].begin(), closure[j].end());
  for (auto& direct : before) {
    const std::set<size_t> all = direct;
    for (size_t j : all)
      for (size_t k : all)
        if (j != k && closure[k].contains(j)) direct.erase(j);
  }
  return before;
}

// The vectors as the graph holds them between calls; a second half has its last from its first half.
std::string held_arguments(const CodeInput& code) {
  if (is_called(code)) return fmt::format("{}_", fmt::join(vectors_of(code), "_, "));
  return "q_, v_, w->" + function_of(code).accelerations;
}

// Of a function, or of one half of it, whose tasks' names begin with `prefix`.
Tasks tasks_of(const CodeInput& code, const std::string& prefix) {
  Tasks t;
  if (code.plan.form != ir::Form::rolled) {  // one piece of code, one task
    const std::string name = function_of(code).name;
    t.tasks.push_back({name, fmt::format("{}::{}({}, *w)", code.name, name, held_arguments(code)), true});
    return t;
  }
  const std::vector<Stage> stages = rolled_stages(code);
  std::vector<std::vector<int>> tasks_of_stage;
  for (const Stage& s : stages) {
    tasks_of_stage.emplace_back();
    const std::string first = s.reads_state ? held_arguments(code) + ", *w" : "*w";
    const auto add = [&](const std::string& name, const std::string& arguments) {
      tasks_of_stage.back().push_back(static_cast<int>(t.tasks.size()));
      t.tasks.push_back(
          {prefix + name, fmt::format("{}::{}({}{})", own_name(code, "stages"), s.name, first, arguments), s.reads_state});
    };
    if (s.kind != Stage::Kind::elements) {
      add(s.name, "");
      continue;
    }
    const ir::Segment& segment = code.plan.segments[static_cast<size_t>(s.segment)];
    for (const auto& [begin, end] : column_ranges(code, segment))
      add(fmt::format("{}_{}", s.name, begin), elements_split(segment) ? fmt::format(", {}, {}", begin, end) : "");
  }
  std::vector<std::set<size_t>> before;
  const Edges edges(code, stages);
  for (size_t i = 0; i < stages.size(); ++i) before.push_back(edges.before(i));
  before = reduced(std::move(before));
  for (size_t i = 0; i < stages.size(); ++i)
    for (size_t j : before[i])
      for (int from : tasks_of_stage[j])
        for (int to : tasks_of_stage[i]) t.edges.emplace_back(from, to);
  return t;
}

// Of a function that users call: first one half, then the other. Straight code calls the second half itself.
Tasks tasks_of(const Folder& folder, const CodeInput& code) {
  Tasks t = tasks_of(code, "");
  std::string prefix;
  if (code.plan.form != ir::Form::rolled) return t;
  for (const CodeInput* second = folder.second_half_of(code); second; second = folder.second_half_of(*second)) {
    const int before = static_cast<int>(t.tasks.size());
    const Tasks then = tasks_of(*second, prefix += "then_");
    std::set<int> last, later;
    for (int i = 0; i < before; ++i) last.insert(i);
    for (const auto& [from, to] : t.edges) last.erase(from);
    for (const auto& [from, to] : then.edges) {
      later.insert(to);
      t.edges.emplace_back(before + from, before + to);
    }
    for (int i = 0; i < static_cast<int>(then.tasks.size()); ++i) {
      t.tasks.push_back(then.tasks[static_cast<size_t>(i)]);
      for (const int from : last)
        if (!later.contains(i)) t.edges.emplace_back(from, before + i);
    }
  }
  return t;
}

}  // namespace

std::string tasks_header(const Folder& folder, const std::string& banner) {
  std::string classes;
  for (const CodeInput& code : folder.functions) {
    if (!code.plan.tasks || !is_called(code)) continue;
    std::string members;
    for (const std::string& vector : vectors_of(code)) members += fmt::format("  const Scalar* {}_ = nullptr;\n", vector);
    const EigenVectors eigen = eigen_vectors_of(code);
    classes += render("task_graph.hpp", {{"function", function_of(code).name},
                                         {"type", own_type(code, "TaskGraph")},
                                         {"tasks", std::to_string(tasks_of(folder, code).tasks.size())},
                                         {"parameters", parameters_of(code)},
                                         {"arguments", arguments_of(code)},
                                         {"eigen_templates", eigen.templates},
                                         {"eigen_types", eigen.types},
                                         {"eigen_vectors", eigen.vectors},
                                         {"eigen_parameters", eigen.parameters},
                                         {"members", members}});
  }
  return render("tasks.hpp", {{"banner", banner}, {"name", folder.common().name}, {"classes", classes}});
}

std::string tasks_source(const Folder& folder, const std::string& banner) {
  std::string classes;
  for (const CodeInput& code : folder.functions) {
    if (!code.plan.tasks || !is_called(code)) continue;
    const Tasks t = tasks_of(folder, code);
    std::string nodes, edges, keep;
    for (const Task& task : t.tasks)
      nodes += fmt::format("  const int {} = graph_.add([{}w] {{ {}; }});\n", task.name, task.reads_state ? "this, " : "",
                           task.call);
    for (const auto& [before, after] : t.edges)
      edges += fmt::format("  graph_.edge({}, {});\n", t.tasks[static_cast<size_t>(before)].name,
                           t.tasks[static_cast<size_t>(after)].name);
    for (const Task& task : t.tasks) edges += fmt::format("  static_cast<void>({});\n", task.name);
    for (const std::string& vector : vectors_of(code)) keep += fmt::format("  {0}_ = {0};\n", vector);
    classes += render("task_graph.cpp", {{"function", function_of(code).name},
                                         {"type", own_type(code, "TaskGraph")},
                                         {"parameters", parameters_of(code)},
                                         {"nodes", nodes},
                                         {"edges", edges},
                                         {"keep", keep}});
  }
  return render("tasks.cpp", {{"banner", banner}, {"name", folder.common().name}, {"classes", classes}});
}

}  // namespace dalembert::backend
