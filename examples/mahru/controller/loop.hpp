// The 1 kHz loop. Nothing in here allocates, locks or prints.
//
// Plant and controller share the thread and go in step: a tick is always 1 ms of simulated time, so lateness shows in the
// timing and never in the tracking. The plant's share of a tick is measured apart.
#pragma once

#include <cmath>

#include "law.hpp"
#include "plant.hpp"
#include "realtime.hpp"
#include "record.hpp"
#include "reference.hpp"

namespace controller {

// ns, how long before a tick the loop wakes: more than a wake-up is usually late.
inline constexpr std::int64_t rehearsal = 150'000;

template <class Law>
void run_loop(Law& law, Plant& plant, const Reference& reference, Plant::Account& account, std::vector<Tick>& ticks) noexcept {
  State state;
  plant.read(state);
  Target target;
  const std::int64_t period_ns = std::llround(1e9 * period);
  std::int64_t set = now() + 10 * period_ns;
  for (std::size_t k = 0; k < ticks.size(); ++k, set += period_ns) {
    Tick& tick = ticks[k];
    // Early, with the last tick's state: brings code and data into the caches that the sleep and the plant have emptied.
    sleep_until(set - rehearsal);
    const std::int64_t woken = now();
    law.evaluate(state);
    const std::int64_t rehearsed = now();
    while (now() < set) {
    }
    const std::int64_t begun = now();
    const std::int64_t computing = cpu_time();

    plant.read(state);
    reference.at(k * period, target);
    const std::int64_t before = now();
    law.evaluate(state);
    const std::int64_t after = now();
    law.torque(state, target, tick.torque);
    const std::int64_t commanded = now();

    plant.account(account);
    tick.mass_matrix_difference =
        (law.mass_matrix() - account.mass_matrix).cwiseAbs().maxCoeff() / account.mass_matrix.maxCoeff();
    if constexpr (Law::base == Base::floating) {
      const auto momentum = law.momentum(state);
      tick.linear[0] = momentum.linear, tick.linear[1] = account.linear_momentum;
      tick.angular[0] = momentum.angular, tick.angular[1] = account.angular_momentum;
    }
    tick.q = state.q;
    tick.q_d = target.q;
    plant.step(tick.torque);

    const std::int64_t done = now();
    tick.woken = woken - (set - rehearsal);
    tick.rehearsal = rehearsed - woken;
    tick.begun = begun - set;
    tick.dynamics = after - before;
    tick.law = commanded - begun;
    tick.plant = done - commanded;
    tick.finished = done - set;
    tick.computed = cpu_time() - computing;
  }
}

}  // namespace controller
