// Constraints as types: their rows, the coordinates above them, and the tree as chains of coordinates. Constants alone, but for
// what solving came to.
#pragma once

#include <algorithm>
#include <dalembert/constraint_shapes.hpp>
#include <tuple>

// A static array of a class template that is each shared object's own. One that several share (a unique symbol) keeps the
// object, and what that refers to, loaded until the process ends.
#define DALEMBERT_TABLE static constexpr __attribute__((visibility("hidden")))

namespace dalembert {

// What solving for constraints came to.
template <class T>
struct ConstraintStatus {
  // The largest error that the proximal steps leave of a row that acts, by how much the last of them changed the forces:
  // without the rounding of v̇. m/s^2 or rad/s^2; of an impact, m/s or rad/s.
  T residual = T(0);
  // The least that is left of a row's N when all others are eliminated, its pivot as the last of them; at most 1: near mu where
  // rows say what others say. -1: a row that acts has a negative regularization or, of inverse dynamics, a weight that is none.
  T least_pivot = T(1);
  int rank = 0;  // how many rows that act say something new; one with regularization may do so, whatever the others say
};

// A constraint between two bodies: its rows, linear ones first, and the coordinates above one of them or both, in order. The
// first `own_common` are above both, those up to `own_split` and those behind above one each.
template <int own_rows, int own_linear, int own_common, int own_split, int... coordinates>
struct LoopPath {
  static constexpr int rows = own_rows, linear = own_linear, length = sizeof...(coordinates);
  DALEMBERT_TABLE int at[] = {coordinates...};
  // Whether the i-th of them stands above the k-th.
  static constexpr bool is_above(int i, int k) { return i < k && (k < own_split || i < own_common || i >= own_split); }
};
// One between a body and the world: the coordinates above it, the tree's root first.
template <int own_rows, int... coordinates>
using RowPath =
    LoopPath<own_rows, (own_rows < 3 ? own_rows : 3), sizeof...(coordinates), sizeof...(coordinates), coordinates...>;

// Where two lists of coordinates have the same, in pieces: from which place of each, and how many. most: of any two.
template <int most>
struct SharedPieces {
  int count = 0, a[most] = {}, b[most] = {}, size[most] = {};

  constexpr void add(int at_a, int at_b) {
    if (count > 0 && a[count - 1] + size[count - 1] == at_a && b[count - 1] + size[count - 1] == at_b) {
      ++size[count - 1];
      return;
    }
    a[count] = at_a, b[count] = at_b, size[count] = 1;
    ++count;
  }
};

// All constraints, in the order of their rows.
template <class... Paths>
struct ConstraintRows {
  static constexpr int count = sizeof...(Paths);
  DALEMBERT_TABLE int rows[count] = {Paths::rows...}, linear[count] = {Paths::linear...}, lengths[count] = {Paths::length...};
  DALEMBERT_TABLE const int* paths[count] = {Paths::at...};
  template <int c>
  using path = std::tuple_element_t<c, std::tuple<Paths...>>;

  // Row of a constraint; of `count`: how many there are.
  static constexpr int first(int c) {
    int row = 0;
    for (int i = 0; i < c; ++i) row += rows[i];
    return row;
  }
  static constexpr int block_rows() {
    int most = 0;
    for (const int r : rows) most = r > most ? r : most;
    return dalembert::block_rows(most);
  }
  // The constraint that a row is of.
  static constexpr int of_row(int row) {
    int c = 0;
    while (row >= first(c + 1)) ++c;
    return c;
  }
  static constexpr int longest(int begin = 0, int behind = count) {
    int most = 0;
    for (int c = begin; c < behind; ++c) most = lengths[c] > most ? lengths[c] : most;
    return most;
  }
  static constexpr int pair(int a, int b) { return a * count - a * (a - 1) / 2 + b - a; }  // b is not before a
  // The coordinates above both, per pair.
  struct Shared {
    SharedPieces<std::max({1, Paths::length...})> pieces[count * (count + 1) / 2] = {};
  };
  static constexpr Shared shared_pieces() {
    Shared all;
    for (int a = 0; a < count; ++a)
      for (int b = a; b < count; ++b)
        for (int i = 0, k = 0; i < lengths[a] && k < lengths[b];) {
          if (paths[a][i] == paths[b][k]) all.pieces[pair(a, b)].add(i++, k++);
          else if (paths[a][i] < paths[b][k]) ++i;
          else ++k;
        }
    return all;
  }
  DALEMBERT_TABLE Shared shared = shared_pieces();

  // The coordinates above any of them, each once, and where those above each constraint stand among them.
  struct Moving {
    static constexpr int most = (Paths::length + ...);
    int size = 0, at[most > 0 ? most : 1] = {}, of[sizeof...(Paths)][most > 0 ? most : 1] = {};
  };
  static constexpr Moving moving_coordinates() {
    Moving all;
    for (int c = 0; c < count; ++c)
      for (int i = 0; i < lengths[c]; ++i) {
        int found = 0;
        while (found < all.size && all.at[found] != paths[c][i]) ++found;
        if (found == all.size) all.at[all.size++] = paths[c][i];
        all.of[c][i] = found;
      }
    return all;
  }
  DALEMBERT_TABLE Moving moving = moving_coordinates();
  // Which of the coordinates above constraint c is the i-th of those above any; -1: none.
  static constexpr int along(int c, int i) {
    for (int k = 0; k < lengths[c]; ++k)
      if (moving.of[c][k] == i) return k;
    return -1;
  }
};

// A chain of coordinates as in factor.hpp, and where those above it stand, in runs: begin, behind, begin, behind …
template <int chain_first, int chain_count, int... runs>
struct ChainBelow {
  static constexpr int first = chain_first, count = chain_count, run_count = sizeof...(runs) / 2;
  DALEMBERT_TABLE int run[sizeof...(runs) + 1] = {runs..., 0};
};
// From the root on.
template <class... Chains>
struct ChainTree {
  static constexpr int count = sizeof...(Chains);
  DALEMBERT_TABLE int first[count] = {Chains::first...}, length[count] = {Chains::count...};
  // The coordinate that each hangs on; -1: none.
  DALEMBERT_TABLE int above[count] = {(Chains::run_count > 0 ? Chains::run[1] - 1 : -1)...};
  template <int c>
  using chain = std::tuple_element_t<c, std::tuple<Chains...>>;

  // The chain that a chain hangs on; -1: none.
  static constexpr int parent(int c) {
    for (int other = 0; other < c; ++other)
      if (first[other] + length[other] - 1 == above[c]) return other;
    return -1;
  }
};

}  // namespace dalembert
