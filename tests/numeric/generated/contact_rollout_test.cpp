// Rollouts whose contacts come on and go: step by step what single calls of impact and constrained forward dynamics give.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <dalembert/batch.hpp>
#include <dalembert/integrators/rk4.hpp>
#include <dalembert/integrators/semi_implicit_euler.hpp>
#include <dalembert/rollout.hpp>
#include <limits>
#include <random>
#include <vector>

#include "stepping_biped/batch_tasks.hpp"
#include "stepping_biped/c_api.h"
#include "stepping_biped/dynamics.hpp"

namespace {

using dalembert::BatchError;
using dalembert::BatchLayout;
using dalembert::RolloutMethod;
using stepping_biped::nq;
using stepping_biped::nv;
using Q = Eigen::Matrix<double, nq, 1>;
using V = Eigen::Matrix<double, nv, 1>;

constexpr std::size_t n = 11, steps = 9, contacts = 2;
constexpr double h = 1e-3;

struct Motions {
  std::vector<double> q = std::vector<double>(n * steps * nq), v = std::vector<double>(n * steps * nv);
  std::vector<int> stopped = std::vector<int>(n, 77);
  bool operator==(const Motions&) const = default;
};

struct ContactRollouts : testing::Test {
  std::vector<double> q = std::vector<double>(n * nq), v = std::vector<double>(n * nv),
                      tau = std::vector<double>(n * steps * nv), active = std::vector<double>(n * steps * contacts);
  stepping_biped::Workspace workspace;

  ContactRollouts() {
    std::mt19937 random(8);
    std::uniform_real_distribution<double> number(-1, 1);
    for (std::vector<double>* of : {&q, &v, &tau})
      for (double& x : *of) x = number(random);
    for (double& x : active) x = number(random) > 0 ? 1 : 0;
    for (std::size_t s = 0; s < n; ++s) Eigen::Map<Eigen::Vector4d>(q.data() + s * nq + 3).normalize();
    workspace.contact_left.restitution = 0.5;
    workspace.contact_left.active = false;
    workspace.contact_right.kd = 3;
    workspace.gravity_vector[0] = 2;
  }

  template <class Change>
  Motions run(RolloutMethod method, const Change& change) {
    Motions m;
    stepping_biped::Batch batch;
    batch.count = n, batch.q = q.data(), batch.v = v.data(), batch.input = tau.data(), batch.workspace = &workspace;
    dalembert::Rollout<double> rollout;
    rollout.steps = steps, rollout.time_step = h, rollout.method = method, rollout.active = active.data();
    rollout.path_q = m.q.data(), rollout.path_v = m.v.data(), rollout.stopped = m.stopped.data();
    change(batch, rollout);
    EXPECT_EQ(stepping_biped::forward_dynamics_rollout(batch, rollout), BatchError::none);
    return m;
  }
  Motions run(RolloutMethod method) {
    return run(method, [](auto&, auto&) {});
  }
};

// By single calls.
struct Single {
  stepping_biped::Workspace workspace;
  const double* tau = nullptr;
  int impacts = 0;

  V acceleration(const Q& q, const V& v) {
    stepping_biped::forward_dynamics(q.data(), v.data(), tau, workspace);
    return Eigen::Map<const V>(workspace.constrained_forward_dynamics);
  }
  void set_contacts(const double* active, const Q& q, V& v) {
    const bool left = active[0] > 0, right = active[1] > 0;
    const bool strikes = (left && !workspace.contact_left.active) || (right && !workspace.contact_right.active);
    workspace.contact_left.active = left, workspace.contact_right.active = right;
    if (!strikes) return;
    stepping_biped::evaluate(q.data(), v.data(), workspace);
    v = Eigen::Map<const V>(workspace.impact);
    ++impacts;
  }
};

TEST_F(ContactRollouts, AreSingleCallsStepByStep) {
  for (const RolloutMethod method : {RolloutMethod::semi_implicit_euler, RolloutMethod::rk4}) {
    const Motions motions = run(method);
    int impacts = 0, first = 0;
    for (std::size_t s = 0; s < n; ++s) {
      EXPECT_EQ(motions.stopped[s], -1);
      Single single{workspace};
      Q at_q = Eigen::Map<const Q>(q.data() + s * nq);
      V at_v = Eigen::Map<const V>(v.data() + s * nv);
      for (std::size_t step = 0; step < steps; ++step) {
        const std::size_t at = s * steps + step;
        single.tau = tau.data() + at * nv;
        single.set_contacts(active.data() + at * contacts, at_q, at_v);
        first += step == 0 ? single.impacts : 0;
        if (method == RolloutMethod::rk4) dalembert::integrators::rk4(single, h, at_q, at_v);
        else dalembert::integrators::semi_implicit_euler(single, h, at_q, at_v);
        // Those of single calls: what differs is how integrators round.
        const double tolerance = 1e-11 * (1 + at_v.lpNorm<Eigen::Infinity>());
        EXPECT_LT((Eigen::Map<const Q>(motions.q.data() + at * nq) - at_q).lpNorm<Eigen::Infinity>(), tolerance);
        EXPECT_LT((Eigen::Map<const V>(motions.v.data() + at * nv) - at_v).lpNorm<Eigen::Infinity>(), tolerance);
        at_q = Eigen::Map<const Q>(motions.q.data() + at * nq), at_v = Eigen::Map<const V>(motions.v.data() + at * nv);
      }
      impacts += single.impacts;
    }
    EXPECT_GT(impacts, static_cast<int>(2 * n));
    EXPECT_GT(first, 0) << "those of the first step, of what does not act in the workspace";
  }
}

TEST_F(ContactRollouts, AreTheSameBitsByAFunctionInLanesAndOnThreads) {
  const auto method = RolloutMethod::semi_implicit_euler;
  const Motions all = run(method);
  EXPECT_TRUE(all == run(method, [&](auto& batch, auto& rollout) {
                batch.input = nullptr, rollout.active = nullptr;
                rollout.user = this;
                rollout.control = [](const dalembert::RolloutStep<double>& step, void* user) {
                  const auto& from = *static_cast<const ContactRollouts*>(user);
                  for (int k = 0; k < step.count; ++k) {
                    const std::size_t at = (step.first + static_cast<std::size_t>(k)) * steps + step.step;
                    for (int i = 0; i < nv; ++i)
                      step.input[i * step.stride + k] = from.tau[at * nv + static_cast<std::size_t>(i)];
                    for (std::size_t c = 0; c < contacts; ++c)
                      step.active[static_cast<int>(c) * step.stride + k] = from.active[at * contacts + c];
                  }
                };
              }));
  Motions on_threads;
  run(method, [&](const auto& batch, auto rollout) {
    rollout.path_q = on_threads.q.data(), rollout.path_v = on_threads.v.data(), rollout.stopped = on_threads.stopped.data();
    EXPECT_EQ(stepping_biped::forward_dynamics_rollout_tasks(batch, rollout), BatchError::none);
  });
  EXPECT_TRUE(all == on_threads);
  // States, forces and contacts in lanes.
  const auto in_lanes = [](const std::vector<double>& rows, std::size_t k) {
    std::vector<double> lanes((n + 7) / 8 * 8 * k, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t s = 0; s < n; ++s)
      for (std::size_t i = 0; i < k; ++i) lanes[dalembert::batch_index<double>(BatchLayout::lanes, s, i, k)] = rows[s * k + i];
    return lanes;
  };
  const auto q_lanes = in_lanes(q, nq), v_lanes = in_lanes(v, nv), tau_lanes = in_lanes(tau, steps * nv),
             active_lanes = in_lanes(active, steps * contacts);
  EXPECT_TRUE(all == run(method, [&](auto& batch, auto& rollout) {
                batch.states = BatchLayout::lanes;
                batch.q = q_lanes.data(), batch.v = v_lanes.data(), batch.input = tau_lanes.data(),
                rollout.active = active_lanes.data();
              }));
}

TEST_F(ContactRollouts, FollowTheWorkspaceWhereNobodySays) {
  const Motions as_set = run(RolloutMethod::rk4, [](auto&, auto& rollout) { rollout.active = nullptr; });
  for (std::size_t i = 0; i < active.size(); ++i) active[i] = i % contacts == 0 ? 0 : 1;
  EXPECT_TRUE(as_set == run(RolloutMethod::rk4)) << "nothing comes on";
}

// A step that cannot be made leaves v as it was before its impact.
TEST_F(ContactRollouts, StopBeforeAnImpact) {
  const Motions all = run(RolloutMethod::semi_implicit_euler);
  constexpr std::size_t bad = 6, at = 4;
  for (std::size_t c = 0; c < contacts; ++c)
    for (const std::size_t step : {at - 1, at}) active[(bad * steps + step) * contacts + c] = step == at ? 1 : 0;
  tau[(bad * steps + at) * nv + 2] = std::numeric_limits<double>::quiet_NaN();
  const Motions some = run(RolloutMethod::semi_implicit_euler);
  for (std::size_t s = 0; s < n; ++s) EXPECT_EQ(some.stopped[s], s == bad ? static_cast<int>(at) : -1);
  for (std::size_t step = at; step < steps; ++step)
    for (std::size_t i = 0; i < nv; ++i)
      EXPECT_EQ(some.v[(bad * steps + step) * nv + i], some.v[(bad * steps + at - 1) * nv + i]);
  EXPECT_TRUE(std::equal(all.v.begin(), all.v.begin() + static_cast<std::ptrdiff_t>(bad * steps * nv), some.v.begin()));
}

// Something that comes on in the first step, with an impact that cannot be solved for in one motion.
struct ImpactOfOneFails {
  using Block = dalembert::BatchBlock<double, 1, 1, 1, 1, 0, 0, 1>;
  [[maybe_unused]] static constexpr int strip = 1, constraints = 1, first_active = 0;
  static void with_given(Block& block, std::size_t, int) noexcept { block.given[0] = Block::V{}; }
  static void run(Block* blocks, int count) noexcept {
    for (int b = 0; b < count; ++b) blocks[b].values[0] = Block::V{};
  }
  static int strike(Block& block, int state) noexcept {
    double v = 0;
    dalembert::take_state<double>(block.v, 1, state, &v);
    const double still = 0;
    dalembert::put_state<double>(&still, 1, state, block.v);
    return v == 3 ? 0 : -1;
  }
};

TEST(ContactRollout, StopsWhereAnImpactIsNotSolved) {
  constexpr std::size_t count = 4;
  const double q[count] = {}, v[count] = {1, 2, 3, 4}, on[2 * count] = {1, 1, 1, 1, 1, 1, 1, 1};
  for (const RolloutMethod method : {RolloutMethod::semi_implicit_euler, RolloutMethod::rk4}) {
    double last_v[count];
    int stopped[count];
    dalembert::Rollout<double> rollout;
    rollout.steps = 2, rollout.time_step = h, rollout.method = method, rollout.active = on;
    rollout.last_v = last_v, rollout.stopped = stopped;
    dalembert::roll_out<1, 1, double>(ImpactOfOneFails{}, rollout, q, v, nullptr, BatchLayout::rows, BatchLayout::rows, 0,
                                      count, 0, [](ImpactOfOneFails::Block&) {});
    for (std::size_t s = 0; s < count; ++s) {
      EXPECT_EQ(stopped[s], s == 2 ? 0 : -1);
      EXPECT_EQ(last_v[s], s == 2 ? 3 : 0);
    }
  }
}

TEST_F(ContactRollouts, FromC) {
  const Motions all = run(RolloutMethod::rk4, [](auto& batch, auto&) { batch.workspace = nullptr; });
  Motions of_c;
  stepping_biped_batch_options options = {};
  options.active = active.data();
  EXPECT_EQ(stepping_biped_rollout_forward_dynamics(q.data(), v.data(), tau.data(), n, steps, h, 1, nullptr, nullptr,
                                                    of_c.q.data(), of_c.v.data(), of_c.stopped.data(), &options),
            0);
  EXPECT_TRUE(all == of_c);
  // What no contact holds has none that come on.
  EXPECT_EQ(
      static_cast<BatchError>(stepping_biped_rollout_free(q.data(), v.data(), tau.data(), n, steps, h, 1, nullptr, nullptr,
                                                          of_c.q.data(), of_c.v.data(), of_c.stopped.data(), &options)),
      BatchError::active);
  EXPECT_TRUE(all == of_c);
}

TEST_F(ContactRollouts, NameWhatIsWrong) {
  stepping_biped::Batch batch;
  dalembert::Rollout<double> rollout;
  rollout.active = active.data();
  rollout.control = [](const dalembert::RolloutStep<double>&, void*) {};
  EXPECT_EQ(stepping_biped::forward_dynamics_rollout(batch, rollout), BatchError::control);
  rollout.control = nullptr, rollout.method = RolloutMethod::linearly_implicit;
  EXPECT_EQ(stepping_biped::forward_dynamics_rollout(batch, rollout), BatchError::left_out);
}

}  // namespace
