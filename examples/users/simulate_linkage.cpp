// A leg whose knee is moved by a four-bar, simulated in two ways: embedded, where rod and knee follow the crank and dynamics
// are of hip and crank alone; and with the loop as rows, where all four joints move and a force in the pin keeps it closed.
// Both must move alike. A spring at the crank bears the shank: without motors energy is kept. At the end the crank is turned on
// until no position closes the linkage.
#include <cmath>
#include <dalembert/integrators/rk4.hpp>

#include "constrained_leg/dynamics.hpp"
#include "embedded_leg/dynamics.hpp"
#include "figures.hpp"

namespace {

using Two = embedded_leg::VectorV;           // hip, crank
using Four = embedded_leg::VectorQ;          // hip, crank, rod, knee
using Rates = constrained_leg::VectorV;      // of all four
constexpr double step = 5e-4, duration = 3;  // s

// Springs and dampers of the motors, towards a bent leg.
Two torques(bool motors, const Two& at, const Two& speed) {
  return motors ? Two(-60 * (at - Two(0.3, -0.4)) - 0.5 * speed) : Two(0, 0);
}

// The integrator moves hip and crank; rod and knee follow from where they were, at each of its stages.
struct Embedded {
  embedded_leg::Workspace leg;
  Four q;
  bool motors;

  void follow(const Two& at) {
    q.head<2>() = at;
    embedded_leg::close_loops(q);
  }
  Two acceleration(const Two& at, const Two& speed) {
    follow(at);
    embedded_leg::forward_dynamics(q, speed, torques(motors, at, speed), leg);
    return embedded_leg::forward_dynamics(leg);
  }
  double energy(const Two& at, const Two& speed) {
    follow(at);
    embedded_leg::evaluate(q, speed, leg);
    return embedded_leg::kinetic_energy(leg)(0) + embedded_leg::potential_energy(leg)(0);
  }
};

struct Constrained {
  constrained_leg::Workspace leg;
  bool motors;

  explicit Constrained(bool with_motors) : motors(with_motors) {
    leg.loop_pin.kp = 2500, leg.loop_pin.kd = 100;  // against the integrator's drift
  }
  Rates acceleration(const Four& at, const Rates& speed) {
    Rates tau = Rates::Zero();
    tau.head<2>() = torques(motors, at.head<2>(), speed.head<2>());
    constrained_leg::forward_dynamics(at, speed, tau, leg);
    return constrained_leg::constrained_forward_dynamics(leg);
  }
};

// At worst, during the motion: angles and rates that differ, how far rows let the pin go, and energy gained or lost, embedded.
struct Motion {
  double angle = 0, rate = 0, open = 0, energy = 0, moved = 0;
};
Motion move(const Four& start, bool motors) {
  Embedded embedded{{}, start, motors};
  Constrained constrained(motors);
  Two at = start.head<2>(), speed = Two::Zero();
  Four q = start;
  Rates v = Rates::Zero();
  const double energy = embedded.energy(at, speed);
  Motion worst;
  for (int i = 0; i < duration / step; ++i) {
    dalembert::integrators::rk4(embedded, step, at, speed);
    dalembert::integrators::rk4(constrained, step, q, v);
    const double change = embedded.energy(at, speed) - energy;
    if (!embedded.leg.linkage_status.ok() || !std::isfinite(change) || !q.allFinite())
      return {std::nan(""), std::nan(""), std::nan(""), std::nan(""), 0};
    Four closed = q;
    embedded_leg::close_loops(closed);
    worst.angle = std::fmax(worst.angle, (embedded.q - q).cwiseAbs().maxCoeff());
    worst.rate = std::fmax(worst.rate, (speed - v.head<2>()).cwiseAbs().maxCoeff());
    worst.open = std::fmax(worst.open, (closed - q).cwiseAbs().maxCoeff());
    worst.energy = std::fmax(worst.energy, std::abs(change));
    worst.moved = std::fmax(worst.moved, std::abs(q[3] - start[3]));
  }
  return worst;
}

}  // namespace

int main() {
  Figures figures;
  Four start(1.2, 0.5, -0.5, 0);
  figures.bounded("at the start the pin is open by", embedded_leg::close_loops(start).error, 1e-14, "m");
  const Motion swing = move(start, false), driven = move(start, true);
  figures.bounded("without motors energy changes by", swing.energy, 2e-8, "J");
  figures.bounded("both forms' joints differ by", swing.angle, 1e-8, "rad");
  figures.bounded("their rates by", swing.rate, 2e-7, "rad/s");
  figures.bounded("with motors joints differ by", driven.angle, 1e-8, "rad");
  figures.bounded("rates by", driven.rate, 2e-7, "rad/s");
  figures.bounded("rows let the pin open by an angle of", std::fmax(swing.open, driven.open), 1e-9, "rad");
  std::printf("%-58s %9.2f rad\n", "meanwhile the knee has moved by up to", std::fmax(swing.moved, driven.moved));

  // Where rod and lever are in line the crank cannot turn on: by the law of cosines of crank, thigh, and rod with lever.
  const double last = std::asin((0.06 * 0.06 + 0.3 * 0.3 - 0.35 * 0.35) / (2 * 0.06 * 0.3));
  Four q = start, closed = start;
  dalembert::LinkageStatus<double> status;
  for (; q[1] > -1.5; q[1] -= 1e-4) {
    status = embedded_leg::close_loops(q);
    if (!status.ok() || status.error > 1e-9) break;
    closed = q;
  }
  std::printf("At %.4f rad the crank is at a toggle point: past it the pin stays open by %.0e m, least pivot %.0e.\n",
              closed[1], status.error, status.least_pivot);
  figures.bounded("by the lengths of its links the toggle point is off by", std::abs(closed[1] - last), 2e-4, "rad");
  const double x = -0.06 * std::cos(last), z = 0.06 * std::sin(last) - 0.3;  // from the crank's end to the knee
  Embedded embedded{{}, start, true};
  embedded_leg::forward_dynamics(Four(0, last, std::atan2(-x, -z) - last, std::atan2(z, -x)), Two(0, 0), Two(0, 1),
                                 embedded.leg);
  const auto& there = embedded.leg.forward_dynamics_linkage_status;
  figures.bounded("there dynamics are refused, the least pivot being", there.ok() ? 1 : there.least_pivot, 1e-8, "");

  Constrained constrained(true);
  Rates a = Rates::Ones();
  figures.timed("forward dynamics, embedded", [&] {
    embedded_leg::forward_dynamics(start, Two(1, 1), Two(0, 0), embedded.leg);
    a.head<2>() = embedded_leg::forward_dynamics(embedded.leg);
  });
  figures.timed("closing the loop after a step", [&] {
    Four near = start;
    near[1] += 1e-3;
    embedded_leg::close_loops(near);
    a[2] = near[2];
  });
  figures.timed("forward dynamics with rows", [&] { a = constrained.acceleration(start, a); });
  return figures.exit_status();
}
