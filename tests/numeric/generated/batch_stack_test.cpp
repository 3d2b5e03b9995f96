// Batches and rollouts take no more of their thread's stack than the header says, by optimised code.
#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/mman.h>

#include <algorithm>
#include <new>
#include <vector>

#include "stack_arm/batch.hpp"

namespace {

// Bytes of a thread's stack that f() takes: those that are not as they were painted, less what a thread takes anyway.
template <class F>
std::size_t stack_of(F f) {
  constexpr std::size_t room = std::size_t{8} << 20;
  const auto touched = [&](void* (*run)(void*), void* what) {
    void* const memory = mmap(nullptr, room, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
    auto* const bytes = static_cast<unsigned char*>(memory);
    std::fill(bytes, bytes + room, static_cast<unsigned char>(0xA5));
    pthread_attr_t attributes;
    pthread_t thread;
    pthread_attr_init(&attributes);
    pthread_attr_setstack(&attributes, memory, room);
    if (pthread_create(&thread, &attributes, run, what) == 0) pthread_join(thread, nullptr);
    pthread_attr_destroy(&attributes);
    const auto first = std::find_if(bytes, bytes + room, [](unsigned char byte) { return byte != 0xA5; });
    const auto size = static_cast<std::size_t>(bytes + room - first);
    munmap(memory, room);
    return size;
  };
  const std::size_t anyway = touched([](void*) -> void* { return nullptr; }, nullptr);
  return touched([](void* what) -> void* { return (*static_cast<F*>(what))(), nullptr; }, &f) - anyway;
}

TEST(BatchStack, IsNoMoreThanTheHeaderSays) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers take a stack of their own";
#endif
  constexpr std::size_t n = 100;
  const std::vector<double> q(n * stack_arm::nq, 0.3), v(n * stack_arm::nv, -0.2), tau(n * stack_arm::nv, 0.1);
  std::vector<double> bias(n * stack_arm::nv), last_q(n * stack_arm::nq);
  stack_arm::Batch batch;
  batch.count = n, batch.q = q.data(), batch.v = v.data(), batch.input = tau.data();
  stack_arm::TogetherBatchResults results;
  results.together_bias = bias.data();
  const std::size_t by_batch =
      stack_of([&] { EXPECT_EQ(stack_arm::together_batch(batch, results), dalembert::BatchError::none); });
  EXPECT_LE(by_batch, stack_arm::batch_stack);
  EXPECT_GE(by_batch, stack_arm::batch_stack / 32) << "nobody is to keep that much for it";
  dalembert::Rollout<double> rollout;
  rollout.steps = 2, rollout.time_step = 1e-3, rollout.last_q = last_q.data();
  EXPECT_LE(stack_of([&] { EXPECT_EQ(stack_arm::together_rollout(batch, rollout), dalembert::BatchError::none); }),
            stack_arm::batch_stack);
}

}  // namespace
