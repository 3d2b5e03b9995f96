#include "backend/emit_tasks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

#include "backend/code_text.hpp"
#include "backend/task_plan.hpp"
#include "backend/templates.hpp"

namespace dalembert::backend {

std::string tasks_header(const Folder& folder, const std::string& banner) {
  std::string classes;
  for (const CodeInput& code : folder.functions) {
    if (!code.plan.tasks || !is_called(code)) continue;
    std::string members;
    for (const std::string& vector : vectors_of(code)) members += fmt::format("  const Scalar* {}_ = nullptr;\n", vector);
    const EigenVectors eigen = eigen_vectors_of(code);
    classes += render("task_graph.hpp", {{"function", function_of(code).name},
                                         {"type", own_type(code, "TaskGraph")},
                                         {"tasks", std::to_string(plan_tasks(folder, code).size())},
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
    const std::vector<Task> tasks = plan_tasks(folder, code);
    std::string nodes, edges, keep;
    std::set<std::string> numbered;
    for (const Task& task : tasks)
      for (const int before : task.after) numbered.insert({task.name, tasks[static_cast<size_t>(before)].name});
    for (const Task& task : tasks) {
      const std::string calls = task.calls.size() == 1 ? " " + task.calls.front() + "; "
                                                       : fmt::format("\n    {};\n  ", fmt::join(task.calls, ";\n    "));
      const std::string number = numbered.contains(task.name) ? fmt::format("const int {} = ", task.name) : "";
      nodes += fmt::format("  {}graph_.add([{}w] {{{}}});\n", number, task.reads_state ? "this, " : "", calls);
    }
    for (const Task& task : tasks)
      for (const int before : task.after)
        edges += fmt::format("  graph_.edge({}, {});\n", tasks[static_cast<size_t>(before)].name, task.name);
    for (const std::string& vector : vectors_of(code)) keep += fmt::format("  {0}_ = {0};\n", vector);
    classes +=
        render("task_graph.cpp",
               {{"function", function_of(code).name},
                {"type", own_type(code, "TaskGraph")},
                {"parameters", parameters_of(code)},
                {"threads", std::to_string(code.plan.join_tasks ? useful_threads(tasks) : static_cast<int>(tasks.size()))},
                {"nodes", nodes},
                {"edges", edges},
                {"keep", keep}});
  }
  return render("tasks.cpp", {{"banner", banner}, {"name", folder.common().name}, {"classes", classes}});
}

}  // namespace dalembert::backend
