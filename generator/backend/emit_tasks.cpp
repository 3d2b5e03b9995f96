#include "backend/emit_tasks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

#include "backend/code_name.hpp"
#include "backend/code_text.hpp"
#include "backend/literals.hpp"
#include "backend/task_plan.hpp"
#include "backend/templates.hpp"

namespace dalembert::backend {
namespace {

using ir::Task;
using ir::TaskPlan;

std::string calls_text(const Task& task) {
  return task.calls.size() == 1 ? " " + task.calls.front() + "; "
                                : fmt::format("\n    {};\n  ", fmt::join(task.calls, ";\n    "));
}

// Of tasks that come after others.
std::string graph_text(const std::vector<Task>& tasks) {
  std::string nodes, edges;
  std::set<std::string> numbered;
  for (const Task& task : tasks)
    for (const int before : task.after) numbered.insert({task.name, tasks[static_cast<size_t>(before)].name});
  for (const Task& task : tasks) {
    const std::string number = numbered.contains(task.name) ? fmt::format("const int {} = ", task.name) : "";
    nodes += fmt::format("  {}graph_.add([{}w] {{{}}});\n", number, task.reads_state ? "this, " : "", calls_text(task));
  }
  for (const Task& task : tasks)
    for (const int before : task.after)
      edges += fmt::format("  graph_.edge({}, {});\n", tasks[static_cast<size_t>(before)].name, task.name);
  return nodes + (edges.empty() ? "" : "\n" + edges);
}

// Of threads that sweep for themselves.
std::string divided_text(const CodeInput& code, const TaskPlan& plan) {
  const std::string scratch = own_type(code, "Scratch");
  const auto work = [&](const Task& task, const std::string& parameters) {
    return fmt::format(
        "[this, w]({}) {{\n    Workspace::{}& scratch = own_[static_cast<std::size_t>(place)].scratch;\n    {};\n  }}",
        parameters, scratch, fmt::join(task.calls, ";\n    "));
  };
  std::string text;
  std::set<int> needed;
  for (const Task& task : plan.tasks) needed.insert(task.after.begin(), task.after.end());
  for (size_t p = 0; p < plan.preparations.size(); ++p) {
    const Task& task = plan.preparations[p];
    text += fmt::format("  {}work_.prepare({}, {});\n",
                        needed.contains(static_cast<int>(p)) ? fmt::format("const int {} = ", task.name) : "",
                        work(task, "int place"), code.plan.weigh_tasks ? ir::units_of(task.nanoseconds) : 0);
  }
  for (const Task& task : plan.tasks) {
    std::vector<std::string> needs;
    for (const int p : task.after) needs.push_back(plan.preparations[static_cast<size_t>(p)].name);
    text += fmt::format("  work_.add({}, {}, {}, {}, {{{}}});\n",
                        work(task, task.step > 0 ? "int place, int begin, int end" : "int place, int, int"), task.columns,
                        task.step, ir::units_of(task.nanoseconds), fmt::join(needs, ", "));
  }
  if (!plan.end->calls.empty()) text += fmt::format("  work_.end_with({});\n", work(*plan.end, "int place"));
  return text;
}

std::string meaning_of(const TaskPlan& plan, const std::string& function) {
  if (plan.divided())
    return comment_lines(
        fmt::format("{0}() on several threads: each sweeps for itself, elements are divided among them. Runs the "
                    "very functions that the serial {0}() runs, and gives the same bits. Pays where elements take "
                    "tens of microseconds: on large trees.",
                    function));
  return comment_lines(fmt::format(
      "What {0}() is made of as a graph of tasks, built once: {1} tasks. Runs the very functions that the serial {0}() "
      "runs, in an order that the graph allows, and gives the same bits. Pays where a task takes microseconds: on "
      "large trees.",
      function, plan.tasks.size()));
}

}  // namespace

std::string tasks_header(const Folder& folder, const std::string& banner) {
  std::string classes;
  bool divided = false, graphs = false;
  for (const CodeInput& code : folder.functions) {
    if (!code.plan.tasks) continue;
    const TaskPlan plan = plan_tasks(code);
    (plan.divided() ? divided : graphs) = true;
    std::string members;
    for (const std::string& vector : vectors_of(code)) members += fmt::format("  const Scalar* {}_ = nullptr;\n", vector);
    if (plan.divided())
      members += fmt::format(
          "\n  // Each thread sweeps for itself. Between its values and others' room for what processors read ahead.\n"
          "  struct Own {{\n    Workspace::{} scratch;\n    alignas(64) unsigned char apart[4096];\n  }};\n"
          "  std::vector<Own> own_ = std::vector<Own>({});\n",
          own_type(code, "Scratch"), threads_of(code, plan));
    const EigenVectors eigen = eigen_vectors_of(code);
    classes +=
        render("task_graph.hpp", {{"function", function_of(code).name},
                                  {"type", own_type(code, "TaskGraph")},
                                  {"meaning", meaning_of(plan, function_of(code).name)},
                                  {"runner", plan.divided() ? "dalembert::DividedWork work_" : "dalembert::TaskGraph graph_"},
                                  {"parameters", parameters_of(code)},
                                  {"arguments", arguments_of(code)},
                                  {"eigen_templates", eigen.templates},
                                  {"eigen_types", eigen.types},
                                  {"eigen_vectors", eigen.vectors},
                                  {"eigen_parameters", eigen.parameters},
                                  {"members", members}});
  }
  const std::string includes = fmt::format("{}{}", divided ? "#include <dalembert/divided_work.hpp>\n" : "",
                                           graphs ? "#include <dalembert/task_graph.hpp>\n" : "");
  return render(
      "tasks.hpp",
      {{"banner", banner}, {"name", folder.common().name}, {"code", code_mark}, {"includes", includes}, {"classes", classes}});
}

std::string tasks_source(const Folder& folder, const std::string& banner) {
  std::string classes;
  for (const CodeInput& code : folder.functions) {
    if (!code.plan.tasks) continue;
    const TaskPlan plan = plan_tasks(code);
    std::string keep;
    for (const std::string& vector : vectors_of(code)) keep += fmt::format("  {0}_ = {0};\n", vector);
    classes += render("task_graph.cpp", {{"function", function_of(code).name},
                                         {"type", own_type(code, "TaskGraph")},
                                         {"parameters", parameters_of(code)},
                                         {"runner", plan.divided() ? "work_" : "graph_"},
                                         {"threads", std::to_string(threads_of(code, plan))},
                                         {"work", plan.divided() ? divided_text(code, plan) : graph_text(plan.tasks)},
                                         {"keep", keep}});
  }
  return render("tasks.cpp", {{"banner", banner}, {"name", folder.common().name}, {"code", code_mark}, {"classes", classes}});
}

}  // namespace dalembert::backend
