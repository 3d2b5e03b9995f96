// Where the task graph pays: M and C of trees and chains on a fixed base, serial and as a oneTBB graph on all cores, by the
// clock on the wall (Google Benchmark's Time column). Both give the same bits, which is checked before anything is timed.
//
//     build/release/bin/benchmark_tasks --benchmark_enable_random_interleaving=true --benchmark_repetitions=9
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cstdlib>
#include <cstring>
#include <memory>
#include <random>

#include "tables/task_robots.hpp"

namespace {

// Robot: a struct with Workspace, TaskGraph, evaluate() and nq of one generated robot.
template <class Robot>
struct Fixture {
  typename Robot::Workspace serial, parallel;
  typename Robot::TaskGraph graph{parallel};
  double q[Robot::nq], v[Robot::nv];

  Fixture() {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> angle(-3, 3);
    for (double& x : q) x = angle(random);
    for (double& x : v) x = angle(random);
  }
  bool same_bits() {
    Robot::evaluate(q, v, serial);
    graph.evaluate(q, v);
    return std::memcmp(serial.mass_matrix, parallel.mass_matrix, sizeof serial.mass_matrix) == 0 &&
           std::memcmp(serial.coriolis_matrix, parallel.coriolis_matrix, sizeof serial.coriolis_matrix) == 0;
  }
};

template <class Robot>
void add(const char* name) {
  const auto fixture = std::make_shared<Fixture<Robot>>();
  if (!fixture->same_bits()) {
    fmt::print(stderr, "benchmark_tasks: error: {}: the task graph's results differ from the serial ones\n", name);
    std::exit(1);
  }
  benchmark::RegisterBenchmark(fmt::format("{}/serial", name).c_str(), [fixture](benchmark::State& state) {
    for (auto _ : state) Robot::evaluate(fixture->q, fixture->v, fixture->serial);
  })->UseRealTime();
  benchmark::RegisterBenchmark(fmt::format("{}/tasks", name).c_str(), [fixture](benchmark::State& state) {
    for (auto _ : state) fixture->graph.evaluate(fixture->q, fixture->v);
  })->UseRealTime();
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
#define DALEMBERT_TASK_ROBOT(name) add<name##_robot>(#name);
  DALEMBERT_TASK_ROBOTS
#undef DALEMBERT_TASK_ROBOT
  benchmark::RunSpecifiedBenchmarks();
}
