// The middle of the compiler: each function of a Model becomes an algorithm, a scalar program, and a plan for its shape.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
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

// One section of a function on its way to text.
struct LoweredSection {
  ir::Algorithm algorithm;
  ir::Program program;  // unrolled
  ir::Plan plan;
  ir::RolledProgram rolled;  // empty for the straight form
};
// One function on its way to text.
struct LoweredFunction {
  std::shared_ptr<const PartOfRobot> part;  // null: it is of the whole robot
  std::vector<LoweredSection> sections;     // in order, of one form; at least one
  std::vector<Candidate> candidates;        // the one chosen first
  // Of a function of one section: the same in the other form, where that is worth its text on registers of some widths; those
  // widths.
  std::optional<LoweredSection> elsewhere;
  std::vector<int> elsewhere_lanes;
  // Where the scene asks for batches: the whole function as a straight line. None: it is called state by state.
  std::optional<LoweredSection> batch;
  // Where the scene asks for linearly implicit rollouts and the function tells v̇: that alone as a straight line for batches, of
  // dampers and springs as such a step has them. None: there is no such line.
  std::optional<LoweredSection> implicit;
  // Where loops are embedded: the function that its only section calls, on the tree without them. Else none.
  std::vector<LoweredFunction> opened;

  const LoweredSection& first() const { return sections.front(); }
  const std::string& name() const { return first().algorithm.function.name; }
  // All of it, what it calls behind it.
  std::vector<const LoweredSection*> all_sections() const;
};
// A model on its way to text.
struct Lowered {
  // Where loops are embedded, what LoweredFunction::opened is computed on: the tree without them, and the scene. Else null.
  std::shared_ptr<const Model> opened;
  ir::NormalTree normal;                   // of that tree
  std::vector<LoweredFunction> functions;  // those the scene asks something of

  std::vector<const LoweredSection*> all_sections() const;
};
// Runs the passes, those that the model's options leave in. `elements`: in programs that are not themselves the code.
Lowered lower(const Model& model, ir::Elements elements = ir::Elements::counted);
// As far as the unrolled programs, which is all that counting needs, and without names in them.
Lowered lower_to_programs(const Model& model, ir::Elements elements = ir::Elements::counted);

}  // namespace dalembert
