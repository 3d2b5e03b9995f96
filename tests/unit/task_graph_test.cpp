// The graph that runs tasks: each once, behind those it comes after, by however many threads come.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <atomic>
#include <dalembert/task_graph.hpp>
#include <memory>
#include <random>
#include <thread>
#include <vector>

namespace dalembert {
namespace {

// A graph drawn at random, whose tasks write down when they ran.
struct Drawn {
  std::vector<std::vector<int>> after;
  std::vector<int> ran;     // how often; not atomic: a task that two threads run at once is a race
  std::vector<long> begun;  // by a clock that counts beginnings and ends
  std::vector<long> ended;
  std::atomic<long> clock{0};
  TaskGraph graph;

  Drawn(int tasks, double edges, unsigned seed, int threads)
      : after(static_cast<std::size_t>(tasks)), ran(after.size()), begun(after.size()), ended(after.size()), graph(threads) {
    std::mt19937 engine(seed);
    std::uniform_real_distribution<double> chance(0, 1);
    for (std::size_t t = 0; t < after.size(); ++t) {
      graph.add([this, t] {
        begun[t] = ++clock;
        ++ran[t];
        ended[t] = ++clock;
      });
      for (std::size_t before = 0; before < t; ++before)
        if (chance(engine) < edges) {
          after[t].push_back(static_cast<int>(before));
          graph.edge(static_cast<int>(before), static_cast<int>(t));
        }
    }
  }
  void expect_run(int times) {
    for (std::size_t t = 0; t < after.size(); ++t) {
      ASSERT_EQ(ran[t], times) << "task " << t;
      for (const int before : after[t]) ASSERT_LT(ended[static_cast<std::size_t>(before)], begun[t]) << "task " << t;
    }
  }
};

TEST(TaskGraph, RunsEachTaskOnceBehindThoseItComesAfter) {
  for (const int threads : {1, 2, 4}) {
    tbb::task_arena arena(threads);
    const tbb::global_control as_many(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    for (const int tasks : {1, 2, 3, 17, 64, 65, 200})
      for (const double edges : {0.0, 0.02, 0.3}) {
        Drawn drawn(tasks, edges, static_cast<unsigned>(tasks), 4);
        for (int run = 1; run <= 50; ++run) {
          arena.execute([&] { drawn.graph.run(); });
          drawn.expect_run(run);
        }
      }
  }
}

TEST(TaskGraph, OfNothingRuns) {
  TaskGraph graph;
  graph.run();
}

// A thread that is busy elsewhere, as one whose core is lent out: the caller does all of it and does not wait.
TEST(TaskGraph, DoesNotWaitForThreadsThatDoNotCome) {
  const tbb::global_control two(tbb::global_control::max_allowed_parallelism, 2);
  tbb::task_arena arena(2);
  std::atomic<bool> busy{false}, released{false};
  arena.execute([&] {
    tbb::task_group elsewhere;
    elsewhere.run([&] {
      busy = true;
      while (!released) std::this_thread::yield();
    });
    while (!busy) std::this_thread::yield();
    Drawn drawn(40, 0.1, 1, 2);
    for (int run = 1; run <= 20; ++run) {
      drawn.graph.run();
      drawn.expect_run(run);
    }
    EXPECT_FALSE(released);
    released = true;
    elsewhere.wait();
  });
}

}  // namespace
}  // namespace dalembert
