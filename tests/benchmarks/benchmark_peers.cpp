// Generated code against MuJoCo, DART, KDL, Pinocchio where it is found, and the generic engine: benchmarks
// ROBOT/QUANTITIES/WHO, all in one process.
//
//   benchmark_peers --benchmark_filter=MAHRU/                      one robot
//   benchmark_peers --benchmark_filter='MAHRU/.*/dalembert'        generated code only
//   benchmark_peers --benchmark_repetitions=11 --benchmark_enable_random_interleaving=true    to be quoted; see table.py
//
// Counters: relative_error (largest over 16 states, relative to the largest element, against 50 digits), text_bytes and
// table_bytes of generated code. A program whose results are wrong is not timed.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <map>
#include <memory>

#include "benchmark_robots.hpp"
#include "contestants.hpp"

namespace dalembert::benchmarks {
namespace {

constexpr double wrong = 1e-9;  // of the largest element: far beyond rounding

const BenchmarkRobot& robot_of(const RobotEntry& entry) {
  static std::map<std::string, std::unique_ptr<BenchmarkRobot>> robots;
  auto& robot = robots[entry.name];
  if (!robot) robot = std::make_unique<BenchmarkRobot>(entry.name, entry.urdf, entry.floating);
  return *robot;
}

struct Prepared {
  Contestant contestant;
  double relative_error = 0;
};

// Built, and checked, when first run: a filtered run starts at once, and repetitions share one.
Prepared prepare(const RobotEntry& entry, Quantities quantities, Make make) {
  const BenchmarkRobot& robot = robot_of(entry);
  Prepared prepared{make(robot, quantities), 0};
  for (int i = 0; i < BenchmarkRobot::checked_states; ++i) {
    prepared.relative_error = std::max(prepared.relative_error, relative_error(prepared.contestant.results(i), robot, i));
  }
  return prepared;
}

void time(benchmark::State& state, const std::string& name, const RobotEntry& entry, Quantities quantities, Make make) {
  static std::map<std::string, Prepared> all;
  auto found = all.find(name);
  if (found == all.end()) found = all.emplace(name, prepare(entry, quantities, make)).first;
  const Prepared& prepared = found->second;
  if (!(prepared.relative_error < wrong)) {
    state.SkipWithError(("wrong by " + std::to_string(prepared.relative_error) + " of the largest element").c_str());
    return;
  }
  const auto& run = prepared.contestant.run;
  int index = 0;
  for (auto _ : state) {
    run(index);
    benchmark::ClobberMemory();
    index = (index + 1) % BenchmarkRobot::state_count;
  }
  state.counters["relative_error"] = prepared.relative_error;
  if (prepared.contestant.text_bytes) {
    state.counters["text_bytes"] = static_cast<double>(prepared.contestant.text_bytes);
    state.counters["table_bytes"] = static_cast<double>(prepared.contestant.table_bytes);
  }
}

void register_one(const RobotEntry& entry, Quantities quantities, const char* who, Make make) {
  const std::string name = std::string(entry.name) + "/" + label(quantities) + "/" + who;
  benchmark::RegisterBenchmark(name.c_str(),
                               [=, &entry](benchmark::State& state) { time(state, name, entry, quantities, make); });
}

void register_all() {
  for (const RobotEntry& entry : benchmark_robots) {
    for (const QuantitiesRow& row : all_quantities) {
      const Quantities quantities = row.quantities;
      if (has_generated(entry.name, quantities)) register_one(entry, quantities, "dalembert", dalembert_contestant);
      register_one(entry, quantities, "generic", generic_contestant);
      if (mujoco_offers(quantities)) register_one(entry, quantities, "mujoco", mujoco_contestant);
      if (dart_offers(quantities)) register_one(entry, quantities, "dart", dart_contestant);
      if (pinocchio_offers(quantities)) register_one(entry, quantities, "pinocchio", pinocchio_contestant);
      if (entry.chain && kdl_offers(quantities)) register_one(entry, quantities, "kdl", kdl_contestant);
    }
  }
}

}  // namespace
}  // namespace dalembert::benchmarks

int main(int argc, char** argv) {
  dalembert::benchmarks::register_all();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  if (dalembert::benchmarks::pinocchio_offers(dalembert::benchmarks::Quantities::M))
    benchmark::AddCustomContext("pinocchio", dalembert::benchmarks::pinocchio_version());
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
