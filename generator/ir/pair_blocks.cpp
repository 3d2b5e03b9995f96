#include "ir/pair_blocks.hpp"

#include <algorithm>

#include "dalembert/tile_shapes.hpp"

namespace dalembert::ir {
namespace {

// Tiles of four steps by four, as blocks.hpp goes through them; both triangles of a symmetric matrix are one.
void count_tiles(const Segment& s, const SegmentBlocks& blocks, int factors, bool symmetric, int lanes, ElementCounts& counts) {
  const int limbs = s.computed_of_tiles(lanes);
  const auto tile = [&](bool written_out, int rows, int columns, bool diagonal) {
    const long above = limbs * (diagonal ? rows * (rows + 1) / 2 : rows * columns);
    const long below = symmetric ? 0 : limbs * (diagonal ? rows * (rows - 1) / 2 : rows * columns);
    counts.above += above, counts.below += below;
    if (products_loop(written_out, rows, columns, diagonal)) counts.added_to_zero += above + below;
  };
  for (int c = 0; c < s.steps; c += 4) {
    const int columns = std::min(4, s.steps - c);
    for (int r = 0; r < c; r += 4) tile(block_written_out(s.steps), 4, columns, false);
    tile(block_written_out(s.steps), columns, columns, true);
    for (const BlocksAbove& a : blocks.above)
      for (int r = 0; r < a.steps; r += 4)
        tile(block_written_out(s.steps, a.steps, factors), std::min(4, a.steps - r), columns, false);
  }
}

// Registers of long_limbs.hpp, lanes along a limb.
void count_long_limbs(const SegmentBlocks& blocks, int lanes, ElementCounts& counts) {
  const auto padded = [&](int rows) -> long {
    const int at_once = rows >= lanes ? lanes : std::max(2, std::min(lanes, 4));
    return rows <= 0 ? 0 : (rows + at_once - 1) / at_once * at_once;
  };
  const int together = lanes == 8 ? 2 : 1;
  const auto each_columns = [&](int columns, const auto& f) {
    for (int k = 0; k < columns;) {
      const int some = k + together <= columns ? together : 1;
      f(k, some);
      k += some;
    }
  };
  for (std::size_t lane = 0; lane < blocks.limbs.size(); ++lane) {
    const int joints = blocks.limbs[lane].joints();
    for (int tile = 0; tile < joints; tile += long_limb_tile) {
      const int rows = std::min(long_limb_tile, joints - tile), last = tile + rows;
      each_columns(joints, [&](int k, int some) {
        counts.above += some * padded(std::min(rows, k + some - tile));
        counts.below += some * padded(last - std::max(k + some, tile));
        if (some > 1 && k + 1 >= tile && k + 1 < last) counts.below += padded(1);
      });
    }
    for (const BlocksAbove& a : blocks.above) {
      const int above = a.limbs[lane].joints();
      for (int tile = 0; tile < above; tile += long_limb_tile)
        counts.above += joints * padded(std::min(long_limb_tile, above - tile));
      for (int tile = 0; tile < joints; tile += long_limb_tile)
        counts.below += above * padded(std::min(long_limb_tile, joints - tile));
    }
  }
}

// Along the rows of a limb that stands alone.
void count_runs(const KinematicTree& tree, const SegmentBlocks& blocks, int lanes, ElementCounts& counts) {
  const auto driven = [&](int body) { return tree.bodies[static_cast<std::size_t>(body)].driven(); };
  // Some rows of a joint's column, run by run between driven joints.
  const auto rows = [&](int column, const int* first, const int* last) {
    long total = 0, run = 0;
    const auto end_run = [&] { total += (run + lanes - 1) / lanes * lanes, run = 0; };
    for (; first != last; ++first) {
      ++run;
      if (!driven(*first) || driven(column)) continue;
      --run;
      end_run();
      total += lanes;
    }
    end_run();
    return total;
  };
  const std::vector<int>& limb = blocks.limbs[0].bodies;
  const int *begin = limb.data(), *end = begin + limb.size();
  for (const int* k = begin; k != end; ++k) {
    counts.above += rows(*k, begin, k + 1);
    counts.below += rows(*k, k + 1, end);
  }
  for (const BlocksAbove& a : blocks.above) {
    const std::vector<int>& above = a.limbs[0].bodies;
    for (const int k : limb) counts.above += rows(k, above.data(), above.data() + above.size());
    for (const int i : above) counts.below += rows(i, begin, end);
  }
}

}  // namespace

ElementCounts element_counts(const KinematicTree& tree, const Segment& segment, const PairBlocks& matrices,
                             const SegmentBlocks& blocks, bool symmetric, int lanes) {
  ElementCounts counts;
  if (blocks.empty()) return counts;
  if (segment.limb_after_limb) count_long_limbs(blocks, lanes, counts);
  else if (segment.width > 1) count_tiles(segment, blocks, static_cast<int>(matrices.lower.size()), symmetric, lanes, counts);
  else count_runs(tree, blocks, lanes, counts);
  return counts;
}

}  // namespace dalembert::ir
