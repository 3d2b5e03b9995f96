// The classical Runge-Kutta method of fourth order, on the base's group (Munthe-Kaas).
#pragma once

#include <dalembert/integrators/motion.hpp>

namespace dalembert::integrators {

// One step of h seconds, of fourth order. `dynamics.acceleration(q, v)` is v̇, nv numbers; called four times. Bounded while h
// times the fastest frequency stays below 2.8.
template <class Dynamics, class Q, class V>
void rk4(Dynamics& dynamics, typename Q::Scalar h, Q& q, V& v) {
  using Scalar = typename Q::Scalar;
  // Stage i at q · exp(step), v + change: its rates are those of step and of v.
  V step = V::Zero(v.size()), change = V::Zero(v.size()), steps = step, changes = change;
  Q at = q;
  const Scalar forward[] = {h / 2, h / 2, h, 0}, weight[] = {h / 6, h / 3, h / 3, h / 6};
  for (int i = 0; i < 4; ++i) {
    const V speed = v + change;
    const V rate = rate_of_step(q, step, speed, detail::quaternions_of(dynamics, 0)),
            acceleration = dynamics.acceleration(at, speed);
    steps += weight[i] * rate;
    changes += weight[i] * acceleration;
    if (i == 3) break;
    step = forward[i] * rate;
    change = forward[i] * acceleration;
    move(q, step, at, detail::quaternions_of(dynamics, 0));
  }
  move(q, steps, q, detail::quaternions_of(dynamics, 0));
  v += changes;
}

}  // namespace dalembert::integrators
