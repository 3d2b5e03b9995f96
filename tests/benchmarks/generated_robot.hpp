// The generated libraries of the benchmarks, by name, through their C API: they are compiled with -march=native and this
// program, which must link DART, is not, so that no Eigen object may pass between them.
#pragma once

#include "benchmark_robot.hpp"

namespace dalembert::benchmarks {

// One library: one robot, one choice of outputs. Function pointers take the library's own workspace.
struct GeneratedRobot {
  const char* robot;    // as in a benchmark's name
  const char* outputs;  // a label of Quantities, or "fixed" and "floating" for all outputs with that base
  const char* archive;  // path of the static library
  void* (*create)();
  void (*destroy)(void*);
  void (*evaluate)(const double* q, const double* v, void* workspace);
  const double* (*mass_matrix)(const void*);  // null when not among the outputs
  const double* (*coriolis_matrix)(const void*);
  const double* (*gravity)(const void*);
  const double* (*bias)(const void*);
};

// Null when there is none.
const GeneratedRobot* find_generated(const std::string& robot, const std::string& outputs);

// Owns a workspace.
class GeneratedEvaluation {
 public:
  explicit GeneratedEvaluation(const GeneratedRobot& robot) : robot_(robot), workspace_(robot.create(), robot.destroy) {}
  void run(const testing::State& state) { robot_.evaluate(state.q.data(), state.v.data(), workspace_.get()); }
  Results results(int nv) const;  // of the last run

 private:
  const GeneratedRobot& robot_;
  std::unique_ptr<void, void (*)(void*)> workspace_;
};

}  // namespace dalembert::benchmarks
