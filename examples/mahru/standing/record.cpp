#include "record.hpp"

#include <algorithm>
#include <cmath>

namespace standing {
namespace {

void keep(double& most, double value) {
  if (!(value <= most)) most = value;  // what is not a number stays
}

void keep(SoleUse& most, const Eigen::Ref<const Vector12>& forces, Side side, const Limits& limits) {
  const SoleUse use = sole_use(forces.segment<6>(6 * side), limits.friction, limits.x, limits.y);
  keep(most.friction, use.friction);
  keep(most.pressure, use.pressure);
}

Percentiles of(const std::vector<Tick>& ticks, std::int64_t Tick::*member) {
  std::vector<std::int64_t> values;
  values.reserve(ticks.size());
  for (const Tick& tick : ticks) values.push_back(tick.*member);
  return controller::percentiles(std::move(values));
}

// slip: of each tick, m.
Figures figures(const std::vector<Tick>& ticks, const Plan& plan, const std::vector<double>& slip, std::size_t begin,
                std::size_t end, const Limits& believed, const Limits& there) {
  Figures f;
  double sum = 0;
  for (std::size_t k = begin; k < end; ++k) {
    const Tick& tick = ticks[k];
    const double error = (tick.com - plan.targets[k].com).norm();
    sum += error * error;
    keep(f.com_peak, error);
    keep(f.slip, slip[k]);
    for (const Side side : sides) {
      keep(f.commanded, tick.commanded, side, believed);
      keep(f.ground, tick.ground, side, there);
    }
    keep(f.force_difference, (tick.commanded - tick.ground).cwiseAbs().maxCoeff());
    keep(f.torque, tick.torque);
    keep(f.disagreement, tick.disagreement);
    f.steps = std::max(f.steps, tick.steps);
    f.gave_way += tick.gave_way;
  }
  f.com_rms = std::sqrt(sum / (end - begin));
  return f;
}

std::vector<double> slip_of(const std::vector<Tick>& ticks, const Plan& plan) {
  std::vector<double> slip(ticks.size(), 0);
  for (const Side side : sides) {
    Vector3d place = ticks.front().sole[side];
    for (std::size_t k = 1; k < ticks.size(); ++k) {
      const bool stands = plan.targets[k].foot[side].load > 0, stood = plan.targets[k - 1].foot[side].load > 0;
      if (stands && !stood) place = ticks[k].sole[side];
      if (stands) keep(slip[k], (ticks[k].sole[side] - place).head<2>().norm());
    }
  }
  return slip;
}

}  // namespace

Summary summarise(const std::vector<Tick>& ticks, const Plan& plan, const Limits& believed, const Limits& there) {
  Summary summary;
  summary.ticks = ticks.size();
  summary.woken = of(ticks, &Tick::woken);
  summary.begun = of(ticks, &Tick::begun);
  summary.dynamics = of(ticks, &Tick::dynamics);
  summary.law = of(ticks, &Tick::law);
  summary.plant = of(ticks, &Tick::plant);
  constexpr std::int64_t period_ns = static_cast<std::int64_t>(1e9 * period);
  for (const Tick& tick : ticks) {
    if (tick.computed > period_ns) ++summary.missed_by_computing;
    else if (tick.finished > period_ns) ++summary.missed_by_system;
  }
  const std::vector<double> slip = slip_of(ticks, plan);
  summary.all = figures(ticks, plan, slip, 0, ticks.size(), believed, there);
  for (std::size_t i = 0; i < plan.parts.size(); ++i) {
    const std::size_t begin = plan.parts[i].begin;
    const std::size_t end = std::min(ticks.size(), i + 1 < plan.parts.size() ? plan.parts[i + 1].begin : ticks.size());
    if (begin < end) summary.parts.push_back(figures(ticks, plan, slip, begin, end, believed, there));
  }
  return summary;
}

}  // namespace standing
