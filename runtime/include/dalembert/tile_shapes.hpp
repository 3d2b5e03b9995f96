// How the tiles of tiles.hpp are laid out in the code: what is written out and what is a loop. Of constants alone, for the
// compiler counts operations by them too.
#pragma once

namespace dalembert {

// Limbs up to this length have their blocks written out; longer ones run through loops, which keeps the code in the cache.
inline constexpr int short_limb = 8;

// Limbs from this length on, alone or beside others, are taken one after another, lanes along them; so many rows are one tile
// then.
inline constexpr int long_limb = 32, long_limb_beside_others = 96, long_limb_tile = 128;

// Whether the tiles between a limb and itself, or limbs above it, are written out. factors: of the lower joints.
constexpr bool block_written_out(int steps) { return steps <= short_limb; }
constexpr bool block_written_out(int steps, int above_steps, int factors) {
  return steps <= short_limb && above_steps <= (factors > 2 ? 4 : short_limb);
}

// Whether a tile's sums of products run in a loop over components. Code that is written out runs once: it costs its fetching,
// and from 30 joints on there is more of it than the instruction cache holds. Code that loops run again and again, and that of
// small tiles, is better without a loop of its own. Measured: docs/compiler.md.
constexpr bool products_loop(bool written_out, int rows, int columns, bool diagonal) {
  return written_out && (diagonal ? rows == 4 : rows * columns >= 9);
}

}  // namespace dalembert
