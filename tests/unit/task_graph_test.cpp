// What runs a call on several threads. The graph of tasks: each once, behind those it comes after, by however many threads
// come. Divided work: each column once, behind what its thread prepared for it. Pieces of a batch. Each may be called from the
// caller's own tasks.
#include <gtest/gtest.h>
#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <dalembert/divided_work.hpp>
#include <dalembert/pieces_on_threads.hpp>
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
  DividedWork work(2);
  work.run();
}

// A thread that is busy elsewhere, as one whose core is lent out: the caller does all of it and does not wait.
TEST(TaskGraph, DoesNotWaitForThreadsThatDoNotCome) {
  const tbb::global_control two(tbb::global_control::max_allowed_parallelism, 2);
  tbb::task_arena arena(2);
  static std::atomic<bool> busy{false}, released{false};  // static: a sanitizer does not see how oneTBB hands them over
  arena.execute([&] {
    tbb::task_group elsewhere;
    elsewhere.run([] {
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

// Work drawn at random, that writes down what was computed, and by whom.
struct Divided {
  struct Part {
    int columns, step;
    std::vector<int> needs, computed;  // not atomic: a column that two threads compute at once is a race
  };
  int threads;
  std::vector<Part> parts;
  std::vector<std::vector<int>> prepared;  // [place][preparation], how often
  int ended = 0;
  bool all_prepared = false;
  DividedWork work;

  Divided(int threads, int preparations, int count, unsigned seed, bool with_end)
      : threads(threads),
        prepared(static_cast<std::size_t>(threads), std::vector<int>(static_cast<std::size_t>(preparations))),
        work(threads) {
    std::mt19937 engine(seed);
    const auto draw = [&](int least, int most) { return std::uniform_int_distribution<int>(least, most)(engine); };
    for (int p = 0; p < preparations; ++p)
      EXPECT_EQ(work.prepare([this, p](int place) { ++prepared[at(place)][at(p)]; }, draw(0, 5)), p);
    for (int i = 0; i < count; ++i) {
      Part part{draw(1, 60), draw(0, 3) * 4, {}, {}};
      for (int p = 0; p < preparations; ++p)
        if (draw(0, 2) == 0) part.needs.push_back(p);
      part.computed.resize(at(part.columns));
      parts.push_back(part);
    }
    for (Part& part : parts)
      work.add(
          [this, &part](int place, int begin, int end) {
            ASSERT_LE(0, begin);
            ASSERT_LT(begin, end);
            ASSERT_LE(end, part.columns);
            if (part.step == 0) {
              ASSERT_EQ(end - begin, part.columns);
            } else {
              ASSERT_EQ(begin % part.step, 0);
            }
            for (const int p : part.needs) ASSERT_GE(prepared[at(place)][at(p)], 1);
            for (int c = begin; c < end; ++c) ++part.computed[at(c)];
          },
          part.columns, part.step, draw(0, 300), part.needs);
    if (!with_end) return;
    work.end_with([this](int place) {
      ASSERT_EQ(place, 0);
      ++ended;
      all_prepared = std::all_of(prepared[0].begin(), prepared[0].end(), [](int times) { return times == 1; });
      for (const Part& part : parts)
        for (const int times : part.computed) ASSERT_EQ(times, 1);
    });
  }
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  void run_and_expect(bool with_end) {
    for (auto& of_place : prepared) std::fill(of_place.begin(), of_place.end(), 0);
    for (Part& part : parts) std::fill(part.computed.begin(), part.computed.end(), 0);
    ended = 0;
    work.run();
    for (const Part& part : parts)
      for (const int times : part.computed) ASSERT_EQ(times, 1);
    for (const auto& of_place : prepared)
      for (const int times : of_place) ASSERT_LE(times, 1);
    ASSERT_EQ(ended, with_end ? 1 : 0);
    ASSERT_TRUE(all_prepared || !with_end);
  }
};

TEST(DividedWork, IsDoneOnceBehindWhatItNeeds) {
  for (const int threads : {1, 2, 4}) {
    tbb::task_arena arena(threads);
    const tbb::global_control as_many(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    for (unsigned seed = 0; seed < 30; ++seed)
      for (const bool with_end : {false, true}) {
        Divided divided(4, static_cast<int>(seed % 6), static_cast<int>(seed % 11), seed, with_end);
        for (int run = 0; run < 60; ++run) arena.execute([&] { divided.run_and_expect(with_end); });
      }
  }
}

// Stretches go on adding up when another number of threads comes.
TEST(DividedWork, IsDoneByAnyNumberOfThreadsInTurn) {
  Divided divided(4, 3, 12, 5, true);
  for (int run = 0; run < 200; ++run) {
    tbb::task_arena arena(1 + run % 4);
    const tbb::global_control as_many(tbb::global_control::max_allowed_parallelism, 4);
    arena.execute([&] { divided.run_and_expect(true); });
  }
}

TEST(DividedWork, DoesNotWaitForThreadsThatDoNotCome) {
  const tbb::global_control two(tbb::global_control::max_allowed_parallelism, 2);
  tbb::task_arena arena(2);
  static std::atomic<bool> busy{false}, released{false};  // static: a sanitizer does not see how oneTBB hands them over
  arena.execute([&] {
    tbb::task_group elsewhere;
    elsewhere.run([] {
      busy = true;
      while (!released) std::this_thread::yield();
    });
    while (!busy) std::this_thread::yield();
    Divided divided(2, 3, 10, 1, true);
    for (int run = 0; run < 50; ++run) divided.run_and_expect(true);
    EXPECT_FALSE(released);
    released = true;
    elsewhere.wait();
  });
}

// Calls from the caller's own parallel loop, with an object per thread, as each thread has a workspace of its own: while a call
// waits for others, its thread begins no other iteration, whose call would be with the same object. More threads than cores, so
// that some are late.
template <class Own>
void expect_no_call_within_another() {
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP()
      << "the loop is the test's, and what oneTBB hands over for it is not told to the sanitizer; it is no race either";
#endif
  constexpr int threads = 8;
  const tbb::global_control as_many(tbb::global_control::max_allowed_parallelism, threads);
  tbb::task_arena arena(threads);
  struct Caller {
    Own own;
    bool calls = false;
  };
  tbb::enumerable_thread_specific<std::unique_ptr<Caller>> callers([] { return std::make_unique<Caller>(); });
  std::atomic<int> within{0};
  for (int round = 0; round < 1000; ++round)  // short loops: threads take parts of calls once there is no iteration left
    arena.execute([&] {
      tbb::parallel_for(
          0, 20,
          [&](int) {
            Caller& caller = *callers.local();
            if (caller.calls) ++within;
            caller.calls = true;
            caller.own.run();
            caller.calls = false;
          },
          tbb::simple_partitioner{});
    });
  EXPECT_EQ(within, 0);
}
void take_a_while() {
  const auto end = std::chrono::steady_clock::now() + std::chrono::microseconds(5);
  while (std::chrono::steady_clock::now() < end) detail::pause();
}

struct OwnGraph : TaskGraph {
  OwnGraph() : TaskGraph(4) {
    for (int i = 0; i < 6; ++i) add(take_a_while);
  }
};
struct OwnWork : DividedWork {
  OwnWork() : DividedWork(4) {
    add([](int, int, int) { take_a_while(); }, 64, 4, 300, {});
  }
};
struct OwnPieces {
  void run() {
    pieces_on_threads(12, 1, [](std::size_t, std::size_t) { take_a_while(); });
  }
};

TEST(TaskGraph, RunsInTasksOfTheCallers) { expect_no_call_within_another<OwnGraph>(); }
TEST(DividedWork, IsDoneInTasksOfTheCallers) { expect_no_call_within_another<OwnWork>(); }
TEST(PiecesOnThreads, AreDoneInTasksOfTheCallers) { expect_no_call_within_another<OwnPieces>(); }

}  // namespace
}  // namespace dalembert
