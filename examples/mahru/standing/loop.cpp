#include "loop.hpp"

#include <cmath>

#include "../controller/realtime.hpp"

namespace standing {
namespace {

using controller::cpu_time, controller::now, controller::sleep_until;

constexpr std::int64_t rehearsal = 200'000;  // ns, how long before a tick the loop wakes

bool lies(const State& state) {
  const double upright = (state.base_rotation * Vector3d::UnitZ()).z();
  return !(state.base_position.z() > 0.35 && upright > 0.7);
}

// Generated centre of mass and momentum against MuJoCo's, of the robot's size: 1 m, its weight at 1 m/s.
double disagreement(const Law& law, const Plant::Account& account) {
  const Vector6 h = law.momentum();
  const Vector3d about_origin = h.tail<3>() + law.center_of_mass().cross(h.head<3>());
  return std::fmax((h.head<3>() - account.linear_momentum).norm(), (about_origin - account.angular_momentum).norm()) /
         law.mass();
}

}  // namespace

std::size_t run_loop(Law& law, const VectorJ& limits, Plant& plant, const Plan& plan, Plant::Account& account,
                     std::vector<Tick>& ticks) noexcept {
  State state;
  plant.read(state);
  VectorJ torque;
  const std::int64_t period_ns = std::llround(1e9 * period);
  std::int64_t set = now() + 10 * period_ns;
  for (std::size_t k = 0; k < ticks.size(); ++k, set += period_ns) {
    Tick& tick = ticks[k];
    const Target& target = plan.targets[k];
    sleep_until(set - rehearsal);
    const std::int64_t woken = now();
    law.evaluate(state);
    law.torque(target, torque);
    while (now() < set) {
    }
    const std::int64_t begun = now();
    const std::int64_t computing = cpu_time();

    plant.read(state);
    const std::int64_t before = now();
    law.evaluate(state);
    const std::int64_t after = now();
    law.torque(target, torque);
    const std::int64_t commanded = now();

    plant.account(account);
    tick.com = law.center_of_mass();
    tick.commanded = law.forces();
    for (const Side side : sides) tick.sole[side] = law.sole_pose(side).col(3);
    tick.torque = torque.cwiseQuotient(limits).cwiseAbs().maxCoeff();
    tick.disagreement = disagreement(law, account);
    tick.steps = law.steps();
    tick.gave_way = law.gave_way();
    plant.push(target.push);
    plant.step(torque);
    plant.ground(tick.ground);

    const std::int64_t done = now();
    tick.woken = woken - (set - rehearsal);
    tick.begun = begun - set;
    tick.dynamics = after - before;
    tick.law = commanded - begun;
    tick.plant = done - commanded;
    tick.finished = done - set;
    tick.computed = cpu_time() - computing;
    if (lies(state)) return k + 1;
  }
  return ticks.size();
}

}  // namespace standing
