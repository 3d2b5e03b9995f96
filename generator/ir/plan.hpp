// What shape the emitted code takes: one straight line for the whole robot, or limbs side by side in lanes and rolled loops.
#pragma once

#include <algorithm>
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
  // Whether the elements of matrices are computed limb after limb, lanes along a limb, and not limbs in lanes.
  bool limb_after_limb = false;

  int limbs() const {
    return static_cast<int>(std::count_if(bodies.begin(), bodies.end(), [](const auto& limb) { return limb.front() >= 0; }));
  }
  // Lanes that tiles compute of one step where registers hold `lanes`: whole registers of two at least.
  int computed_of_tiles(int lanes) const {
    const int some = std::max(2, std::min(width, lanes));
    return (limbs() + some - 1) / some * some;
  }
  int slots() const { return steps * width; }
  int joints() const {
    int all = 0;
    for (const auto& limb : bodies)
      all += static_cast<int>(std::count_if(limb.begin(), limb.end(), [](int b) { return b >= 0; }));
    return all;
  }
  // Whether elements can be computed a range of columns at a time: their blocks are loops. How many columns there are: limb
  // after limb those of all, else steps.
  bool splits_columns() const { return steps > 8 || limb_after_limb; }
  int columns() const { return limb_after_limb ? joints() : steps; }
  bool is_short() const { return slots() <= 4; }  // takes half of the eight slots to which segments are padded
};

struct Plan {
  Form form = Form::straight;
  Order order = Order::as_written;  // of the straight form
  bool tasks = false;
  bool write_limbs = true;  // whether short loops along limbs are written out
  bool join_tasks = true, weigh_tasks = true;
  std::shared_ptr<const MachineCosts> costs{};  // as of the compile options
  bool sweeps_apart = false;                    // of tasks: each thread sweeps for itself, and only elements are divided
  std::vector<Segment> segments;                // parents before children; empty for the straight form
  int slots = 0;                                // of bodies, including padding between segments
  int root_slot = 0;                            // beside a short segment, where there is one, else after the last
  std::vector<int> slot_of;                     // per body

  // The slot of a body, or of the base (−1).
  int slot(int body) const { return body < 0 ? root_slot : slot_of[static_cast<std::size_t>(body)]; }
  // The segment that holds a body; -1 for the base.
  int segment_of(int body) const {
    for (std::size_t s = 0; s < segments.size(); ++s)
      for (const auto& lane : segments[s].bodies)
        for (int b : lane)
          if (b == body && body >= 0) return static_cast<int>(s);
    return -1;
  }
};

}  // namespace dalembert::ir
