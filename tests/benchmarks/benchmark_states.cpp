// What it costs where M is nearly singular: forward_dynamics of a chain of 50 joints, each of whose states wants bounds of what
// rounding has left of M's pivots (dalembert/pivots.hpp), and of the same chain with armatures that leave nothing to doubt.
//
//     build/release/bin/benchmark_states --benchmark_enable_random_interleaving=true --benchmark_repetitions=9
#include <benchmark/benchmark.h>

#include <random>

#include "chain_with_armatures/dynamics.hpp"
#include "chain_with_bounds/dynamics.hpp"

namespace {

constexpr int states = 16;

template <class Workspace, class Call>
void time_states(benchmark::State& state, const Call& call) {
  static Workspace workspace;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(-1, 1);
  double q[states][50], v[50], tau[50];
  for (double(&one)[50] : q)
    for (double& x : one) x = 3 * number(random);
  for (int i = 0; i < 50; ++i) v[i] = number(random), tau[i] = number(random);
  int at = 0;
  for (auto _ : state) call(q[at++ % states], v, tau, workspace);
}

void with_bounds(benchmark::State& state) {
  time_states<chain_with_bounds::Workspace>(state,
                                            [](auto&... arguments) { chain_with_bounds::forward_dynamics(arguments...); });
}
BENCHMARK(with_bounds);

void with_armatures(benchmark::State& state) {
  time_states<chain_with_armatures::Workspace>(
      state, [](auto&... arguments) { chain_with_armatures::forward_dynamics(arguments...); });
}
BENCHMARK(with_armatures);

}  // namespace

BENCHMARK_MAIN();
