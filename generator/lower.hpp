// The middle of the compiler: each function of a Model becomes an algorithm, a scalar program, and a plan for its shape.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "backend/estimate.hpp"
#include "ir/algorithm.hpp"
#include "ir/normal_tree.hpp"
#include "ir/plan.hpp"
#include "ir/program.hpp"
#include "ir/rolled.hpp"
#include "pipeline.hpp"

namespace dalembert {

// A way to compute a function, and what a call is expected to take on registers of backend::register_widths.
struct Candidate {
  ir::Form form;
  ir::Solver solver;
  ir::Order order = ir::Order::as_written;  // of the straight form
  std::array<double, backend::register_widths.size()> nanoseconds{};
};

// The bodies that a function needs, where it gives parts of results alone (passes/part_of_tree.hpp).
struct PartOfRobot {
  ir::KinematicTree tree;
  ir::NormalTree normal;
};

// One function on its way to text.
struct LoweredFunction {
  std::shared_ptr<const PartOfRobot> part;  // null: it is of the whole robot
  ir::Algorithm algorithm;
  ir::Program program;  // unrolled
  ir::Plan plan;
  ir::RolledProgram rolled;           // empty for the straight form
  std::vector<Candidate> candidates;  // the one chosen first
  // The same function in the other form, where that is worth its text on registers of some widths; those widths.
  std::vector<LoweredFunction> elsewhere;
  std::vector<int> elsewhere_lanes;
  // Where the scene asks for batches: the whole function as a straight line. Empty: it is called state by state.
  std::vector<LoweredFunction> batch;
};
// A model on its way to text.
struct Lowered {
  // Where loops are embedded, what functions `of_opened` are computed on: the tree without them, and the scene. Else null.
  std::shared_ptr<const Model> opened;
  ir::NormalTree normal;                   // of that tree
  std::vector<LoweredFunction> functions;  // those the scene asks something of, each half of one by itself

  // What the function is computed on, `model` being what was lowered.
  const Model& model_of(const LoweredFunction& function, const Model& model) const {
    return function.algorithm.function.of_opened ? *opened : model;
  }
};
// Runs the passes, those that the model's options leave in.
Lowered lower(const Model& model);
// As far as the unrolled programs, which is all that counting needs, and without names in them.
Lowered lower_to_programs(const Model& model);

}  // namespace dalembert
