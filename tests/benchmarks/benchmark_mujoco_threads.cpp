// What batches stand beside: MuJoCo's mj_forward at many states, a state and data of its own for each of oneTBB's threads,
// which is how it is used for sampling and learning. No contact and no other constraint; geometry is not collided.
//
//     build/release/bin/benchmark_mujoco_threads --benchmark_repetitions=5
//
// ROBOT/mj_forward: on one thread; ROBOT/mj_forward_tasks: on all, by the clock on the wall. Besides v' it fills M with its
// factors and all poses, Jacobians and velocities of bodies, which a batch of forward dynamics leaves out.
#include <benchmark/benchmark.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "benchmark_robots.hpp"
#include "mujoco_oracle.hpp"
#include "oracle_request.hpp"

namespace dalembert::benchmarks {
namespace {

constexpr size_t states = 4096;

struct DeleteData {
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using Data = std::unique_ptr<mjData, DeleteData>;

class Forward {
 public:
  explicit Forward(const RobotEntry& entry)
      : robot_(entry.name, entry.urdf, entry.floating), oracle_(request_for(robot_), oracle::Inertias::overwritten) {
    oracle_.overwrite_inertias(robot_.tree());
    oracle_.model()->opt.disableflags |= mjDSBL_CONSTRAINT;  // contacts, limits and their solver
    const size_t nq = static_cast<size_t>(oracle_.model()->nq), nv = static_cast<size_t>(oracle_.model()->nv);
    for (size_t s = 0; s < states; ++s) {
      const testing::State& state = robot_.states()[s % BenchmarkRobot::state_count];
      oracle_.set_state(state.q, state.v);
      qpos_.insert(qpos_.end(), oracle_.data()->qpos, oracle_.data()->qpos + nq);
      qvel_.insert(qvel_.end(), oracle_.data()->qvel, oracle_.data()->qvel + nv);
    }
    accelerations_.resize(states * nv);
  }

  Data data() const { return Data(mj_makeData(oracle_.model())); }

  void run(mjData& data, size_t first, size_t end) {
    const mjModel* const m = oracle_.model();
    const size_t nq = static_cast<size_t>(m->nq), nv = static_cast<size_t>(m->nv);
    for (size_t s = first; s < end; ++s) {
      std::copy_n(qpos_.data() + s * nq, nq, data.qpos);
      std::copy_n(qvel_.data() + s * nv, nv, data.qvel);
      mj_forward(m, &data);
      std::copy_n(data.qacc, nv, accelerations_.data() + s * nv);
    }
    benchmark::ClobberMemory();
  }

 private:
  BenchmarkRobot robot_;
  oracle::MujocoOracle oracle_;
  std::vector<double> qpos_, qvel_, accelerations_;
};

void add(const RobotEntry& entry) {
  const std::string name = entry.name;
  benchmark::RegisterBenchmark((name + "/mj_forward").c_str(), [&entry](benchmark::State& state) {
    Forward forward(entry);
    const Data data = forward.data();
    while (state.KeepRunningBatch(states)) forward.run(*data, 0, states);
    state.SetItemsProcessed(state.iterations());
  });
  benchmark::RegisterBenchmark((name + "/mj_forward_tasks").c_str(), [&entry](benchmark::State& state) {
    Forward forward(entry);
    tbb::enumerable_thread_specific<Data> data([&] { return forward.data(); });
    while (state.KeepRunningBatch(states))
      tbb::parallel_for(tbb::blocked_range<size_t>(0, states, 16),
                        [&](const tbb::blocked_range<size_t>& some) { forward.run(*data.local(), some.begin(), some.end()); });
    state.SetItemsProcessed(state.iterations());
  })->UseRealTime();
}

}  // namespace
}  // namespace dalembert::benchmarks

int main(int argc, char** argv) {
  for (const auto& entry : dalembert::benchmarks::benchmark_robots) dalembert::benchmarks::add(entry);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
}
