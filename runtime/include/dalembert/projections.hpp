// Matrices with some columns per body and a row per coordinate: what the body sees of every joint above it, itself included.
//
// Rows of joints of which one is directly below the other follow one another: lanes run along them, down a column. What stands
// between the rows of joints above a body is not touched.
#pragma once

#include "dalembert/lanes.hpp"

namespace dalembert {

// Joints above a body whose numbers and rows follow one another. `adds`: one joint, whose row has another's share already.
struct RowRun {
  int joint, row, count;
  bool adds;
};

// Where what a body's columns are made of stands, its first element, and behind which of the runs its own end.
struct ProjectedBody {
  int at, column, end;
};

// The first `count` of as many rows as there are lanes.
template <int lanes, int count, bool adds = false>
struct Rows {
  template <class T>
  using Values = Lanes<T, lanes>;
  template <class T>
  DALEMBERT_INLINE Lanes<T, lanes> load(const T* from) const {
    return dalembert::load<lanes>(from);
  }
  template <class T>
  DALEMBERT_INLINE Lanes<T, lanes> all(T x) const {
    return broadcast<lanes, T>(x);
  }
  template <class T>
  DALEMBERT_INLINE void put(T* to, const Lanes<T, lanes>& x) const {
    if constexpr (adds) *to += lane<lanes, T>(x, 0);
    else store_first<count, lanes, T>(to, x);
  }
};

// Two registers of rows: what is the same in all rows is read once for both.
template <class T, int lanes>
struct TwoRegisters {
  Lanes<T, lanes> first, second;

  friend DALEMBERT_INLINE TwoRegisters operator+(const TwoRegisters& a, const TwoRegisters& b) {
    return {a.first + b.first, a.second + b.second};
  }
  friend DALEMBERT_INLINE TwoRegisters operator-(const TwoRegisters& a, const TwoRegisters& b) {
    return {a.first - b.first, a.second - b.second};
  }
  friend DALEMBERT_INLINE TwoRegisters operator*(const TwoRegisters& a, const TwoRegisters& b) {
    return {a.first * b.first, a.second * b.second};
  }
  friend DALEMBERT_INLINE TwoRegisters operator-(const TwoRegisters& a) { return {-a.first, -a.second}; }
};
template <int lanes>
struct TwiceRows {
  int second;  // rows from the first register's to the second's

  template <class T>
  using Values = TwoRegisters<T, lanes>;
  template <class T>
  DALEMBERT_INLINE TwoRegisters<T, lanes> load(const T* from) const {
    return {dalembert::load<lanes>(from), dalembert::load<lanes>(from + second)};
  }
  template <class T>
  DALEMBERT_INLINE TwoRegisters<T, lanes> all(T x) const {
    return {broadcast<lanes, T>(x), broadcast<lanes, T>(x)};
  }
  template <class T>
  DALEMBERT_INLINE void put(T* to, const TwoRegisters<T, lanes>& x) const {
    store<lanes, T>(to, x.first);
    store<lanes, T>(to + second, x.second);
  }
};

// Where there is no floating base.
struct NoBaseRows {
  template <class T>
  DALEMBERT_INLINE void operator()(int, T*) const {}
};

namespace detail {

// Whole registers, the last overlapping the one before; false: a run is shorter than one.
template <int w, class T, class F>
DALEMBERT_INLINE bool whole_rows(int at, const RowRun& run, T* to, const F& rows) {
  if (run.count < w) return false;
  int i = 0;
  if constexpr (w > 2) {
    DALEMBERT_KEEP_LOOP
    for (; i + w < run.count; i += 2 * w) rows(TwiceRows<w>{least(w, run.count - w - i)}, at, run.joint + i, to + run.row + i);
    if (i >= run.count) return true;
    i = run.count - w;
    rows(Rows<w, w>{}, at, run.joint + i, to + run.row + i);
  } else {
    DALEMBERT_KEEP_LOOP
    for (; i < run.count; i += w) {
      const int from = least(i, run.count - w);
      rows(Rows<w, w>{}, at, run.joint + from, to + run.row + from);
    }
  }
  return true;
}

}  // namespace detail

// rows(Rows, at, joint, to) computes rows of a body from a joint on, base_rows(at, to) the base's: a body's one after another,
// so that its columns stay at hand. driven: whether any run adds.
template <bool driven, class T, class F, class Base>
DALEMBERT_BLOCK void project(const ProjectedBody* bodies, int count, const RowRun* runs, T* matrix, const F& rows,
                             const Base& base_rows) {
  constexpr int w = short_lanes < 2 ? 2 : short_lanes;
  const RowRun* run = runs;
  for (const ProjectedBody* body = bodies; body != bodies + count; ++body) {
    T* const to = matrix + body->column;
    base_rows(body->at, to);
    for (; run != runs + body->end; ++run) {
      if constexpr (driven)
        if (run->adds) {
          rows(Rows<1, 1, true>{}, body->at, run->joint, to + run->row);
          continue;
        }
      // A run of a few rows takes registers of four at most: the rest of a wider one would be computed and thrown away.
      if constexpr (native_lanes > w)
        if (detail::whole_rows<native_lanes>(body->at, *run, to, rows)) continue;
      if (detail::whole_rows<w>(body->at, *run, to, rows)) continue;
      if constexpr (w > 2) {
        if (run->count == 3) {
          rows(Rows<w, 3>{}, body->at, run->joint, to + run->row);
          continue;
        }
        if (run->count == 2) {
          rows(Rows<2, 2>{}, body->at, run->joint, to + run->row);
          continue;
        }
      }
      rows(Rows<1, 1>{}, body->at, run->joint, to + run->row);
    }
  }
}

}  // namespace dalembert
