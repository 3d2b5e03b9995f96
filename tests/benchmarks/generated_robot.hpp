// The generated libraries of the benchmarks, by name, through their C API: they are compiled with -march=native and this
// program, which must link DART, is not, so that no Eigen object may pass between them.
#pragma once

#include <array>
#include <memory>

#include "benchmark_robot.hpp"

namespace dalembert::benchmarks {

// An output, and where it stands in the library's workspace.
struct GeneratedOutput {
  ir::Quantity quantity;
  const double* (*values)(const void* workspace);  // null: no output
};

// One library: one robot, one choice of outputs. Function pointers take the library's own workspace.
struct GeneratedRobot {
  const char* robot;    // as in a benchmark's name
  const char* outputs;  // a label of Quantities, or "fixed" and "floating" for all outputs with that base
  const char* archive;  // path of the static library
  void* (*create)();
  void (*destroy)(void*);
  // All functions that the outputs need; `more`: what the one beside evaluate() takes.
  void (*run)(const double* q, const double* v, const double* more, void* workspace);
  std::array<GeneratedOutput, 4> results;  // those there are first
};

// Null when there is none.
const GeneratedRobot* find_generated(const std::string& robot, const std::string& outputs);

// Owns a workspace.
class GeneratedEvaluation {
 public:
  explicit GeneratedEvaluation(const GeneratedRobot& robot) : robot_(robot), workspace_(robot.create(), robot.destroy) {}
  void run(const testing::State& state, const Eigen::VectorXd& more = {}) {
    robot_.run(state.q.data(), state.v.data(), more.data(), workspace_.get());
  }
  Results results(const ir::KinematicTree& tree) const;  // of the last run

 private:
  const GeneratedRobot& robot_;
  std::unique_ptr<void, void (*)(void*)> workspace_;
};

}  // namespace dalembert::benchmarks
