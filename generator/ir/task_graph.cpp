#include "ir/task_graph.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <set>

namespace dalembert::ir {
namespace {

// What tasks cost beside what they compute, ns: each task; what one leaves in another core's caches; and of a call, each thread
// that is asked for help, and how long it takes to come. Read off when tasks began and ended, of trees of 200 to 500 joints on
// two cores (AMD EPYC, Zen 4).
constexpr double task_cost = 60, hand_over = 250, ask_cost = 100;
// ns a byte: of what other threads have read since the last call, each line is taken back from their caches before it is
// written.
constexpr double taken_back = 4.0 / 64;
// Of what threads divide: a unit, ns, and how much more columns take in pieces, several cores writing.
constexpr double unit = 100, in_pieces = 1.08;
// More tasks are joined without weighing: what is weighed costs the square of their number, for every pair.
constexpr std::size_t most_tasks = 96;

struct Edges {
  std::vector<std::set<int>> after, before;  // of each task: those it comes after, those that come after it

  explicit Edges(const std::vector<Task>& tasks) : after(tasks.size()), before(tasks.size()) {
    for (std::size_t t = 0; t < tasks.size(); ++t)
      for (const int a : tasks[t].after) after[t].insert(a), before[static_cast<std::size_t>(a)].insert(static_cast<int>(t));
  }
};

// Of each task: ns from its beginning to the end of all, on the longest way, where each costs so much beside what it computes.
std::vector<double> ways(const std::vector<Task>& tasks, const Edges& edges, double cost) {
  std::vector<double> way(tasks.size(), -1);
  const auto of = [&](const auto& self, std::size_t t) -> double {
    if (way[t] >= 0) return way[t];
    double longest = 0;
    for (const int b : edges.before[t]) longest = std::max(longest, self(self, static_cast<std::size_t>(b)));
    return way[t] = longest + tasks[t].nanoseconds + cost;
  };
  for (std::size_t t = 0; t < tasks.size(); ++t) of(of, t);
  return way;
}

// Whether one can follow the other directly in one task: no third stands between them.
bool can_join(const Edges& edges, int a, int b) {
  const auto reaches = [&](int from, int to) {
    std::vector<int> todo(edges.before[static_cast<std::size_t>(from)].begin(),
                          edges.before[static_cast<std::size_t>(from)].end());
    std::set<int> seen(todo.begin(), todo.end());
    seen.erase(to), std::erase(todo, to);  // directly is no matter
    while (!todo.empty()) {
      const int t = todo.back();
      todo.pop_back();
      for (const int next : edges.before[static_cast<std::size_t>(t)]) {
        if (next == to) return true;
        if (seen.insert(next).second) todo.push_back(next);
      }
    }
    return false;
  };
  return !reaches(a, b) && !reaches(b, a);
}

// One task in place of two; their calls in the order of the graph.
std::vector<Task> made_one(const std::vector<Task>& tasks, int a, int b) {
  const int first = std::min(a, b), second = std::max(a, b);
  std::vector<Task> all = tasks;
  Task &into = all[static_cast<std::size_t>(first)], &from = all[static_cast<std::size_t>(second)];
  into.calls.insert(into.calls.end(), from.calls.begin(), from.calls.end());
  into.reads_state = into.reads_state || from.reads_state;
  into.nanoseconds += from.nanoseconds;
  into.handed_on += from.handed_on;
  into.after.insert(into.after.end(), from.after.begin(), from.after.end());
  all.erase(all.begin() + second);
  for (std::size_t t = 0; t < all.size(); ++t) {
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
  for (double most = task_grain; static_cast<std::size_t>(groups) > most_tasks; most *= 2) {
    groups = 0;
    double time = 0;
    for (std::size_t t = 0; t < tasks.size(); ++t) {
      if (t > 0 && time + tasks[t].nanoseconds > most) ++groups, time = 0;
      time += tasks[t].nanoseconds;
      group[t] = groups;
    }
    ++groups;
  }
  if (static_cast<std::size_t>(groups) == tasks.size()) return tasks;
  std::vector<Task> all(static_cast<std::size_t>(groups));
  std::vector<std::set<int>> after(all.size());
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    Task& into = all[static_cast<std::size_t>(group[t])];
    if (into.calls.empty()) into.name = tasks[t].name;
    into.calls.insert(into.calls.end(), tasks[t].calls.begin(), tasks[t].calls.end());
    into.reads_state = into.reads_state || tasks[t].reads_state;
    into.nanoseconds += tasks[t].nanoseconds;
    into.handed_on += tasks[t].handed_on;
    for (const int a : tasks[t].after)
      if (group[static_cast<std::size_t>(a)] != group[t])
        after[static_cast<std::size_t>(group[t])].insert(group[static_cast<std::size_t>(a)]);
  }
  for (std::size_t t = 0; t < all.size(); ++t) all[t].after.assign(after[t].begin(), after[t].end());
  return in_order(all);
}

TaskSchedule schedule_of(const std::vector<Task>& tasks, const ThreadCosts& costs, int threads) {
  const Edges edges(tasks);
  TaskSchedule schedule;
  schedule.runs.resize(tasks.size());
  std::vector<double> idle(static_cast<std::size_t>(std::max(threads, 1)));
  const double asked = tasks.size() > 1 ? ask_cost * (threads - 1) : 0;
  for (std::size_t t = 0; t < idle.size(); ++t) idle[t] = asked + (t > 0 ? costs.coming : 0);
  std::vector<bool> begun(tasks.size(), false);
  for (std::size_t count = 0; count < tasks.size(); ++count) {
    // Who can begin a task first takes the first of those that can run then.
    std::size_t thread = 0;
    int task = -1;
    double at = 0;
    for (std::size_t h = 0; h < idle.size(); ++h)
      for (std::size_t t = 0; t < tasks.size(); ++t) {
        if (begun[t]) continue;
        double ready = idle[h];
        bool can = true;
        for (const int a : tasks[t].after) {
          const Run& run = schedule.runs[static_cast<std::size_t>(a)];
          can = can && begun[static_cast<std::size_t>(a)];
          ready = std::max(ready, run.end + (run.thread == static_cast<int>(h) ? 0 : hand_over));
        }
        if (!can || (task >= 0 && ready >= at)) continue;
        thread = h, task = static_cast<int>(t), at = ready;
      }
    Run& run = schedule.runs[static_cast<std::size_t>(task)];
    const Task& begins = tasks[static_cast<std::size_t>(task)];
    run = {static_cast<int>(thread), at,
           at + task_cost + begins.nanoseconds + (threads > 1 ? taken_back * begins.handed_on : 0)};
    begun[static_cast<std::size_t>(task)] = true;
    idle[thread] = run.end;
    schedule.nanoseconds = std::max(schedule.nanoseconds, run.end);
  }
  return schedule;
}

double expected(const std::vector<Task>& tasks, const ThreadCosts& costs) {
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
  for (const int p : needs) sum += plan.preparations[static_cast<std::size_t>(p)].nanoseconds;
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

std::vector<Task> joined_where_small(std::vector<Task> tasks, const ThreadCosts& costs) {
  std::set<std::string> stay;  // small tasks that are better alone
  double now = expected(tasks, costs);
  while (tasks.size() > 1) {
    int smallest = -1;
    for (std::size_t t = 0; t < tasks.size(); ++t)
      if (tasks[t].nanoseconds < task_grain && !stay.contains(tasks[t].name) &&
          (smallest < 0 || tasks[t].nanoseconds < tasks[static_cast<std::size_t>(smallest)].nanoseconds))
        smallest = static_cast<int>(t);
    if (smallest < 0) break;
    const Edges edges(tasks);
    std::set<int> others = edges.after[static_cast<std::size_t>(smallest)];
    others.insert(edges.before[static_cast<std::size_t>(smallest)].begin(),
                  edges.before[static_cast<std::size_t>(smallest)].end());
    // Of those beside it, which come after the same or before it, the one that takes least.
    int beside = -1;
    for (std::size_t t = 0; t < tasks.size(); ++t)
      if (static_cast<int>(t) != smallest &&
          (edges.after[t] == edges.after[static_cast<std::size_t>(smallest)] ||
           edges.before[t] == edges.before[static_cast<std::size_t>(smallest)]) &&
          (beside < 0 || tasks[t].nanoseconds < tasks[static_cast<std::size_t>(beside)].nanoseconds))
        beside = static_cast<int>(t);
    if (beside >= 0) others.insert(beside);
    std::vector<Task> best;
    double least = now * (1 + 1e-9);
    for (const int other : others) {
      if (!can_join(edges, smallest, other)) continue;
      std::vector<Task> then = made_one(tasks, smallest, other);
      const double time = expected(then, costs);
      if (time > least) continue;
      least = time;
      best = std::move(then);
    }
    if (best.empty()) {
      stay.insert(tasks[static_cast<std::size_t>(smallest)].name);
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
    for (std::size_t t = 0; t < tasks.size() && !found; ++t) {
      if (tasks[t].after.size() != 1 || edges.before[static_cast<std::size_t>(tasks[t].after[0])].size() != 1) continue;
      tasks = made_one(tasks, tasks[t].after[0], static_cast<int>(t));
      found = true;
    }
  }
  return tasks;
}

}  // namespace

std::vector<Task> in_order(const std::vector<Task>& tasks) {
  const Edges edges(tasks);
  const std::vector<double> way = ways(tasks, edges, task_cost);
  std::vector<int> order(tasks.size()), number(tasks.size());
  std::iota(order.begin(), order.end(), 0);
  // A task's way is longer than that of any that comes after it.
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return way[static_cast<std::size_t>(a)] > way[static_cast<std::size_t>(b)]; });
  for (std::size_t i = 0; i < order.size(); ++i) number[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
  std::vector<Task> sorted;
  std::vector<std::set<int>> closure(tasks.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    Task task = tasks[static_cast<std::size_t>(order[i])];
    for (int& a : task.after) a = number[static_cast<std::size_t>(a)];
    std::sort(task.after.begin(), task.after.end());
    for (const int a : task.after) {
      const auto& further = closure[static_cast<std::size_t>(a)];
      closure[i].insert(further.begin(), further.end());
    }
    std::erase_if(task.after, [&](int a) { return closure[i].contains(a); });
    closure[i].insert(task.after.begin(), task.after.end());
    sorted.push_back(std::move(task));
  }
  return sorted;
}

std::vector<Task> joined(const std::vector<Task>& tasks, const ThreadCosts& costs) {
  return joined_where_small(chains_joined(neighbours_joined(tasks)), costs);
}

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

int units_of(double nanoseconds) { return std::max(1, static_cast<int>(std::lround(nanoseconds / unit))); }

double serial_time(const TaskPlan& plan) {
  return sum_of(plan.tasks) + sum_of(plan.preparations) + (plan.end ? plan.end->nanoseconds : 0);
}

double critical_path(const TaskPlan& plan) {
  if (plan.divided()) {
    double longest = 0;
    for (const Task& t : plan.tasks) {
      double sum = 0;
      for (const int p : t.after) sum += plan.preparations[static_cast<std::size_t>(p)].nanoseconds;
      longest = std::max(longest, sum);
    }
    return (plan.end->calls.empty() ? longest : sum_of(plan.preparations)) + plan.end->nanoseconds;
  }
  const std::vector<double> way = ways(plan.tasks, Edges(plan.tasks), 0);
  return way.empty() ? 0 : *std::max_element(way.begin(), way.end());
}

}  // namespace dalembert::ir
