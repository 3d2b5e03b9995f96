// Many states in one call beside one call for each: time per state of batches of 4096, on one thread.
//
//     build/release/bin/benchmark_batch --benchmark_enable_random_interleaving=true --benchmark_repetitions=9
//
// batch_rows: states and results row by row, M and C packed; batch_lanes: the same in lanes; batch_blocks: results handed on
// block by block; single: a call per state, whose results stay in the workspace; batch_tasks: rows, on all threads of oneTBB,
// by the clock on the wall; rollout: motions of 20 steps of semi-implicit Euler from each state, time per step. Results are
// compared before anything is timed.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <random>
#include <vector>

#include "tables/batch_robots.hpp"

namespace {

constexpr std::size_t states = 4096;

// Robot: a struct of one generated robot with functions of batches and of a single state.
template <class Robot>
struct Fixture {
  std::vector<double> q, v, input, q_lanes, v_lanes, input_lanes;
  std::vector<std::vector<double>> results;
  typename Robot::Workspace workspace;
  typename Robot::Batch rows, lanes;

  Fixture() {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> number(-3, 3);
    const auto fill = [&](std::vector<double>& of, std::size_t count) {
      of.resize(states * count);
      for (double& x : of) x = number(random);
    };
    fill(q, Robot::nq);
    fill(v, Robot::nv);
    fill(input, Robot::nv);
    for (std::size_t s = 0; Robot::nq > Robot::nv && s < states; ++s) {
      double* const quaternion = q.data() + s * Robot::nq + 3;
      double square = 0;
      for (int i = 0; i < 4; ++i) square += quaternion[i] * quaternion[i];
      for (int i = 0; i < 4; ++i) quaternion[i] /= std::sqrt(square);
    }
    const auto in_lanes = [](const std::vector<double>& from, std::size_t count) {
      std::vector<double> to(from.size());
      for (std::size_t s = 0; s < states; ++s)
        for (std::size_t i = 0; i < count; ++i)
          to[dalembert::batch_index<double>(dalembert::BatchLayout::lanes, s, i, count)] = from[s * count + i];
      return to;
    };
    q_lanes = in_lanes(q, Robot::nq), v_lanes = in_lanes(v, Robot::nv), input_lanes = in_lanes(input, Robot::nv);
    for (const std::size_t size : Robot::sizes) results.emplace_back(states * size, 1.0);
    rows.count = lanes.count = states;
    rows.q = q.data(), rows.v = v.data(), rows.input = input.data();
    lanes.q = q_lanes.data(), lanes.v = v_lanes.data(), lanes.input = input_lanes.data();
    rows.matrices = lanes.matrices = dalembert::MatrixLayout::packed;
    lanes.states = lanes.results = dalembert::BatchLayout::lanes;
  }

  void single(std::size_t s) {
    Robot::single(q.data() + s * Robot::nq, v.data() + s * Robot::nv, input.data() + s * Robot::nv, workspace);
  }

  // The worst difference of the first result by rows and by single calls, relative to its largest element.
  double difference() {
    typename Robot::Batch whole = rows;
    whole.matrices = dalembert::MatrixLayout::by_columns;
    Robot::batch(whole, results);
    double worst = 0;
    for (std::size_t s = 0; s < states; s += 97) {
      single(s);
      const std::size_t size = Robot::sizes[0];
      const double* const expected = Robot::first_result(workspace);
      double largest = 0, error = 0;
      for (std::size_t i = 0; i < size; ++i) {
        largest = std::max(largest, std::abs(expected[i]));
        error = std::max(error, std::abs(results[0][s * size + i] - expected[i]));
      }
      if (!(error <= worst * largest)) worst = error / largest;
    }
    return worst;
  }
};

template <class Robot>
void add(const char* name) {
  const auto fixture = std::make_shared<Fixture<Robot>>();
  if (const double difference = fixture->difference(); !(difference < 1e-9)) {
    fmt::print(stderr, "benchmark_batch: error: {}: batches and single calls differ by {}\n", name, difference);
    std::exit(1);
  }
  const auto time = [&](const char* variant, const auto& all_states) {
    return benchmark::RegisterBenchmark(fmt::format("{}/{}", name, variant).c_str(), [=](benchmark::State& state) {
      while (state.KeepRunningBatch(states)) {
        all_states(*fixture);
        benchmark::ClobberMemory();
      }
      state.SetItemsProcessed(state.iterations());
    });
  };
  time("single", [](Fixture<Robot>& f) {
    for (std::size_t s = 0; s < states; ++s) f.single(s);
  });
  time("batch_rows", [](Fixture<Robot>& f) { Robot::batch(f.rows, f.results); });
  time("batch_lanes", [](Fixture<Robot>& f) { Robot::batch(f.lanes, f.results); });
  time("batch_blocks", [](Fixture<Robot>& f) { Robot::blocks(f.rows); });
  time("batch_tasks", [](Fixture<Robot>& f) { Robot::tasks(f.rows, f.results); })->UseRealTime();
  if constexpr (Robot::rolls_out) {
    constexpr std::size_t steps = 20;
    benchmark::RegisterBenchmark(fmt::format("{}/rollout", name).c_str(), [=](benchmark::State& state) {
      std::vector<double> last_q(states * Robot::nq), last_v(states * Robot::nv);
      dalembert::Rollout<double> motions;
      motions.steps = steps, motions.time_step = 1e-4, motions.last_q = last_q.data(), motions.last_v = last_v.data();
      typename Robot::Batch from = fixture->rows;
      from.input = nullptr;
      while (state.KeepRunningBatch(states * steps)) {
        Robot::rollout(from, motions);
        benchmark::ClobberMemory();
      }
      state.SetItemsProcessed(state.iterations());
    });
  }
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
#define DALEMBERT_BATCH_ROBOT(type, name) add<type>(name);
  DALEMBERT_BATCH_ROBOTS
#undef DALEMBERT_BATCH_ROBOT
  benchmark::RunSpecifiedBenchmarks();
}
