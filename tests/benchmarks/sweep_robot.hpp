// One robot of the sweep with its generated code for one choice of quantities, compiled when the program runs.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "commands/compiler.hpp"
#include "commands/output.hpp"
#include "commands/state_file.hpp"
#include "paper_parallel.hpp"
#include "pipeline.hpp"

namespace dalembert::benchmarks {

// A tree of equal branches on a fixed base; no branches: MAHRU, its base floating.
struct Shape {
  std::string name;
  int joints = 0, branches = 0;
};

struct Sizes {
  bool M = false, C = false;
  const char* label = "";  // as in a benchmark's name
};

class SweepRobot {
 public:
  static constexpr int state_count = 8;  // taken in turn

  // Generates and compiles: takes seconds. Throws InputError where that fails.
  SweepRobot(const Shape& shape, const Sizes& sizes);

  const std::vector<State>& states() const { return states_; }
  const PaperParallel& paper() const { return *paper_; }

  void evaluate(const State& state);           // generated, in one thread
  void evaluate_in_tasks(const State& state);  // generated, as a task graph

  // What the last call computed.
  Matrices generated() const;
  Matrices generated_in_tasks() const;

  // Largest difference from the exact matrices of state 0, over the larger one's largest element: in 50 digits up to 50 joints,
  // in long double beyond.
  double error_of(const Matrices& at_state_0) const;

 private:
  Matrices matrices(const double* M, const double* C) const;

  Model model_;
  std::unique_ptr<LoadedCode> code_;
  std::unique_ptr<generic::Model<double>> generic_;
  std::unique_ptr<PaperParallel> paper_;
  std::vector<State> states_;
  Matrices exact_;
  using Evaluate = void(const double*, const double*, void*);
  using Result = const double*(void*);
  struct Side {
    std::unique_ptr<void, void (*)(void*)> workspace{nullptr, nullptr};
    Evaluate* evaluate = nullptr;
    Result *M = nullptr, *C = nullptr;
  };
  Side side(const std::string& prefix) const;
  Side serial_, tasks_;
};

}  // namespace dalembert::benchmarks
