#include "commands/task_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "backend/output_files.hpp"
#include "commands/timing.hpp"

namespace dalembert {
namespace {

using ir::Task;

bool is_one(const FunctionTasks& f) { return f.plan.tasks.size() == 1 && !f.plan.divided(); }
std::string text_of_one(const FunctionTasks& f) {
  return fmt::format("{}: one task, {}; nothing to be gained by a second thread", f.function,
                     time_text(ir::serial_time(f.plan)));
}

// On so many threads, of which the code asks for some.
ir::TaskSchedule schedule_of(const FunctionTasks& f, int threads) {
  return ir::schedule_tasks(f.plan, std::min(threads, f.threads));
}

double time_on(const FunctionTasks& f, int threads) {
  return std::min(threads, f.threads) == 1 ? ir::serial_time(f.plan) : schedule_of(f, threads).nanoseconds;
}

std::string of_function(const FunctionTasks& f, int threads) {
  const std::vector<Task>& tasks = f.plan.tasks;
  const double serial = ir::serial_time(f.plan), longest = ir::critical_path(f.plan);
  if (is_one(f)) return "  " + text_of_one(f) + "\n";
  const double expected = time_on(f, threads);
  std::string text = fmt::format(
      "  {}: {}, {} one after another, {} along the longest way{}\n    on {} thread{}: {}, {:.2f} times as fast as serial "
      "code; "
      "more than {} are not made use of\n",
      f.function, f.plan.divided() ? "elements in stretches" : fmt::format("{} tasks", tasks.size()), time_text(serial),
      time_text(longest), f.emitted ? "" : "; nothing for several threads is generated (parallel: tasks would)", threads,
      threads == 1 ? "" : "s", time_text(expected), serial / expected, f.threads);
  std::string counts, ratios;
  for (int p = 1; p <= 64; p *= 2) {
    counts += fmt::format("{:>7}", p);
    ratios += fmt::format("{:>7.2f}", serial / time_on(f, p));
  }
  text += fmt::format("    threads  {}\n    speed-up {}\n", counts, ratios);
  if (f.plan.divided()) {
    double elements = 0;
    for (const Task& t : tasks) elements += t.nanoseconds;
    text += fmt::format("    each thread sweeps for itself, all sweeps {}; elements, {}, are divided",
                        time_text(serial - elements - f.plan.end->nanoseconds), time_text(elements));
    return text + (f.plan.end->nanoseconds > 0
                       ? fmt::format("; the caller has the results, {}\n", time_text(f.plan.end->nanoseconds))
                       : "\n");
  }
  text += "    on the longest way:";
  // From its end back: of what a task comes after, that which ends last in a world of enough threads.
  const ir::TaskSchedule enough = ir::schedule_tasks(f.plan, static_cast<int>(tasks.size()));
  std::vector<std::string> way;
  const auto add = [&](const Task& t) { way.push_back(fmt::format("{} ({})", t.name, time_text(t.nanoseconds))); };
  int task = 0;
  for (size_t t = 0; t < tasks.size(); ++t)
    if (enough.runs[t].end > enough.runs[static_cast<size_t>(task)].end) task = static_cast<int>(t);
  while (task >= 0) {
    const Task& t = tasks[static_cast<size_t>(task)];
    add(t);
    task = -1;
    for (const int a : t.after)
      if (task < 0 || enough.runs[static_cast<size_t>(a)].end > enough.runs[static_cast<size_t>(task)].end) task = a;
  }
  std::reverse(way.begin(), way.end());
  return text + fmt::format(" {}\n", fmt::join(way, ", "));
}

}  // namespace

std::string tasks_text(const std::vector<FunctionTasks>& functions, int threads) {
  std::string text =
      fmt::format("one call on several threads, as it is expected on registers of {} doubles:\n", functions.front().lanes);
  for (const FunctionTasks& f : functions) text += of_function(f, threads);
  return text;
}

std::string tasks_svg(const std::vector<FunctionTasks>& functions, int threads) {
  const FunctionTasks& f = *std::max_element(functions.begin(), functions.end(), [](const auto& a, const auto& b) {
    return a.plan.tasks.size() < b.plan.tasks.size();
  });
  const std::vector<Task>& tasks = f.plan.tasks;
  const ir::TaskSchedule schedule = schedule_of(f, threads);
  constexpr double left = 70, width = 1000, row = 44, box = 30, top = 40;
  const double height = top + row * threads + 30, scale = width / std::max(schedule.nanoseconds, 1.0);
  const std::string title = is_one(f)
                                ? text_of_one(f)
                                : fmt::format("{}: {} tasks on {} threads, {} expected, {:.2f} times as fast as serial code",
                                              f.function, tasks.size(), threads, time_text(schedule.nanoseconds),
                                              ir::serial_time(f.plan) / std::max(schedule.nanoseconds, 1.0));
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0f} {:.0f}\" font-family=\"sans-serif\" font-size=\"11\">\n"
      "<!-- {} -->\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n<text x=\"{}\" y=\"20\" "
      "font-size=\"14\">{}</text>\n",
      left + width + 20, height, backend::banner_mark, left, title);
  const auto y = [&](int thread) { return top + row * thread; };
  for (int t = 0; t < threads; ++t) svg += fmt::format("<text x=\"4\" y=\"{:.0f}\">thread {}</text>\n", y(t) + 19, t + 1);
  for (size_t t = 0; t < tasks.size(); ++t)
    for (const int a : tasks[t].after) {
      const ir::Run &from = schedule.runs[static_cast<size_t>(a)], &to = schedule.runs[t];
      if (from.thread == to.thread) continue;
      svg +=
          fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#999\" stroke-width=\"0.7\"/>\n",
                      left + scale * from.end, y(from.thread) + box / 2, left + scale * to.begin, y(to.thread) + box / 2);
    }
  const auto draw = [&](const Task& task, const ir::Run& run) {
    const double x = left + scale * run.begin, wide = std::max(scale * (run.end - run.begin) - 0.5, 0.5);
    svg += fmt::format(
        "<g><title>{0}: {1}</title><rect x=\"{2:.1f}\" y=\"{3:.0f}\" width=\"{4:.1f}\" height=\"{5:.0f}\" fill=\"{6}\" "
        "stroke=\"#345\" stroke-width=\"0.5\"/>",
        task.name, time_text(task.nanoseconds), x, y(run.thread), wide, box,
        task.name.rfind("elements", 0) == 0 ? "#bcd7f0" : "#f3d9a4");
    const size_t letters = static_cast<size_t>(wide / 6.2);
    if (letters >= 4)
      svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.0f}\">{}</text>", x + 2, y(run.thread) + 19, task.name.substr(0, letters));
    svg += "</g>\n";
  };
  for (const ir::Run& run : schedule.begins) draw({"sweeps", {}, false, run.end - run.begin, 0, {}}, run);
  if (f.plan.divided()) {
    for (const ir::Run& run : schedule.runs) draw({"elements", {}, false, run.end - run.begin, 0, {}}, run);
    if (f.plan.end->nanoseconds > 0) draw(*f.plan.end, *schedule.end);
  } else {
    for (size_t t = 0; t < tasks.size(); ++t) draw(tasks[t], schedule.runs[t]);
  }
  const double base = y(threads) + 4;
  svg += fmt::format("<text x=\"{}\" y=\"{:.0f}\">0</text><text x=\"{}\" y=\"{:.0f}\" text-anchor=\"end\">{}</text>\n", left,
                     base + 10, left + width, base + 10, time_text(schedule.nanoseconds));
  return svg + "</svg>\n";
}

}  // namespace dalembert
