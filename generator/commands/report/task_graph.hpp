// All outputs together by the generated task graph, on all cores.
#pragma once

#include <memory>
#include <string>

#include "commands/generated_engine.hpp"
#include "commands/report/rows.hpp"
#include "commands/report/subject.hpp"

namespace dalembert::reporting {

inline constexpr const char* task_graph_variant = "task graph";

class TaskGraph {
 public:
  explicit TaskGraph(const Subject& subject) : subject_(subject) {}

  // What takes time and may run beside other work.
  void compile();

  // Adds to section `rounding`, quantity `all`, the time of the outputs together as a task graph in double, and how many
  // elements of its results differ from those of the same code in one thread; or why there is none.
  void add(Rows& rows) const;

 private:
  const Subject& subject_;
  std::unique_ptr<GeneratedEngine> engine_;
  std::string why_not_ = "it was not compiled";
};

}  // namespace dalembert::reporting
