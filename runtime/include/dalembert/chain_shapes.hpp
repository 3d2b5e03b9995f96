// How coordinates are taken where matrices are factored along the tree: a chain at a time. Of constants alone, for the compiler
// counts operations by them too.
#pragma once

namespace dalembert {

inline constexpr int longest_chain = 8;
// Coordinates up to which M is factored and solved with chain by chain in straight text: more of it would fill the caches of
// instructions, and larger robots' chains are gone through in loops.
inline constexpr int most_written_out = 64;

// Of an inverse that is made chain by chain: eight elements are read and written from any column's last one on.
constexpr int inverse_stride(int n) { return (n + 14) / 8 * 8; }
constexpr int inverse_size(int n) { return inverse_stride(n) * (n + 7); }

// Of a column of M's factors, where no coordinate has more than longest - 1 others above it.
constexpr int factor_stride(int longest) { return (longest + 7) / 8 * 8; }

}  // namespace dalembert
