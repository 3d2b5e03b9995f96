// Everything the loop writes down, allocated and touched before it starts.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "types.hpp"

namespace controller {

struct Tick {
  std::int64_t woken;             // ns from the time the sleep was to end to the time it did
  std::int64_t rehearsal;         // ns in the generated evaluate() right after the sleep, caches cold; its results are not used
  std::int64_t begun;             // ns from the time set for the tick to its begin
  std::int64_t dynamics;          // ns in the generated evaluate() that counts
  std::int64_t law;               // ns from the begin to the torques: state, reference, dynamics, law
  std::int64_t plant;             // ns in the simulation (not part of a controller on a real robot)
  std::int64_t finished;          // ns from the time set to the end of all work
  std::int64_t computed;          // ns of processor time spent between begin and end, without what the hypervisor says it took
  VectorJ q, q_d;                 // rad
  VectorJ torque;                 // N m
  double mass_matrix_difference;  // largest element of |M − M of the plant| / largest of |M|
  Eigen::Vector3d linear[2], angular[2];  // momentum, world axes: by the generated M, by the plant
};

struct Percentiles {
  double p50, p99, p999, p9999, max;  // µs
};

Percentiles percentiles(std::vector<std::int64_t> values);  // of ns

struct Summary {
  Percentiles woken, rehearsal, begun, dynamics, law, plant;
  int ticks = 0;
  double self_test = 0;         // µs, before the loop
  long heap_allocations = 0;    // during the loop, plant included
  int missed_by_computing = 0;  // the tick's work took more processor time than a period has
  int missed_by_system = 0;     // late for any other reason: begun late, or other programs or the hypervisor had the processor
  double rms_error = 0, peak_error = 0;      // rad, all joints, after the first second
  int worst_joint = 0;                       // the one with the peak
  std::array<double, joints> rms{}, peak{};  // rad, each joint, after the first second
  double mass_matrix_difference = 0;
  double drift[2][2] = {};      // of linear, angular momentum × generated, plant: largest change / size at the start
  double disagreement[2] = {};  // of linear, angular momentum: largest difference generated − plant / size at the start
};

Summary summarise(const std::vector<Tick>& ticks, Base base);

}  // namespace controller
