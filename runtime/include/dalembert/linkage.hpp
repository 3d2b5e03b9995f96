// Local linkages whose loops are embedded: some of their joints, the dependent ones, follow others, the independent ones, and
// dynamics are those of the independent coordinates y (Jain 2012; Chignoli et al. 2023).
//
// Rows J of loops are those of the scene's loops as rows (docs/scene.md), which are emitted. Where J v = 0,
//   v_d = G y', G = -J_d^-1 J_y,    v_d' = G y'' + G' y', G' = -J_d^-1 (J_y' + J_d' G),
// and T = [1; G], G' of all linkages make M, C, forces and Jacobians of the tree those of y: T'M T, T'(C T + M T'), T'f, J T.
//
// At a toggle point J_d has no inverse: the status says so, G and G' are zero, and nothing is divided by.
#pragma once

#include <utility>

namespace dalembert {

// What following came to, or closing.
template <class T>
struct LinkageStatus {
  T error = T(0);        // the largest that loops are from closed, m or rad
  T least_pivot = T(1);  // of J_d, in terms of the largest element of its row of J: near zero where there is a toggle point
  int linkage = -1;      // the first at a toggle point, counted from 0; -1: none is
  constexpr bool ok() const noexcept { return linkage < 0; }
};

// Pivots below this count as zero: half of the digits would be lost.
template <class T>
inline constexpr T least_linkage_pivot = T(sizeof(T) > 4 ? 1e-8 : 2e-4);

// One element of T that is not of the unit matrix: the coordinate among all that follows, and the one in v that it follows.
struct Follower {
  int coordinate, follows;
};

// The rows of a linkage, of which the generator emits one struct each:
//   dependent, independent             how many joints follow, and how many they follow; rows are as many as the former
//   most_dependent, most_columns       at least as many, and at least as many as both together: how large arrays are
//   positions[], followed[]            where dependent joints are in q, independent ones in v
//   at(q, error, J)                    how far each row is from closed, and J, dependent joints' columns first
//   rates(q, rate, J_rate)             J' behind that, at these rates of the joints, by column

namespace linkage_detail {

template <class T>
constexpr T size_of(const T& x) {
  return x < T(0) ? T(-x) : x;
}

// A = L U, rows exchanged; its reciprocal pivots on the diagonal.
template <int most, class T>
struct Elimination {
  T A[most][most];
  int row[most];   // which row came to be each
  T least = T(1);  // the least pivot, in terms of how large its row is
  bool regular = true;

  // A's `n` rows, the first of `columns`: rows are as large as their largest element, those of independent joints too, since
  // dependent ones may not move a row at all. Where no joint moves it its elements are rounding, and it counts as a thousandth
  // of the largest.
  template <int all>
  Elimination(int n, int columns, const T (&J)[most][all]) noexcept {
    T scale[most], largest = T(0);
    for (int r = 0; r < n; ++r) {
      row[r] = r;
      scale[r] = T(0);
      for (int c = 0; c < columns; ++c) scale[r] = scale[r] < size_of(J[r][c]) ? size_of(J[r][c]) : scale[r];
      largest = largest < scale[r] ? scale[r] : largest;
      for (int c = 0; c < n; ++c) A[r][c] = J[r][c];
    }
    for (int r = 0; r < n; ++r) scale[r] = scale[r] < T(1e-3) * largest ? T(T(1e-3) * largest) : scale[r];
    for (int k = 0; k < n; ++k) {
      int best = k;
      T most_of_row = T(-1);
      for (int r = k; r < n; ++r) {
        const T ratio = scale[r] > T(0) ? T(size_of(A[r][k]) / scale[r]) : T(0);
        if (ratio > most_of_row) best = r, most_of_row = ratio;
      }
      if (!(most_of_row >= least)) least = most_of_row;
      if (!(least > least_linkage_pivot<T>)) {
        least = least > T(0) ? least : T(0);
        regular = false;
        return;
      }
      std::swap(row[k], row[best]);
      std::swap(scale[k], scale[best]);
      for (int c = 0; c < n; ++c) std::swap(A[k][c], A[best][c]);
      A[k][k] = T(1) / A[k][k];
      for (int r = k + 1; r < n; ++r) {
        A[r][k] *= A[k][k];
        for (int c = k + 1; c < n; ++c) A[r][c] -= A[r][k] * A[k][c];
      }
    }
  }

  // x = A^-1 b; zero where A has no inverse.
  void solve(int n, const T (&b)[most], T (&x)[most]) const noexcept {
    for (int r = 0; r < n; ++r) {
      x[r] = regular ? b[row[r]] : T(0);
      for (int c = 0; regular && c < r; ++c) x[r] -= A[r][c] * x[c];
    }
    for (int r = n; regular && r-- > 0;) {
      for (int c = r + 1; c < n; ++c) x[r] -= A[r][c] * x[c];
      x[r] *= A[r][r];
    }
  }
};

template <class T>
void take(LinkageStatus<T>& status, int number, const T& error, const T& pivot) {
  if (!(error <= status.error)) status.error = error;
  if (!(pivot >= status.least_pivot)) status.least_pivot = pivot;
  if (!(pivot > least_linkage_pivot<T>)&&status.linkage < 0) status.linkage = number;
}

template <int most, class T>
T largest(int n, const T (&x)[most]) {
  T size = T(0);
  for (int r = 0; r < n; ++r)
    if (!(size_of(x[r]) <= size)) size = size_of(x[r]);
  return size;
}

}  // namespace linkage_detail

// G and G' of the linkage of this number, row by row; v: rates of the independent coordinates; null: at rest, and G' is not
// filled.
template <class Rows, class T>
void follow(Rows& rows, int number, const T* q, const T* v, T* G, T* G_rate, LinkageStatus<T>& status) noexcept {
  constexpr int most = Rows::most_dependent;
  const int d = rows.dependent, y = rows.independent;
  T error[most], J[most][Rows::most_columns], b[most], x[most];
  rows.at(q, error, J);
  const linkage_detail::Elimination<most, T> eliminated(d, d + y, J);
  linkage_detail::take(status, number, linkage_detail::largest(d, error), eliminated.least);
  T rates[Rows::most_columns];
  for (int r = 0; r < d; ++r) rates[r] = T(0);
  for (int c = 0; c < y; ++c) {
    for (int r = 0; r < d; ++r) b[r] = -J[r][d + c];
    eliminated.solve(d, b, x);
    for (int r = 0; r < d; ++r) {
      G[r * y + c] = x[r];
      if (v) rates[r] += x[r] * v[rows.followed[c]];
    }
  }
  if (!v) return;
  for (int c = 0; c < y; ++c) rates[d + c] = v[rows.followed[c]];
  T J_rate[most][Rows::most_columns];
  rows.rates(q, rates, J_rate);
  for (int c = 0; c < y; ++c) {
    for (int r = 0; r < d; ++r) {
      b[r] = -J_rate[r][d + c];
      for (int i = 0; i < d; ++i) b[r] -= J_rate[r][i] * G[i * y + c];
    }
    eliminated.solve(d, b, x);
    for (int r = 0; r < d; ++r) G_rate[r * y + c] = x[r];
  }
}

// Positions of dependent joints, so that loops are closed: `steps` of Newton's from where they are in q, none larger than half
// a radian or metre. At a toggle point they stay where they are.
template <class Rows, class T>
void close_linkage(Rows& rows, int number, int steps, T* q, LinkageStatus<T>& status) noexcept {
  constexpr int most = Rows::most_dependent;
  const int d = rows.dependent;
  T pivot = T(1), error[most], J[most][Rows::most_columns], move[most];
  for (int step = 0; step < steps; ++step) {
    rows.at(q, error, J);
    const linkage_detail::Elimination<most, T> eliminated(d, d + rows.independent, J);
    pivot = eliminated.least;
    for (int r = 0; r < d; ++r) error[r] = -error[r];
    eliminated.solve(d, error, move);
    const T most_moved = linkage_detail::largest(d, move), part = most_moved > T(0.5) ? T(T(0.5) / most_moved) : T(1);
    for (int r = 0; r < d; ++r) q[rows.positions[r]] += part * move[r];
  }
  rows.at(q, error, J);
  linkage_detail::take(status, number, linkage_detail::largest(d, error), pivot);
}

// What follows is with T as a list of its elements: runs of coordinates that are in v as among all of the tree; `followers`,
// with a number each. Matrices stand column by column.

// Which coordinates of the tree those of v are: `count` of them from `of_all` on are those from `of_v` on; and so on.
template <int... numbers>
struct IndependentRuns {
  // f(of v, of all) for each of them.
  template <class F>
  static constexpr void each(const F& f) {
    each_run(f, std::make_integer_sequence<int, sizeof...(numbers) / 3>{});
  }

 private:
  static constexpr int number(int i) {
    const int all[] = {numbers..., 0};
    return all[i];
  }
  template <class F, int... run>
  static constexpr void each_run(const F& f, std::integer_sequence<int, run...>) {
    (each_of<number(3 * run), number(3 * run + 1), number(3 * run + 2)>(f), ...);
  }
  template <int of_v, int of_all, int count, class F>
  static constexpr void each_of(const F& f) {
    for (int i = 0; i < count; ++i) f(of_v + i, of_all + i);
  }
};

// of all = T of v.
template <class Runs, int all, int count, class T>
static inline void spread(const Follower* followers, const T* G, const T* of_v, T* of_all) noexcept {
  for (int i = 0; i < all; ++i) of_all[i] = T(0);
  Runs::each([&](int i, int at) { of_all[at] = of_v[i]; });
  for (int i = 0; i < count; ++i) of_all[followers[i].coordinate] += G[i] * of_v[followers[i].follows];
}

// of all += T' v: accelerations that dependent joints have at y'' = 0.
template <int count, class T>
static inline void add_turning(const Follower* followers, const T* G_rate, const T* v, T* of_all) noexcept {
  for (int i = 0; i < count; ++i) of_all[followers[i].coordinate] += G_rate[i] * v[followers[i].follows];
}

// to = from T, of `rows` rows.
template <class Runs, int rows, int count, class T>
static inline void project_columns(const Follower* followers, const T* G, const T* from, T* to) noexcept {
  Runs::each([&](int c, int at) {
    for (int r = 0; r < rows; ++r) to[c * rows + r] = from[at * rows + r];
  });
  for (int i = 0; i < count; ++i) {
    const T* const column = from + followers[i].coordinate * rows;
    T* const sum = to + followers[i].follows * rows;
    for (int r = 0; r < rows; ++r) sum[r] += column[r] * G[i];
  }
}

// A column of T' from, of nv rows.
template <class Runs, int count, class T>
static inline void project_column(const Follower* followers, const T* G, const T* from, T* to) noexcept {
  Runs::each([&](int r, int at) { to[r] = from[at]; });
  for (int i = 0; i < count; ++i) to[followers[i].follows] += G[i] * from[followers[i].coordinate];
}

// to = T' from, of `columns` columns.
template <class Runs, int columns, int nv, int all, int count, class T>
static inline void project_rows(const Follower* followers, const T* G, const T* from, T* to) noexcept {
  for (int c = 0; c < columns; ++c) project_column<Runs, count>(followers, G, from + c * all, to + c * nv);
}

// to = T' (from T + turned T'), nv x nv; turned: null where it is T' from T alone. Columns that nothing follows are a column of
// `from`, made shorter.
template <class Runs, int nv, int all, int count, class T>
static inline void project_both(const Follower* followers, const T* G, const T* from, const T* turned, const T* G_rate,
                                T* to) noexcept {
  bool followed[nv] = {};
  for (int i = 0; i < count; ++i) followed[followers[i].follows] = true;
  Runs::each([&](int c, int at) {
    const T* column = from + at * all;
    T whole[all];
    if (followed[c]) {
      for (int r = 0; r < all; ++r) whole[r] = column[r];
      for (int i = 0; i < count; ++i) {
        if (followers[i].follows != c) continue;
        const T* const more = from + followers[i].coordinate * all;
        for (int r = 0; r < all; ++r) whole[r] += more[r] * G[i];
        if (!turned) continue;
        const T* const turning = turned + followers[i].coordinate * all;
        for (int r = 0; r < all; ++r) whole[r] += turning[r] * G_rate[i];
      }
      column = whole;
    }
    project_column<Runs, count>(followers, G, column, to + c * nv);
  });
}

// to = from + J a, of `rows` rows, a being what dependent joints are accelerated by at y'' = 0: nothing else's columns are
// read.
template <int rows, int count, class T>
static inline void add_bias(const Follower* followers, const T* G_rate, const T* v, const T* J, const T* from, T* to) noexcept {
  for (int r = 0; r < rows; ++r) to[r] = from[r];
  for (int i = 0; i < count; ++i) {
    const T acceleration = G_rate[i] * v[followers[i].follows];
    const T* const column = J + followers[i].coordinate * rows;
    for (int r = 0; r < rows; ++r) to[r] += column[r] * acceleration;
  }
}

template <int size, class T>
static inline void copy_numbers(const T* from, T* to) noexcept {
  for (int i = 0; i < size; ++i) to[i] = from[i];
}
// to = from - to.
template <int size, class T>
static inline void subtract_from(const T* from, T* to) noexcept {
  for (int i = 0; i < size; ++i) to[i] = from[i] - to[i];
}
template <int size, class T>
static inline void clear_at_toggle_point(const LinkageStatus<T>& status, T* numbers) noexcept {
  if (status.ok()) return;
  for (int i = 0; i < size; ++i) numbers[i] = T(0);
}

}  // namespace dalembert
