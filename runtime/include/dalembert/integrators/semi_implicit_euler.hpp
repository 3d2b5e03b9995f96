// Semi-implicit (symplectic) Euler: the new speeds move the positions.
#pragma once

#include <dalembert/integrators/motion.hpp>

namespace dalembert::integrators {

// One step of h seconds, of first order. `dynamics.acceleration(q, v)` is v̇, nv numbers; called once. Bounded while h times the
// fastest frequency stays below 2.
template <class Dynamics, class Q, class V>
void semi_implicit_euler(Dynamics& dynamics, typename Q::Scalar h, Q& q, V& v) {
  v += h * dynamics.acceleration(q, v);
  move(q, V(h * v), q, detail::quaternions_of(dynamics, 0));
}

}  // namespace dalembert::integrators
