// What shape the emitted code takes: one straight line for the whole robot, or limbs side by side in lanes and rolled loops.
#pragma once

#include <string>
#include <vector>

#include "ir/compile_options.hpp"

namespace dalembert::ir {

// Limbs (runs of bodies without branches) that are computed side by side, one per lane, step by step from the root outwards.
// Short limbs are padded with steps that hold no body (-1). Slots of a segment are consecutive:
// slot = first_slot + step·width + lane.
struct Segment {
  std::string name;
  int width = 1;
  int steps = 0;
  int first_slot = 0;
  std::vector<std::vector<int>> bodies;  // [lane][step], -1 where padded
  std::vector<int> parents;              // per lane: the body the limb is attached to, -1: the base

  int slots() const { return steps * width; }
};

struct Plan {
  Form form = Form::straight;
  bool tasks = false;
  std::vector<Segment> segments;  // parents before children; empty for the straight form
  int slots = 0;                  // including padding between segments
  std::vector<int> slot_of;       // per body
};

}  // namespace dalembert::ir
