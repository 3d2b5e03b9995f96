// How the compiler is to go about it: never changes a result by more than rounding, only its cost.
#pragma once

#include <memory>

#include "ir/machine_costs.hpp"

namespace dalembert::ir {

// One straight line for the whole robot, or limbs side by side in lanes and rolled loops.
enum class Form { automatic, straight, rolled };

// In which order a straight line computes its values: as the equations are written, or what ends more live values than it
// begins first; among equals, what the longest way begins with, or what reads the newest value.
enum class Order { as_written, longest_first, newest_first };

// Each pass can be turned off, to see what it is worth.
struct CompileOptions {
  Form form = Form::automatic;
  bool fold = true;             // zeros, ones and constants disappear
  bool share = true;            // equal subexpressions are computed once
  bool move_parameters = true;  // inertial parameters move towards the base
  bool refer = true;            // straight lines choose the frame of reference of each branch of a fixed base
  bool pack = true;             // limbs stand side by side in lanes
  bool write_limbs = true;      // short loops along limbs are written out, with bodies' constants in place
  bool join = true;             // of a task graph, what is too little for a task is joined with another
  bool weigh = true;            // … and threads divide elements where, and come as many as, pays; not: wherever they can
  std::shared_ptr<const MachineCosts> costs{};  // what choices go by; null: the committed constants
};

}  // namespace dalembert::ir
