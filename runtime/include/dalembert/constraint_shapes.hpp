// How rows of constraints are taken where they are solved for: a constraint's rows stand in a block of their own, padded to
// whole lanes. Of constants alone, for the compiler makes room by them too.
#pragma once

#include <dalembert/chain_shapes.hpp>
#include <limits>

namespace dalembert {

// Rows of a block: three where no constraint has more, else six.
constexpr int block_rows(int most_rows) { return most_rows <= 3 ? 3 : 6; }
constexpr int block_lanes(int rows) { return rows <= 3 ? 4 : 8; }

constexpr int padded_rows(int m) { return (m + 7) / 8 * 8; }
// Whether the inverse of so many rows stays in registers while it is made; else it has a room of its own.
constexpr bool in_registers(int m) { return m <= 12; }

// Numbers of what `count` constraints of m rows in all are solved in: Y, a block per coordinate above each, of which there are
// `longest` at most; the inverse inertia along their rows, of each pair of constraints; and the inverse of all of it, and a
// block's row behind it.
constexpr int constraint_room(int count, int rows, int longest, int m) {
  return count * longest * block_lanes(rows) + count * (count + 1) / 2 * rows * block_lanes(rows) +
         (in_registers(m) ? 0 : m * padded_rows(m) + 8);
}

// Numbers of what tells how n coordinates respond, of m rows: M^-1 J' and M^-1 J' L, a column per row, the latter a row per
// coordinate, too; J; L, and what it is made of, mu N among it. In registers of eight: others want less.
constexpr int response_room(int n, int m) { return (3 * inverse_stride(n) + n) * m + (n + 4 * m + 1) * padded_rows(m); }
// Of how they respond to forces that turn with one link and move with another: `more` columns and rows likewise.
constexpr int turning_room(int n, int m, int more) { return more * (inverse_stride(n) + padded_rows(m)); }

// mu, and how often: what is left of a row's error is (mu N / (mu N + its inverse inertia))^steps.
template <class T>
struct Proximal {
  static constexpr bool wide = sizeof(T) == 8;
  static constexpr T mu = wide ? T(1e-8) : T(1e-4);
  static constexpr int steps = wide ? 3 : 4;
  // Elements of J that are rounding, 64 epsilons of a metre or of one: rows of nothing else would hold what they do not touch.
  static constexpr T unmoved = wide ? T(0x1p-46) : T(0x1p-17);
  // An N so small that its inverse is next to infinity is none. A weight is no more than the largest number, and all of them
  // together no less than the smallest.
  static constexpr T least = wide ? T(1e-270) : T(1e-25), largest = std::numeric_limits<T>::max(),
                     smallest = std::numeric_limits<T>::min();
  // mu of a row. What no joint moves is held as firmly as others are: by mu alone, rounding of what it asks for would be a
  // force.
  static constexpr T of(T inverse_inertia) { return inverse_inertia > T(0) ? mu : T(1); }
};
// Of N, against the sum over all blocks: a block that nothing moves has one too.
inline constexpr double least_share = 1e-6;

}  // namespace dalembert
