// Which tasks a function's stages are divided into: as few as pay, each with what it is expected to take.
#pragma once

#include <string>
#include <vector>

#include "backend/emit.hpp"

namespace dalembert::backend {

struct Task {
  std::string name;                // of its first call's stage, and the first column where it has a part of them
  std::vector<std::string> calls;  // one after another
  bool reads_state = false;
  double nanoseconds = 0;  // on one thread
  double handed_on = 0;    // bytes that it writes where other tasks read them
  std::vector<int> after;  // the tasks it comes after, without what follows from others
};

// Tasks in an order that they can run in; what the longest way begins with comes first.
std::vector<Task> plan_tasks(const Folder& folder, const CodeInput& code);

// Where and when each task runs if all take what they are expected to.
struct Run {
  int thread = 0;
  double begin = 0, end = 0;  // ns
};
struct TaskSchedule {
  std::vector<Run> runs;  // by task
  double nanoseconds = 0;
};
TaskSchedule schedule_tasks(const std::vector<Task>& tasks, int threads);

// The most threads that are worth asking for; 1: tasks are better run one after another.
int useful_threads(const std::vector<Task>& tasks);

// Whether more threads than one are.
bool worth_a_graph(const std::vector<Task>& tasks);

double serial_time(const std::vector<Task>& tasks);
double critical_path(const std::vector<Task>& tasks);

}  // namespace dalembert::backend
