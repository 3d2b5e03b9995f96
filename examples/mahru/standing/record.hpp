// Everything the loop writes down, allocated and touched before it starts, and what is made of it.
#pragma once

#include <string>
#include <vector>

#include "../controller/record.hpp"
#include "plan.hpp"
#include "sole.hpp"

namespace standing {

using controller::Percentiles;

struct Tick {
  std::int64_t woken;            // ns from the time the sleep was to end to the time it did
  std::int64_t begun;            // ns from the time set for the tick to its begin
  std::int64_t dynamics;         // ns in the generated evaluate()
  std::int64_t law;              // ns from the begin to the torques: state, dynamics, tasks, quadratic program
  std::int64_t plant;            // ns in the simulation (not part of a controller on a real robot)
  std::int64_t finished;         // ns from the time set to the end of all work
  std::int64_t computed;         // ns of processor time spent between begin and end
  Vector3d com;                  // m, world
  Vector12 commanded, ground;    // forces at the soles: by the law, by MuJoCo
  std::array<Vector3d, 2> sole;  // m, world
  double torque;                 // largest |τ| / limit
  double disagreement;           // centre of mass and momentum, generated against MuJoCo's, relative
  int steps;                     // of the quadratic program
  bool gave_way;                 // it had no solution with the torques inside their limits
};

struct Figures {                          // of a part of the run, or of all of it
  double com_rms = 0, com_peak = 0;       // m, from the reference
  double slip = 0;                        // m, of a foot from where it has come to stand
  SoleUse commanded{0, 0}, ground{0, 0};  // largest of all ticks, of what the law believes in and of what is there
  double force_difference = 0;            // N: largest of the law's forces against the ground's
  double torque = 0;                      // largest |τ| / limit
  double disagreement = 0;
  int steps = 0, gave_way = 0;
};

struct Summary {
  Percentiles woken, begun, dynamics, law, plant;
  std::size_t ticks = 0;
  bool fell = false;
  double self_test = 0;         // µs
  long heap_allocations = 0;    // during the loop, plant included
  int missed_by_computing = 0;  // the tick's work took more processor time than a period has
  int missed_by_system = 0;     // late for any other reason
  Figures all;
  std::vector<Figures> parts;  // of the plan, as far as it came
};

// What the law believes in: friction and half sizes of the soles; what is there.
struct Limits {
  double friction, x, y;
};

Summary summarise(const std::vector<Tick>& ticks, const Plan& plan, const Limits& believed, const Limits& there);

}  // namespace standing
