// The programs that are compared. Each computes the same quantities of the same fused robot from the same states: state in,
// finished dense results out, nothing kept from the call before.
//
// What is timed is one call of `run`. States are turned into a program's own coordinates beforehand. Every robot has its
// joints' coordinates in common; a floating base's own are each program's (MuJoCo's linear velocity is in world axes).
#pragma once

#include <functional>

#include "benchmark_robot.hpp"

namespace dalembert::benchmarks {

struct Contestant {
  std::function<void(int state)> run;         // absent: the program does not offer these quantities
  std::function<Results(int state)> results;  // in our coordinates, not timed
  long text_bytes = 0, table_bytes = 0;       // of emitted code; 0 elsewhere
};

using Make = Contestant (*)(const BenchmarkRobot&, Quantities);
Contestant dalembert_contestant(const BenchmarkRobot& robot, Quantities quantities);  // generated, -O3 -march=native
Contestant generic_contestant(const BenchmarkRobot& robot, Quantities quantities);    // the paper's recursion, allocates
Contestant mujoco_contestant(const BenchmarkRobot& robot, Quantities quantities);
Contestant dart_contestant(const BenchmarkRobot& robot, Quantities quantities);
Contestant kdl_contestant(const BenchmarkRobot& robot, Quantities quantities);  // of chains on a fixed base

Contestant pinocchio_contestant(const BenchmarkRobot& robot, Quantities quantities);  // where it is found

// Known without reading a robot, so that a filtered run starts at once.
bool has_generated(const std::string& robot, Quantities quantities);
bool mujoco_offers(Quantities quantities);
bool dart_offers(Quantities quantities);
bool kdl_offers(Quantities quantities);
bool pinocchio_offers(Quantities quantities);
std::string pinocchio_version();  // with the compiler and its flags; only where it offers something

}  // namespace dalembert::benchmarks
