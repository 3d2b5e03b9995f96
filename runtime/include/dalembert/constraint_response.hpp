// How accelerations and forces that keep to constraints (constraints.hpp) change with what both equations ask for:
//
//   N = M^-1 - B J M^-1     B = M^-1 J' L     L = (J M^-1 J' + R)^-1:
//
// d(dv) = -N de' - B da and df = B' de' - L da, de' being what M dv + C v + g - J' f changes by at dv and f held, da the same
// of J dv + dJ v - b (Carpentier, Budhiraja and Mansard 2021). L is what proximal steps make of the identity.
//
// Nothing allocates; loops depend on the robot and its constraints alone.
#pragma once

#include <dalembert/constraint_blocks.hpp>
#include <dalembert/constraint_shapes.hpp>

namespace dalembert {
namespace constraint_detail {

// f(columns, first): six columns at a time, and those that are left.
template <int count, class F>
static DALEMBERT_INLINE void in_sixes(const F& f) {
  for (int j = 0; j + 6 <= count; j += 6) f(std::integral_constant<int, 6>{}, j);
  if constexpr (count % 6 > 0) f(std::integral_constant<int, count % 6>{}, count - count % 6);
}

// Coordinates side by side that rows begin … end - 1 know, and no others: run by run, from which on each goes.
template <int n, class Rows, int = native_lanes>
struct KnownColumns {
  struct Table {
    int count = 0, column[n + 1] = {}, begin[n] = {}, end[n] = {};
  };
  static constexpr Table table() {
    Table all;
    for (int k = 0; k < n; ++k) {
      int begin = Rows::first(Rows::count), end = 0;
      for (int c = 0; c < Rows::count; ++c)
        for (int i = 0; i < Rows::lengths[c]; ++i)
          if (Rows::paths[c][i] == k) {
            begin = least(begin, Rows::first(c));
            end = Rows::first(c + 1);
          }
      if (end == 0) begin = 0;
      if (all.count > 0 && all.begin[all.count - 1] == begin && all.end[all.count - 1] == end) continue;
      all.column[all.count] = k, all.begin[all.count] = begin, all.end[all.count] = end;
      ++all.count;
    }
    all.column[all.count] = n;
    return all;
  }
  DALEMBERT_TABLE Table value = table();
};

// Where what respond() makes stands in its room.
template <int n, class Rows, class T, int = native_lanes>
struct ResponseParts {
  static constexpr int m = Rows::first(Rows::count), padded = rows_in_lanes(m), stride = inverse_stride(n);
  static_assert(padded <= padded_rows(m), "the compiler makes room for registers of eight");
  T* const inverse;               // of J M^-1 J' + R + mu N, m times `padded` numbers
  T* const held;                  // mu N, per row
  T* const columns;               // B, a column of `stride` numbers per row of a constraint
  T* const rows;                  // the same, `padded` numbers per coordinate, where forces are asked for
  T* const along;                 // L, as `inverse`
  T* const moved;                 // M^-1 J', as `columns`
  T *const scaled, *const other;  // as `inverse`, on the way to L
  T* const left;                  // J N, as `columns`
  T* const acting;                // J of what acts, laid out as J

  explicit ResponseParts(T* room)
      : inverse(room),
        held(inverse + m * padded),
        columns(held + padded),
        rows(columns + stride * m),
        along(rows + n * padded),
        moved(along + m * padded),
        scaled(moved + stride * m),
        other(scaled + m * padded),
        left(other + m * padded),
        acting(left + stride * m) {}
};

// The inverse of J M^-1 J' + R + mu N, and mu N, as solve_constrained() has them, where it is not asked for.
template <int n, class Rows, class T>
static DALEMBERT_INLINE void invert_response(const ResponseParts<n, Rows, T>& parts, const T* active, const T* regularization) {
  using Parts = ResponseParts<n, Rows, T>;
  constexpr int m = Parts::m, padded = Parts::padded, stride = Parts::stride;
  T* const turned = parts.rows;  // M^-1 J', a row per coordinate
  for (int r = 0; r < padded; ++r)
    for (int i = 0; i < n; ++i) turned[i * padded + r] = r < m ? parts.moved[r * stride + i] : T(0);
  for_constants<Rows::count>([&](auto constraint) DALEMBERT_IN_BLOCK {
    constexpr int first = Rows::first(decltype(constraint)::value);
    using Path = typename Rows::template path<decltype(constraint)::value>;
    sum_columns<Path::rows, padded, false, T>(
        Path::length, [&](int r, int k) { return parts.acting[Path::at[k] * m + first + r]; },
        [&](int k) { return turned + Path::at[k] * padded; }, [](int) -> const T* { return nullptr; },
        [&](int r) { return parts.inverse + (first + r) * padded; });
  });
  T sum = T(0);
  for (int r = 0; r < m; ++r) sum += parts.inverse[r * padded + r];
  for (int c = 0; c < Rows::count; ++c) {
    const int first = Rows::first(c), own = Rows::rows[c], linear = Rows::linear[c];
    T means[2] = {T(least_share) * sum, T(least_share) * sum};
    for (int r = 0; r < own; ++r)
      means[r < linear ? 0 : 1] +=
          parts.inverse[(first + r) * padded + first + r] * (T(1) / T(r < linear ? linear : own - linear));
    for (int r = 0; r < own; ++r) {
      const T mean = means[r < linear ? 0 : 1];
      const T along = parts.inverse[(first + r) * padded + first + r];
      parts.held[first + r] = active[c] > T(0) ? Proximal<T>::of(along) * (mean > T(0) ? mean : T(1)) : T(0);
      parts.inverse[(first + r) * padded + first + r] +=
          active[c] > T(0) ? parts.held[first + r] + regularization[first + r] : T(1);
    }
  }
  invert_rows<m, padded>(parts.inverse);
}

// N = M^-1 - B J M^-1.
template <int n, class Rows, class T>
__attribute__((noinline)) static void project_inverse(const ResponseParts<n, Rows, T>& parts, const T* inverse,
                                                      T* projected) noexcept {
  constexpr int m = ResponseParts<n, Rows, T>::m, stride = ResponseParts<n, Rows, T>::stride;
  in_sixes<n>([&](auto columns, int first) DALEMBERT_IN_BLOCK {
    sum_columns<decltype(columns)::value, n, true, T>(
        m, [&](int j, int k) { return parts.moved[k * stride + first + j]; }, [&](int k) { return parts.columns + k * stride; },
        [&](int j) { return inverse + (first + j) * stride; }, [&](int j) { return projected + (first + j) * stride; });
  });
}

// Where rows say what others say, numbers of L are as large as 1 / mu, and what rounding does to them is felt along rows that
// say something new: it is of L's size, and so from a share of it on more than of the last digits.
template <int n, class Rows, class T>
static DALEMBERT_INLINE bool rounding_is_felt(const ResponseParts<n, Rows, T>& parts) {
  using Parts = ResponseParts<n, Rows, T>;
  T share = T(0);
  for (int r = 0; r < Parts::m; ++r) {
    const T own = parts.along[r * Parts::padded + r] * parts.held[r];
    share = own > share ? own : share;
  }
  return share > T(sizeof(T) == 4 ? 1e-2 : 1e-4);
}

// B' grows by L (J N - R B'), of which nothing should be left.
template <int n, class Rows, class T>
__attribute__((noinline)) static void refine_response(const ResponseParts<n, Rows, T>& parts, const T* active,
                                                      const T* regularization, const T* projected) noexcept {
  using Parts = ResponseParts<n, Rows, T>;
  constexpr int m = Parts::m, padded = Parts::padded, stride = Parts::stride;
  for_constants<Rows::count>([&](auto constraint) DALEMBERT_IN_BLOCK {
    constexpr int c = decltype(constraint)::value, first = Rows::first(c);
    using Path = typename Rows::template path<c>;
    sum_columns<Path::rows, n, false, T>(
        Path::length, [&](int r, int k) { return parts.acting[Path::at[k] * m + first + r]; },
        [&](int k) { return projected + Path::at[k] * stride; }, [](int) -> const T* { return nullptr; },
        [&](int r) { return parts.left + (first + r) * stride; });
    for (int r = first; r < first + Path::rows; ++r) {
      const T gives_way = active[c] > T(0) ? regularization[r] : T(0);
      for (int i = 0; i < n; ++i) parts.left[r * stride + i] -= gives_way * parts.columns[r * stride + i];
    }
  });
  in_sixes<m>([&](auto columns, int first) DALEMBERT_IN_BLOCK {
    const auto own = [&](int r) { return parts.columns + (first + r) * stride; };
    sum_columns<decltype(columns)::value, n, false, T>(
        m, [&](int r, int k) { return parts.along[(first + r) * padded + k]; }, [&](int k) { return parts.left + k * stride; },
        own, own);
  });
}

// `columns` columns of `to` from k on, which are zero before column `first`, less B times the changes of rows begin … end - 1.
template <int n, class Rows, int columns, int begin, int end, class T>
static DALEMBERT_INLINE void subtract_changes(const ResponseParts<n, Rows, const T>& parts, int first, int k, const T* changes,
                                              T* to) {
  constexpr int m = Rows::first(Rows::count), w = native_lanes, stride = inverse_stride(n), in_registers = 6;
  DALEMBERT_KEEP_LOOP
  for (int i = 0; i < n; i += w) {
    Lanes<T, w> sum[columns];
    for_constants<columns>([&](auto j) DALEMBERT_IN_BLOCK {
      sum[j] = k + j < first ? Lanes<T, w>{} : detail::load_piece<n, w>(to + (k + j) * n, i);
    });
    const auto subtract = [&](int r) DALEMBERT_IN_BLOCK {
      Lanes<T, w> x = load<w>(parts.columns + r * stride + i);
      keep_in_register<T>(x);
      for_constants<columns>([&](auto j) DALEMBERT_IN_BLOCK { sum[j] -= broadcast<w, T>(changes[(k + j) * m + r]) * x; });
    };
    if constexpr (end - begin <= in_registers) {
      for_constants<end - begin>([&](auto r) DALEMBERT_IN_BLOCK { subtract(begin + r); });
    } else {
      DALEMBERT_KEEP_LOOP
      for (int r = begin; r < end; ++r) subtract(r);
    }
    for_constants<columns>([&](auto j) DALEMBERT_IN_BLOCK { detail::store_piece<n, w>(to + (k + j) * n, i, sum[j]); });
  }
}

}  // namespace constraint_detail

// projected = N, laid out as `inverse`, which is M^-1 as invert_chain() leaves it. room: response_room(n, rows) numbers.
// forces: whether theirs are asked for. inverted: whether solve_constrained() has left its inverse and mu N in the room.
template <int n, class Rows, bool forces, bool inverted, class T>
__attribute__((noinline)) static void respond(const T* jacobian, const T* inverse, const T* active, const T* regularization,
                                              T* room, T* projected) noexcept {
  using constraint_detail::for_constants;
  using constraint_detail::in_sixes;
  using constraint_detail::sum_columns;
  using Parts = constraint_detail::ResponseParts<n, Rows, T>;
  constexpr int m = Parts::m, padded = Parts::padded, stride = Parts::stride, w = native_lanes;
  using V = Lanes<T, w>;
  const Parts parts(room);
  const auto none = [](int) -> const T* { return nullptr; };

  // M^-1 J'.
  alignas(64) T acts[padded] = {};
  for_constants<Rows::count>([&](auto c) DALEMBERT_IN_BLOCK {
    for_constants<Rows::rows[c]>([&](auto r) DALEMBERT_IN_BLOCK { acts[Rows::first(c) + r] = active[c]; });
  });
  for_constants<padded / w>([&](auto piece) DALEMBERT_IN_BLOCK {
    constexpr int from = decltype(piece)::value * w;
    const V acting = load<w>(acts + from);
    DALEMBERT_KEEP_LOOP
    for (int i = 0; i < n; ++i) {
      const V x = detail::load_piece<m, w>(jacobian + i * m, from);
      detail::store_piece<m, w>(parts.acting + i * m, from, constraint_detail::without_rounding<T>(x) * acting);
    }
  });
  for_constants<Rows::count>([&](auto constraint) DALEMBERT_IN_BLOCK {
    constexpr int first = Rows::first(decltype(constraint)::value);
    using Path = typename Rows::template path<decltype(constraint)::value>;
    sum_columns<Path::rows, n, false, T>(
        Path::length, [&](int r, int k) { return parts.acting[Path::at[k] * m + first + r]; },
        [&](int k) { return inverse + Path::at[k] * stride; }, none, [&](int r) { return parts.moved + (first + r) * stride; });
  });
  if constexpr (!inverted) constraint_detail::invert_response<n, Rows>(parts, active, regularization);
  // L = X + X mu N L, X the inverse, a few times over; at first X.
  const auto row_of = [&](T* rows, int first) { return [=](int r) { return rows + (first + r) * padded; }; };
  const T* last = parts.inverse;
  for (int step = 1; step < Proximal<T>::steps; ++step) {
    T* const next = (Proximal<T>::steps - step) % 2 == 1 ? parts.along : parts.other;
    DALEMBERT_KEEP_LOOP
    for (int r = 0; r < m; ++r) {
      const V held = broadcast<w, T>(parts.held[r]);
      for_constants<padded / w>([&](auto i) DALEMBERT_IN_BLOCK {
        store<w, T>(parts.scaled + r * padded + i * w, held * load<w>(last + r * padded + i * w));
      });
    }
    in_sixes<m>([&](auto columns, int first) DALEMBERT_IN_BLOCK {
      sum_columns<decltype(columns)::value, padded, false, T>(
          m, [&](int r, int k) { return parts.inverse[(first + r) * padded + k]; },
          [&](int k) { return parts.scaled + k * padded; }, row_of(parts.inverse, first), row_of(next, first));
    });
    last = next;
  }
  static_assert(Proximal<T>::steps > 1, "the last of them is L");
  for (int c = 0; c < Rows::count; ++c)
    if (!(active[c] > T(0)))
      for (int r = Rows::first(c); r < Rows::first(c + 1); ++r) parts.along[r * padded + r] = T(0);

  const auto column_of = [&](T* columns, int first) { return [=](int r) { return columns + (first + r) * stride; }; };
  in_sixes<m>([&](auto columns, int first) DALEMBERT_IN_BLOCK {
    sum_columns<decltype(columns)::value, n, false, T>(
        m, [&](int r, int k) { return parts.along[(first + r) * padded + k]; }, [&](int k) { return parts.moved + k * stride; },
        none, column_of(parts.columns, first));
  });
  constraint_detail::project_inverse(parts, inverse, projected);
  if (constraint_detail::rounding_is_felt(parts)) {
    for (int again = sizeof(T) == 4 ? 2 : 1; again > 0; --again) {
      constraint_detail::refine_response(parts, active, regularization, projected);
      constraint_detail::project_inverse(parts, inverse, projected);
    }
  }
  if constexpr (forces)
    for (int r = 0; r < m; ++r)
      for (int i = 0; i < n; ++i) parts.rows[i * padded + r] = parts.columns[r * stride + i];
}

// df/dtau = -B'.
template <int n, class Rows, class T>
static inline void response_of_forces(const T* room, T* to) noexcept {
  using Parts = constraint_detail::ResponseParts<n, Rows, const T>;
  const Parts parts(room);
  for (int k = 0; k < n; ++k)
    for (int r = 0; r < Parts::m; ++r) to[k * Parts::m + r] = -parts.rows[k * Parts::padded + r];
}

// to, which is -N efforts from column `first` on, becomes -N efforts - B changes: n x n. changes: rows x n, zero where no
// constraint knows the coordinate.
template <int n, class Rows, class T>
__attribute__((noinline)) static void derive_accelerations(int first, const T* changes, const T* room, T* to) noexcept {
  using constraint_detail::subtract_changes;
  using Runs = constraint_detail::KnownColumns<n, Rows>;
  const constraint_detail::ResponseParts<n, Rows, const T> parts(room);
  detail::for_constants<Runs::value.count>([&](auto run) DALEMBERT_IN_BLOCK {
    constexpr int begin = Runs::value.begin[run], end = Runs::value.end[run], behind = Runs::value.column[run + 1];
    int k = Runs::value.column[run];
    if constexpr (begin == end) {
      for (; k < first && k < behind; ++k)
        for (int i = 0; i < n; ++i) to[k * n + i] = T(0);
    } else {
      constexpr int width = behind - Runs::value.column[run], at_once = least(width, 6), rest = width % at_once;
      DALEMBERT_KEEP_LOOP
      for (; k + at_once <= behind; k += at_once) subtract_changes<n, Rows, at_once, begin, end>(parts, first, k, changes, to);
      if constexpr (rest > 0) subtract_changes<n, Rows, rest, begin, end>(parts, first, k, changes, to);
    }
  });
}

// to = B' efforts - L changes: rows x n.
template <int n, class Rows, class T>
__attribute__((noinline)) static void derive_forces(const T* efforts, const T* changes, const T* room, T* to) noexcept {
  using Parts = constraint_detail::ResponseParts<n, Rows, const T>;
  constexpr int m = Parts::m, padded = Parts::padded;
  const Parts parts(room);
  constraint_detail::in_sixes<n>([&](auto columns, int first) DALEMBERT_IN_BLOCK {
    constexpr int count = decltype(columns)::value;
    alignas(64) T column[count * padded];
    const auto own = [&](int j) { return column + j * padded; };
    constraint_detail::sum_columns<count, padded, false, T>(
        n, [&](int j, int k) { return efforts[(first + j) * n + k]; }, [&](int k) { return parts.rows + k * padded; },
        [](int) -> const T* { return nullptr; }, own);
    constraint_detail::sum_columns<count, padded, true, T>(
        m, [&](int j, int r) { return changes[(first + j) * m + r]; }, [&](int r) { return parts.along + r * padded; }, own,
        own);
    for (int j = 0; j < count; ++j)
      for (int r = 0; r < m; ++r) to[(first + j) * m + r] = column[j * padded + r];
  });
}

// Where the forces of loops turn with one link and move with another, efforts are more by left' right, both `more` x n: what
// the two derivatives have more of it. Either may be null. turning: turning_room(n, rows, more) numbers.
template <int n, class Rows, int more, class T>
__attribute__((noinline)) static void derive_turning(const T* left, const T* right, const T* projected, const T* room,
                                                     T* turning, T* accelerations, T* forces) noexcept {
  using constraint_detail::in_sixes;
  using constraint_detail::sum_columns;
  using Parts = constraint_detail::ResponseParts<n, Rows, const T>;
  constexpr int m = Parts::m, padded = Parts::padded, stride = Parts::stride;
  const Parts parts(room);
  T* const of_forces = turning + more * stride;
  const auto none = [](int) -> const T* { return nullptr; };
  in_sixes<more>([&](auto columns, int first) DALEMBERT_IN_BLOCK {
    constexpr int count = decltype(columns)::value;
    const auto factor = [&](int i, int k) { return left[k * more + first + i]; };
    sum_columns<count, n, false, T>(
        n, factor, [&](int k) { return projected + k * stride; }, none, [&](int i) { return turning + (first + i) * stride; });
    if (forces)
      sum_columns<count, padded, false, T>(
          n, factor, [&](int k) { return parts.rows + k * padded; }, none,
          [&](int i) { return of_forces + (first + i) * padded; });
  });
  for (int k = 0; k < n; ++k) {
    const auto factor = [&](int, int i) { return right[k * more + i]; };
    alignas(64) T column[stride > padded ? stride : padded];
    const auto own = [&](int) { return column; };
    if (accelerations) {
      sum_columns<1, n, true, T>(
          more, factor, [&](int i) { return turning + i * stride; }, none, own);
      for (int i = 0; i < n; ++i) accelerations[k * n + i] += column[i];
    }
    if (forces) {
      sum_columns<1, padded, false, T>(
          more, factor, [&](int i) { return of_forces + i * padded; }, none, own);
      for (int r = 0; r < m; ++r) forces[k * m + r] += column[r];
    }
  }
}

}  // namespace dalembert
