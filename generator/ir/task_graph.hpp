// Tasks that threads take from each other: what each is expected to take, which become one, where and when they run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ir/machine_costs.hpp"

namespace dalembert::ir {

// Smaller tasks than this, ns, are joined with others where that is not expected to make the whole slower.
inline constexpr double task_grain = 4000;
// For what choices of how many threads are weighed.
inline constexpr int usual_threads[] = {2, 4, 8};

struct Task {
  std::string name;                // of its first call's stage, and the first column where it has a part of them
  std::vector<std::string> calls;  // one after another
  bool reads_state = false;
  double nanoseconds = 0;  // on one thread
  double handed_on = 0;    // bytes that it writes where other tasks read them
  std::vector<int> after;  // the tasks it comes after, without what follows from others
  // Of a task that threads divide: its columns, which stand in the call as begin and end, and into multiples of what they can
  // be divided, 0: not at all. It comes after preparations instead of tasks.
  int columns = 1, step = 0;
};

struct TaskPlan {
  // In an order that they can run in; what the longest way begins with comes first.
  std::vector<Task> tasks;
  // Where threads sweep for themselves and divide the tasks: what each does before the first task that comes after it, and the
  // caller when all tasks are done. Nothing is handed on, and no task waits for another.
  std::vector<Task> preparations;
  std::optional<Task> end;
  ThreadCosts costs;

  bool divided() const { return end.has_value(); }
};

// In an order they can run in, longest way first; without edges that follow from others.
std::vector<Task> in_order(const std::vector<Task>& tasks);
// Small ones joined.
std::vector<Task> joined(const std::vector<Task>& tasks, const ThreadCosts& costs);

// Where and when each task runs if all take what they are expected to.
struct Run {
  int thread = 0;
  double begin = 0, end = 0;  // ns
};
struct TaskSchedule {
  std::vector<Run> runs;    // by task; of tasks that threads divide: by thread, of those that come to any
  std::vector<Run> begins;  // of these: what each thread prepares
  std::optional<Run> end;   // … and the caller behind
  double nanoseconds = 0;
};
TaskSchedule schedule_tasks(const TaskPlan& plan, int threads);

// The most threads that are worth asking for; 1: tasks are better run one after another.
int useful_threads(const TaskPlan& plan);

// Whether more threads than one are.
bool worth_a_graph(const TaskPlan& plan);

// Of tasks that threads divide, what they take in the measure of divided_work.hpp.
int units_of(double nanoseconds);

// ns of what is computed: altogether, and on the longest way through the tasks, which no number of threads is faster than.
double serial_time(const TaskPlan& plan);
double critical_path(const TaskPlan& plan);

}  // namespace dalembert::ir
