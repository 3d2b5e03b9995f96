// Times evaluate() of one generated robot: compiled once per variant by passes.sh, with ROBOT its namespace.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "dynamics.hpp"

namespace {

void evaluate(benchmark::State& state) {
  constexpr int states = 64;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<ROBOT::VectorQ> q(states);
  std::vector<ROBOT::VectorV> v(states);
  for (int i = 0; i < states; ++i) {
    for (auto& x : q[i]) x = uniform(random);
    for (auto& x : v[i]) x = uniform(random);
    if (ROBOT::nq != ROBOT::nv) q[i].template segment<4>(3).normalize();
  }
  const auto workspace = std::make_unique<ROBOT::Workspace>();
  int i = 0;
  for (auto _ : state) {
    ROBOT::evaluate(q[i], v[i], *workspace);
    benchmark::ClobberMemory();
    i = (i + 1) % states;
  }
}
BENCHMARK(evaluate);

}  // namespace

BENCHMARK_MAIN();
