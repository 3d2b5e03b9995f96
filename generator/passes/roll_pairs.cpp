#include <algorithm>
#include <set>
#include <utility>

#include "passes/roll_state.hpp"

namespace dalembert::passes {
namespace {

using ir::BlocksAbove;
using ir::LimbRows;

int number_of(std::vector<ir::PairFactor>& factors, const ir::PairFactor& factor) {
  const auto at = std::find(factors.begin(), factors.end(), factor);
  if (at != factors.end()) return static_cast<int>(at - factors.begin());
  factors.push_back(factor);
  return static_cast<int>(factors.size()) - 1;
}

std::vector<ir::FactorTerm> terms_of(const std::vector<ir::PairTerm>& terms, ir::PairBlocks& matrices) {
  std::vector<ir::FactorTerm> all;
  for (const ir::PairTerm& t : terms)
    all.push_back({number_of(matrices.lower, {t.lower, t.lower_from}), number_of(matrices.upper, {t.upper, t.upper_from})});
  return all;
}

// Matrices that are filled together, without their blocks.
std::vector<ir::PairBlocks> groups_of(const RollState& state) {
  std::vector<ir::PairBlocks> groups;
  for (std::size_t p = 0; p < state.algorithm.pairs.size(); ++p) {
    const ir::Pairs& pairs = state.algorithm.pairs[p];
    auto own = std::find_if(groups.begin(), groups.end(), [&](const ir::PairBlocks& group) {
      return state.array(group.array).row_map == state.array(pairs.array).row_map;
    });
    if (own == groups.end()) own = groups.insert(own, {pairs.array, {}, {}, {}, {}, {}});
    ir::ElementSums sums{static_cast<int>(p), {}, {}, pairs.symmetric};
    if (!pairs.symmetric) sums.below = terms_of(pairs.below, *own);
    sums.above = terms_of(pairs.above, *own);
    own->sums.push_back(std::move(sums));
  }
  return groups;
}

// What one group's blocks are made of.
class Blocks {
 public:
  Blocks(const RollState& state, const ir::PairBlocks& group) : state_(state), array_(group.array) {}

  ir::SegmentBlocks of(const ir::Segment& segment) const {
    ir::SegmentBlocks blocks;
    for (const std::vector<int>& bodies : segment.bodies) blocks.limbs.push_back(rows_of(bodies));
    for (std::size_t lane = 0; lane < segment.parents.size(); ++lane) {
      std::vector<LimbRows> limbs = limbs_above(segment.parents[lane]);
      if (blocks.limbs[lane].empty()) std::fill(limbs.begin(), limbs.end(), LimbRows());
      while (blocks.above.size() < limbs.size()) blocks.above.push_back({std::vector<LimbRows>(segment.parents.size()), 0});
      for (std::size_t level = 0; level < limbs.size(); ++level) {
        BlocksAbove& above = blocks.above[level];
        above.steps = std::max(above.steps, limbs[level].joints());
        above.limbs[lane] = std::move(limbs[level]);
      }
    }
    for (BlocksAbove& above : blocks.above) find_joints(above, segment.width == 1);
    return blocks;
  }

 private:
  // Matrices have rows of all of a limb's joints or of none (passes/plan.hpp).
  LimbRows rows_of(std::vector<int> bodies) const {
    std::erase(bodies, -1);
    if (bodies.empty() || !state_.asked(array_, true, bodies.front())) return {};
    const ir::KinematicTree& tree = state_.tree;
    const int base = tree.base_coordinates(), first = bodies.front(), slot = state_.plan.slot(first),
              stride = bodies.size() > 1 ? state_.plan.slot(bodies[1]) - slot : 0,
              row = follow(tree) ? base + first
                                 : state_.array(array_).row(base + state_.coordinates[static_cast<std::size_t>(first)]);
    return {std::move(bodies), slot, stride, row};
  }
  static bool follow(const ir::KinematicTree& tree) { return tree.independent_joints() < tree.joints(); }

  // The limbs above a limb that hangs on `parent`, the one nearest the base first.
  std::vector<LimbRows> limbs_above(int parent) const {
    std::vector<LimbRows> above;
    while (parent >= 0) {
      const ir::Segment& s = state_.plan.segments[static_cast<std::size_t>(state_.plan.segment_of(parent))];
      const auto limb = std::find_if(s.bodies.begin(), s.bodies.end(), [&](const std::vector<int>& bodies) {
        return std::find(bodies.begin(), bodies.end(), parent) != bodies.end();
      });
      above.insert(above.begin(), rows_of(*limb));
      parent = s.parents[static_cast<std::size_t>(limb - s.bodies.begin())];
    }
    return above;
  }

  // A limb that stands alone reads those above it by a table (runs.hpp).
  void find_joints(BlocksAbove& above, bool alone) const {
    if (!alone && (one_limb(above) || beside_each_other(above))) return;
    for (std::size_t step = 0; step < static_cast<std::size_t>(above.steps); ++step)
      for (const LimbRows& limb : above.limbs)
        above.slots_of.push_back(state_.plan.slot(step < limb.bodies.size() ? limb.bodies[step] : -1));
  }

  static bool one_limb(BlocksAbove& above) {
    for (const LimbRows& limb : above.limbs) {
      if (limb.empty()) continue;
      if (!above.one.empty() && limb.bodies != above.one.bodies) {
        above.one = {};
        return false;
      }
      above.one = limb;
    }
    if (!above.one.empty()) above.where = BlocksAbove::Where::one;
    return !above.one.empty();
  }

  bool beside_each_other(BlocksAbove& above) const {
    int segment = -1;
    std::vector<int> lanes;
    for (const LimbRows& limb : above.limbs) {
      lanes.push_back(0);
      if (limb.empty()) continue;
      const int its = state_.plan.segment_of(limb.bodies.front());
      const ir::Segment& s = state_.plan.segments[static_cast<std::size_t>(its)];
      if (s.width == 1 || (segment >= 0 && segment != its)) return false;
      segment = its;
      for (std::size_t lane = 0; lane < s.bodies.size(); ++lane)
        if (s.bodies[lane].front() == limb.bodies.front()) lanes.back() = static_cast<int>(lane);
    }
    if (segment < 0) return false;
    above.where = BlocksAbove::Where::lanes;
    above.segment = segment;
    above.lanes = std::move(lanes);
    return true;
  }

  const RollState& state_;
  int array_;
};

ir::FollowingRows following_rows(const RollState& state, const ir::OutputArray& matrix) {
  const ir::KinematicTree& tree = state.tree;
  const int following = tree.joints() - tree.independent_joints(), base = tree.base_coordinates();
  ir::FollowingRows rows;
  if (following == 0) return rows;
  const int all = base + tree.joints(), leading = matrix.rows;
  const auto row_of = [&](int i) {
    return matrix.row(i < base ? i : base + state.coordinates[static_cast<std::size_t>(i - base)]);
  };
  const auto asked = [&](int i) { return row_of(i) >= 0; };
  const auto follows = [&](int i) { return i >= base && tree.bodies[static_cast<std::size_t>(i - base)].driven(); };
  const auto meet = [&](int i, int k) {
    return i < base || k < base || tree.is_above(i - base, k - base) || tree.is_above(k - base, i - base);
  };
  int number = 0;
  for (int i = 0; i < all; ++i) rows.row.push_back(follows(i) ? -1 - number++ : row_of(i));

  std::set<int> written;
  for (int k = 0; k < all; ++k)
    for (int i = 0; i < all; ++i)
      if (!follows(i) && !follows(k) && asked(i) && asked(k) && meet(i, k)) written.insert(row_of(k) * leading + row_of(i));
  std::vector<std::pair<int, int>> first, more;  // from, to
  const auto add = [&](int at, int row, int column) {
    const int target = row_of(column) * leading + row_of(row);
    (written.insert(target).second ? first : more).emplace_back(at, target);
  };
  number = 0;
  for (int d = base; d < all; ++d) {
    if (!follows(d)) continue;
    for (int i = 0; i < all; ++i) {
      if (!meet(i, d) || !asked(i) || !asked(d)) continue;
      add(number * all + i, i, d);
      if (!follows(i)) add((following + number) * all + i, d, i);
    }
    ++number;
  }
  rows.set = static_cast<int>(first.size());
  first.insert(first.end(), more.begin(), more.end());
  for (const auto& [from, to] : first) rows.from.push_back(from), rows.to.push_back(to);
  return rows;
}

}  // namespace

void roll_pairs(RollState& state) {
  state.program.blocks = groups_of(state);
  for (ir::PairBlocks& group : state.program.blocks) {
    const Blocks blocks(state, group);
    for (const ir::Segment& segment : state.plan.segments) group.segments.push_back(blocks.of(segment));
    group.following = following_rows(state, state.array(group.array));
  }
}

}  // namespace dalembert::passes
