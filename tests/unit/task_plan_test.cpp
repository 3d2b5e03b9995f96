// Into which tasks a call is divided, when a graph of them is generated, and what is expected of it.
#include "backend/task_plan.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <vector>

#include "commands/task_report.hpp"
#include "compile.hpp"

namespace dalembert {
namespace {

using ir::Task;
using ir::TaskPlan;

// Branches of so many joints on a base that stands.
class TaskPlans : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo* const test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() / fmt::format("dalembert.{}.{}", test->name(), ::getpid());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // Body k hangs on body parents[k], −1: on the base, which stands.
  Model tree(const std::vector<int>& parents, const std::string& parallel, const std::string& outputs) {
    const std::string file = (folder_ / "tree.urdf").string();
    std::ofstream out(file);
    out << "<robot name='tree'><link name='base'/>\n";
    const char* const axes[] = {"0 0 1", "0 1 0", "1 0 0"};
    for (size_t k = 0; k < parents.size(); ++k)
      out << fmt::format(
          "<link name='l{0}'><inertial><origin xyz='0.1 0 0.02'/><mass value='2'/><inertia ixx='.01' iyy='.02' izz='.02' "
          "ixy='0.001' ixz='0' iyz='0'/></inertial></link>\n"
          "<joint name='j{0}' type='continuous'><parent link='{1}'/><child link='l{0}'/><origin xyz='.2 0 0'/><axis "
          "xyz='{2}'/></joint>\n",
          k, parents[k] < 0 ? "base" : fmt::format("l{}", parents[k]), axes[k % 3]);
    out << "</robot>\n";
    out.close();
    Request request;
    request.robot = file;
    request.settings = {{"base", "fixed"}, {"outputs", outputs}, {"parallel", parallel}};
    Diagnostics warnings;
    return read_model(request, warnings);
  }
  Model tree(int branches, int joints, const std::string& parallel,
             const std::string& outputs = "mass_matrix,coriolis_matrix") {
    std::vector<int> parents;
    for (int b = 0; b < branches; ++b)
      for (int k = 0; k < joints; ++k) parents.push_back(k == 0 ? -1 : b * joints + k - 1);
    return tree(parents, parallel, outputs);
  }

  std::filesystem::path folder_;
};

bool has_graph(const Model& model) {
  const std::vector<backend::OutputFile> files = compile_without_self_test(model);
  return std::any_of(files.begin(), files.end(), [](const auto& file) { return file.name == "tasks.cpp"; });
}

TaskPlan plan_of(const Model& model) { return tasks_of_functions(model, lower(model)).front().plan; }

TEST_F(TaskPlans, GraphsAreGeneratedWhereTwoThreadsAreExpectedToBeWorthThem) {
  EXPECT_FALSE(has_graph(tree(1, 30, "auto")));
  EXPECT_TRUE(has_graph(tree(1, 400, "auto")));
  EXPECT_FALSE(has_graph(tree(1, 400, "serial")));
  EXPECT_TRUE(has_graph(tree(1, 30, "tasks")));
}

TEST_F(TaskPlans, SmallRobotsAreOneTaskOrNoMoreThreadsThanOne) {
  const TaskPlan plan = plan_of(tree(3, 6, "tasks"));
  EXPECT_EQ(ir::useful_threads(plan), 1);
  EXPECT_FALSE(ir::worth_a_graph(plan));
}

// What a call computes, it computes once: the parts of a segment's columns follow one another from 0 to all of them.
TEST_F(TaskPlans, PartsOfColumnsAreAllOfThem) {
  for (const auto& [branches, joints] : {std::pair{1, 400}, {3, 130}, {5, 40}, {2, 25}})
    for (const bool derivatives : {false, true}) {
      SCOPED_TRACE(testing::Message() << branches << " branches of " << joints << " joints");
      const TaskPlan plan = plan_of(tree(branches, joints, "tasks", derivatives ? "inverse_dynamics_dq" : "mass_matrix,bias"));
      std::map<std::string, std::vector<std::pair<int, int>>> parts;
      for (const Task& task : plan.tasks)
        for (const std::string& call : task.calls) {
          std::smatch at;
          if (std::regex_search(call, at, std::regex("(elements_\\w+)\\(\\*w, (\\d+), (\\d+)\\)"))) {
            parts[at[1]].emplace_back(std::stoi(at[2]), std::stoi(at[3]));
          } else if (std::regex_search(call, at, std::regex("(elements_\\w+)\\(scratch, \\*w, (?:(\\d+) \\+ )?begin"))) {
            EXPECT_TRUE(plan.divided());
            const int from = at[2].matched ? std::stoi(at[2]) : 0;
            parts[at[1]].emplace_back(from, from + task.columns);
          }
        }
      for (auto& [stage, ranges] : parts) {
        std::sort(ranges.begin(), ranges.end());
        int end = 0;
        for (const auto& [from, to] : ranges) {
          EXPECT_EQ(from, end) << stage;
          EXPECT_LT(from, to);
          end = to;
        }
        EXPECT_TRUE(end == joints || end % joints == 0) << stage << " ends with " << end;
      }
      EXPECT_FALSE(parts.empty());
    }
}

// Where threads sweep for themselves, elements come after the sweeps of their own branch and of those that it hangs on, and of
// all branches that these carry: no others.
TEST_F(TaskPlans, ThreadsSweepWhatTheirElementsNeed) {
  const TaskPlan apart = plan_of(tree(5, 100, "tasks"));
  ASSERT_TRUE(apart.divided());
  std::set<std::string> of_first, of_last;
  for (const int p : apart.tasks.front().after) of_first.insert(apart.preparations[static_cast<size_t>(p)].name);
  for (const int p : apart.tasks.back().after) of_last.insert(apart.preparations[static_cast<size_t>(p)].name);
  EXPECT_EQ(of_first.size(), 3u);  // angles, outwards, inwards
  EXPECT_EQ(of_last.size(), 3u);
  EXPECT_NE(of_first, of_last);
  std::vector<int> parents;  // a stem of 60 that carries two branches of 60
  for (int k = 0; k < 180; ++k) parents.push_back(k == 120 ? 59 : k - 1);
  const TaskPlan forked = plan_of(tree(parents, "tasks", "mass_matrix,coriolis_matrix"));
  ASSERT_TRUE(forked.divided());
  for (const Task& task : forked.tasks) EXPECT_EQ(task.after.size(), forked.preparations.size()) << task.name;
}

// On no thread two tasks at a time, none before those it comes after; no faster than the longest way or all threads at work.
TEST_F(TaskPlans, SchedulesKeepTheEdges) {
  for (const std::string outputs : {"inverse_dynamics", "bias"}) {
    const TaskPlan plan = plan_of(tree(3, 60, "tasks", outputs));
    const std::vector<Task>& tasks = plan.tasks;
    ASSERT_FALSE(plan.divided()) << outputs;
    const double serial = ir::serial_time(plan), longest = ir::critical_path(plan);
    for (const int threads : {1, 2, 3, 8, 64}) {
      const ir::TaskSchedule schedule = ir::schedule_tasks(plan, threads);
      ASSERT_EQ(schedule.runs.size(), tasks.size());
      EXPECT_GE(schedule.nanoseconds, longest * (1 - 1e-12));
      EXPECT_GE(schedule.nanoseconds, serial / threads);
      for (size_t t = 0; t < tasks.size(); ++t) {
        EXPECT_LT(schedule.runs[t].thread, threads);
        EXPECT_GE(schedule.runs[t].end - schedule.runs[t].begin, tasks[t].nanoseconds);
        for (const int before : tasks[t].after) {
          EXPECT_LT(before, static_cast<int>(t));
          EXPECT_LE(schedule.runs[static_cast<size_t>(before)].end, schedule.runs[t].begin);
        }
        for (size_t u = 0; u < t; ++u) {
          const ir::Run &one = schedule.runs[u], &other = schedule.runs[t];
          EXPECT_TRUE(one.thread != other.thread || one.end <= other.begin || other.end <= one.begin);
        }
      }
    }
  }
}

// Of elements that threads divide: all are done at one time, none before its sweeps; and never sooner than the longest way.
TEST_F(TaskPlans, SchedulesDivideElements) {
  for (const std::string outputs : {"mass_matrix,coriolis_matrix", "mass_matrix,bias"}) {
    const TaskPlan plan = plan_of(tree(3, 130, "tasks", outputs));
    ASSERT_TRUE(plan.divided());
    for (const int threads : {1, 2, 3, 8, 64}) {
      const ir::TaskSchedule schedule = ir::schedule_tasks(plan, threads);
      ASSERT_LE(schedule.runs.size(), static_cast<size_t>(threads));
      ASSERT_EQ(schedule.runs.size(), schedule.begins.size());
      double elements = 0;
      for (size_t t = 0; t < schedule.runs.size(); ++t) {
        EXPECT_EQ(schedule.runs[t].begin, schedule.begins[t].end);
        EXPECT_GE(schedule.runs[t].end, schedule.runs[t].begin);
        EXPECT_LE(schedule.runs[t].end, schedule.end->begin);
        elements += schedule.runs[t].end - schedule.runs[t].begin;
      }
      double alone = 0;
      for (const Task& t : plan.tasks) alone += t.nanoseconds;
      EXPECT_GE(elements, alone * (1 - 1e-12));
      EXPECT_GE(schedule.nanoseconds, ir::critical_path(plan) * (1 - 1e-12));
      if (threads == 1) {
        EXPECT_NEAR(schedule.nanoseconds, ir::serial_time(plan), 1e-6);
      }
    }
  }
}

// Bushes have hundreds of stages, each too little for a task: they become few tasks, in little time, and each is called once.
TEST_F(TaskPlans, OfBushesIsFewTasks) {
  std::vector<int> binary, comb;
  for (int k = 0; k < 1023; ++k) binary.push_back(k == 0 ? -1 : (k - 1) / 2);
  for (int k = 0; k < 120; ++k) comb.insert(comb.end(), {k == 0 ? -1 : 3 * k - 3, 3 * k, 3 * k + 1});
  for (const std::vector<int>& parents : {binary, comb}) {
    for (const std::string outputs : {"mass_matrix,coriolis_matrix", "inverse_dynamics_dq"}) {
      const TaskPlan plan = plan_of(tree(parents, "auto", outputs));
      if (!plan.divided()) {
        EXPECT_LE(plan.tasks.size(), 96u);
      }
      std::map<std::string, int> calls;
      for (const std::vector<Task>& tasks : {plan.tasks, plan.preparations})
        for (const Task& task : tasks)
          for (const std::string& call : task.calls) EXPECT_EQ(++calls[call], 1) << call;
      EXPECT_GT(calls.size(), 96u);
    }
  }
}

TEST_F(TaskPlans, IsTold) {
  const Model model = tree(1, 400, "auto");
  const std::vector<FunctionTasks> functions = tasks_of_functions(model, lower(model));
  const std::string text = tasks_text(functions, 4), picture = tasks_svg(functions, 4);
  EXPECT_NE(text.find("evaluate: "), text.npos) << text;
  EXPECT_NE(text.find("on 4 threads"), text.npos) << text;
  EXPECT_NE(picture.find("thread 4"), picture.npos);
  EXPECT_NE(text.find("each thread sweeps for itself"), text.npos) << text;
  EXPECT_NE(picture.find("sweeps:"), picture.npos);
  EXPECT_NE(picture.find("elements:"), picture.npos);
  const Model other = tree(8, 200, "tasks", "bias");
  const std::vector<FunctionTasks> graphs = tasks_of_functions(other, lower(other));
  EXPECT_NE(tasks_text(graphs, 4).find("on the longest way: "), std::string::npos);
  const std::string drawn = tasks_svg(graphs, 4);
  for (const Task& task : graphs.front().plan.tasks) EXPECT_NE(drawn.find(task.name + ":"), drawn.npos) << task.name;
  const Model small = tree(1, 2, "auto");
  const std::vector<FunctionTasks> one = tasks_of_functions(small, lower(small));
  const char* const said = "nothing to be gained by a second thread";
  EXPECT_NE(tasks_text(one, 2).find(said), std::string::npos);
  EXPECT_NE(tasks_svg(one, 2).find(said), std::string::npos);
}

}  // namespace
}  // namespace dalembert
