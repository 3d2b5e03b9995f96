// The paper's experiments (Shin, Park and Park 2016, section 6): M, C and both of serial chains of 10 to 500 joints, of trees
// of 2, 5 and 10 equal branches, and of MAHRU; benchmarks ROBOT/QUANTITIES/WHO by the clock on the wall. WHO:
//
//   generic          the paper's recursion in one thread
//   generic_loops    the same with the paper's loop-level parallelism, a barrier between phases
//   generic_tasks    the same with the paper's tasks
//   dalembert        generated code in one thread
//   dalembert_tasks  generated code as a static task graph
//
// Code is generated and compiled by the program itself, before anything is timed. Counter: relative_error at one state. All
// five must agree; generic's three ways to the bit, generated code's two as well. sweep.py draws what this says.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cstdio>
#include <map>
#include <regex>

#include "commands/parallel.hpp"
#include "sweep_robot.hpp"

namespace dalembert::benchmarks {
namespace {

constexpr double wrong = 1e-9;  // of the largest element: far beyond rounding
constexpr Sizes all_sizes[] = {{true, false, "M"}, {false, true, "C"}, {true, true, "M+C"}};

struct Way {
  const char* name;
  Matrices (*results)(SweepRobot&, const State&);
  void (*run)(SweepRobot&, const State&);
};
constexpr Way ways[] = {
    {"generic", [](SweepRobot& r, const State& s) { return r.paper().serial(s.q, s.v); },
     [](SweepRobot& r, const State& s) { benchmark::DoNotOptimize(r.paper().serial(s.q, s.v)); }},
    {"generic_loops", [](SweepRobot& r, const State& s) { return r.paper().loops(s.q, s.v); },
     [](SweepRobot& r, const State& s) { benchmark::DoNotOptimize(r.paper().loops(s.q, s.v)); }},
    {"generic_tasks", [](SweepRobot& r, const State& s) { return r.paper().tasks(s.q, s.v); },
     [](SweepRobot& r, const State& s) { benchmark::DoNotOptimize(r.paper().tasks(s.q, s.v)); }},
    {"dalembert", [](SweepRobot& r, const State& s) { return r.evaluate(s), r.generated(); },
     [](SweepRobot& r, const State& s) { r.evaluate(s); }},
    {"dalembert_tasks", [](SweepRobot& r, const State& s) { return r.evaluate_in_tasks(s), r.generated_in_tasks(); },
     [](SweepRobot& r, const State& s) { r.evaluate_in_tasks(s); }},
};

std::vector<Shape> all_shapes() {
  std::vector<Shape> shapes{{"MAHRU", 25, 0}};
  for (int branches : {1, 2, 5, 10})
    for (int joints : {10, 20, 50, 100, 200, 500})
      if (branches == 1) shapes.push_back({fmt::format("chain_{}", joints), joints, 1});
      else if (joints > branches) shapes.push_back({fmt::format("tree_{}_{}", joints, branches), joints, branches});
  return shapes;
}

// A robot and what of it is computed: the benchmarks of all ways share one.
struct Experiment {
  Shape shape;
  Sizes sizes;
  std::unique_ptr<SweepRobot> robot{};
  std::map<std::string, double> errors{};  // by way
  std::string name(const Way& way) const { return fmt::format("{}/{}/{}", shape.name, sizes.label, way.name); }

  void prepare() {
    if (robot) return;
    robot = std::make_unique<SweepRobot>(shape, sizes);
    for (const Way& way : ways) errors[way.name] = robot->error_of(way.results(*robot, robot->states()[0]));
    for (const State& state : robot->states()) {
      const auto same = [&](const Way& a, const Way& b) {
        const Matrices x = a.results(*robot, state), y = b.results(*robot, state);
        if (x.M != y.M || x.C != y.C) errors[b.name] = std::numeric_limits<double>::infinity();
      };
      same(ways[0], ways[1]), same(ways[0], ways[2]), same(ways[3], ways[4]);
    }
  }

  void time(benchmark::State& timing, const Way& way) {
    prepare();
    const double error = errors.at(way.name);
    if (!(error < wrong)) return timing.SkipWithError(fmt::format("wrong by {} of the largest element", error).c_str());
    int state = 0;
    for (auto _ : timing) {
      way.run(*robot, robot->states()[static_cast<size_t>(state)]);
      benchmark::ClobberMemory();
      state = (state + 1) % SweepRobot::state_count;
    }
    timing.counters["relative_error"] = error;
  }
};

// Compiles on all cores what the filter leaves: one after another, when first timed, it would take twice as long.
void prepare_those_wanted(std::vector<Experiment>& experiments) {
  std::string filter = benchmark::GetBenchmarkFilter();
  if (filter == "all") filter.clear();
  if (!filter.empty() && filter[0] == '-') return;
  const std::regex wanted(filter);
  std::vector<Experiment*> chosen;
  for (Experiment& e : experiments)
    if (std::any_of(std::begin(ways), std::end(ways), [&](const Way& w) { return std::regex_search(e.name(w), wanted); }))
      chosen.push_back(&e);
  std::atomic<size_t> done{0};
  each_in_parallel(chosen.size(), [&](size_t i) {
    chosen[chosen.size() - 1 - i]->prepare();  // the largest take longest
    std::fprintf(stderr, "\rcompiled %zu of %zu ", ++done, chosen.size());
  });
  std::fprintf(stderr, "\n");
}

int run(int argc, char** argv) {
  bool lists = false;
  for (int i = 1; i < argc; ++i) lists = lists || std::string(argv[i]).starts_with("--benchmark_list_tests");
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  std::vector<Experiment> experiments;
  for (const Shape& shape : all_shapes())
    for (const Sizes& sizes : all_sizes) experiments.push_back({shape, sizes});
  for (Experiment& e : experiments)
    for (const Way& way : ways)
      benchmark::RegisterBenchmark(e.name(way).c_str(), [&e, &way](benchmark::State& state) {
        e.time(state, way);
      })->UseRealTime();
  if (!lists) prepare_those_wanted(experiments);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}

}  // namespace
}  // namespace dalembert::benchmarks

int main(int argc, char** argv) {
  try {
    return dalembert::benchmarks::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "benchmark_sweep: %s\n", error.what());
    return 1;
  }
}
