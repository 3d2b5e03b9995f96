// Where the rolled form computes the elements of matrices of pairs: in blocks between a limb and itself, and between a limb and
// those above it (runtime/include/dalembert/blocks.hpp, runs.hpp, long_limbs.hpp).
#pragma once

#include <algorithm>
#include <vector>

#include "ir/kinematic_tree.hpp"
#include "ir/plan.hpp"

namespace dalembert::ir {

// The joints of a limb as blocks find them: matrices have rows of all of them. Empty: of none, or there is no limb.
struct LimbRows {
  std::vector<int> bodies;
  int slot = 0, stride = 0;  // where the first joint's numbers stand, and from joint to joint
  int row = 0;               // of the first joint; where joints follow others, as if each had a row of its own

  bool empty() const { return bodies.empty(); }
  int joints() const { return static_cast<int>(bodies.size()); }
};

// Between the limbs of a segment and those at one level above them, lane by lane. Levels count from the base: that is where
// most lanes have the same limb above them.
struct BlocksAbove {
  // How blocks find the joints above.
  enum class Where {
    slots,  // by a table
    one,    // one limb is above all lanes that have one
    lanes,  // they stand beside each other in one segment
  };
  std::vector<LimbRows> limbs;
  int steps = 0;  // of the longest; 0: there are none
  Where where = Where::slots;
  LimbRows one{};
  int segment = -1;             // of lanes
  std::vector<int> lanes{};     // … which of that segment's is above each lane
  std::vector<int> slots_of{};  // by a table: step by step, lane by lane
};

struct SegmentBlocks {
  std::vector<LimbRows> limbs;  // per lane
  std::vector<BlocksAbove> above;

  bool empty() const {
    return std::all_of(limbs.begin(), limbs.end(), [](const LimbRows& limb) { return limb.empty(); });
  }
};

// Three components of a role, as a factor of elements.
struct PairFactor {
  int role = 0, from = 0;
  bool operator==(const PairFactor&) const = default;
};
// A product of two of them, by their numbers.
struct FactorTerm {
  int lower = 0, upper = 0;
};
struct ElementSums {
  int pairs = 0;  // of the algorithm
  std::vector<FactorTerm> above, below;
  bool symmetric = false;
};

// Where joints follow others their rows and columns stand apart, and are added to those of whom they follow at the end.
struct FollowingRows {
  std::vector<int> row;       // per coordinate, as if each joint had one: of the matrix; −1, −2, … of those that follow
  std::vector<int> from, to;  // elements, as both stand in memory
  int set = 0;                // so many of them are the first to come where no other joints meet
};

// Matrices of pairs that have the same rows and columns of the robot, and are filled together.
struct PairBlocks {
  int array = 0;  // the first one's: what it says of rows holds for all
  std::vector<ElementSums> sums;
  std::vector<PairFactor> lower, upper;  // of all of them, each once
  std::vector<SegmentBlocks> segments;   // parallel to Plan::segments
  FollowingRows following;
};

// Elements of one matrix that are computed for a segment, with those that padding adds: above the diagonal with it, and below.
// Limbs alone run along rows, `lanes` at a time.
struct ElementCounts {
  long above = 0, below = 0;
  long added_to_zero = 0;  // of these: whose sum starts from zero instead of its first product
};
ElementCounts element_counts(const KinematicTree& tree, const Segment& segment, const PairBlocks& matrices,
                             const SegmentBlocks& blocks, bool symmetric, int lanes);

}  // namespace dalembert::ir
