#include "record.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace controller {
namespace {

Percentiles of(const std::vector<Tick>& ticks, std::int64_t Tick::*member) {
  std::vector<std::int64_t> values;
  values.reserve(ticks.size());
  for (const Tick& tick : ticks) values.push_back(tick.*member);
  return percentiles(std::move(values));
}

void track(const std::vector<Tick>& ticks, Summary& summary) {
  const std::size_t first = std::min(static_cast<std::size_t>(1 / period), ticks.size() - 1);
  double sum = 0;
  for (int i = 0; i < joints; ++i) {
    double sum_i = 0;
    for (std::size_t k = first; k < ticks.size(); ++k) {
      const double error = std::abs(ticks[k].q[i] - ticks[k].q_d[i]);
      sum_i += error * error;
      summary.peak[i] = std::max(summary.peak[i], error);
    }
    sum += sum_i;
    summary.rms[i] = std::sqrt(sum_i / (ticks.size() - first));
    if (summary.peak[i] > summary.peak[summary.worst_joint]) summary.worst_joint = i;
  }
  summary.rms_error = std::sqrt(sum / (joints * (ticks.size() - first)));
  summary.peak_error = summary.peak[summary.worst_joint];
}

void compare_momenta(const std::vector<Tick>& ticks, Summary& summary) {
  const Tick& start = ticks.front();
  for (const Tick& tick : ticks) {
    for (int who = 0; who < 2; ++who) {
      const auto keep = [](double& most, double value) { most = std::max(most, value); };
      keep(summary.drift[0][who], (tick.linear[who] - start.linear[who]).norm() / start.linear[who].norm());
      keep(summary.drift[1][who], (tick.angular[who] - start.angular[who]).norm() / start.angular[who].norm());
      keep(summary.disagreement[0], (tick.linear[0] - tick.linear[1]).norm() / start.linear[1].norm());
      keep(summary.disagreement[1], (tick.angular[0] - tick.angular[1]).norm() / start.angular[1].norm());
    }
  }
}

}  // namespace

Percentiles percentiles(std::vector<std::int64_t> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double p) {
    return 1e-3 * values[std::min(values.size() - 1, static_cast<std::size_t>(p * values.size()))];
  };
  return {at(0.5), at(0.99), at(0.999), at(0.9999), at(1)};
}

Summary summarise(const std::vector<Tick>& ticks, Base base) {
  Summary summary;
  summary.ticks = static_cast<int>(ticks.size());
  summary.woken = of(ticks, &Tick::woken);
  summary.rehearsal = of(ticks, &Tick::rehearsal);
  summary.begun = of(ticks, &Tick::begun);
  summary.dynamics = of(ticks, &Tick::dynamics);
  summary.law = of(ticks, &Tick::law);
  summary.plant = of(ticks, &Tick::plant);
  constexpr std::int64_t period_ns = static_cast<std::int64_t>(1e9 * period);
  for (const Tick& tick : ticks) {
    if (tick.computed > period_ns) ++summary.missed_by_computing;
    else if (tick.finished > period_ns) ++summary.missed_by_system;
    summary.mass_matrix_difference = std::max(summary.mass_matrix_difference, tick.mass_matrix_difference);
  }
  track(ticks, summary);
  if (base == Base::floating) compare_momenta(ticks, summary);
  return summary;
}

}  // namespace controller
