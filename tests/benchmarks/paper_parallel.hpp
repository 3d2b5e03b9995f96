// The paper's two ways to run its recursion on several cores (Shin, Park and Park 2016, section 5), on oneTBB, over the generic
// engine: the same arithmetic as generic::evaluate(), body by body and in the same order within a body, hence the same bits.
#pragma once

#include <dalembert/generic/dynamics.hpp>
#include <vector>

namespace dalembert::benchmarks {

struct Matrices {
  Eigen::MatrixXd M, C;  // empty when not asked for
};

class PaperParallel {
 public:
  // Keeps a reference to the model, whose joints must have coordinates of their own.
  PaperParallel(const generic::Model<double>& model, bool with_M, bool with_C);

  // Fig. 4: loop-level parallelism, the baseline. A parallel loop over the bodies of a level with a barrier behind every level
  // outwards (kinematics) and inwards (accumulation, where a parent's children are added one after another), then one parallel
  // loop over the bodies for the elements.
  Matrices loops(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const;

  // Algorithm 2: a task per body, which computes its kinematics, runs its children's tasks and waits for them, accumulates, and
  // spawns the tasks of its elements. Theirs are a task per element; here one per body with all of its ancestors, since an
  // element takes less time than a task does.
  Matrices tasks(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const;

  // In one thread.
  Matrices serial(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const;

 private:
  struct Evaluation;

  const generic::Model<double>& model_;
  bool with_M_, with_C_;
  std::vector<std::vector<int>> children_;  // of body k at k + 1, the base's first; last to first, as phase II adds them
  std::vector<std::vector<int>> levels_;    // bodies by their distance from the base
};

}  // namespace dalembert::benchmarks
