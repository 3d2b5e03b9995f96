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
template <int lanes_, int count_, bool adds_ = false>
struct Rows {
  static constexpr int lanes = lanes_, count = count_;
  static constexpr bool adds = adds_;
};

template <int count, int n, bool adds, class T>
DALEMBERT_INLINE void put_rows(T* to, const Lanes<T, n>& x) {
  if constexpr (adds) *to += lane<n, T>(x, 0);
  else store_first<count, n, T>(to, x);
}

namespace detail {

// Whole registers, the last overlapping the one before; false: a run is shorter than one.
template <int w, class T, class F>
DALEMBERT_INLINE bool whole_rows(int at, const RowRun& run, T* to, const F& rows) {
  if (run.count < w) return false;
  DALEMBERT_KEEP_LOOP
  for (int i = 0; i < run.count; i += w) {
    const int from = least(i, run.count - w);
    rows(Rows<w, w>{}, at, run.joint + from, to + run.row + from);
  }
  return true;
}

}  // namespace detail

// rows(Rows, at, joint, to) computes rows of a body from a joint on. driven: whether any run adds.
template <bool driven, class T, class F>
DALEMBERT_BLOCK void project(const ProjectedBody* bodies, int count, const RowRun* runs, T* matrix, const F& rows) {
  constexpr int w = short_lanes < 2 ? 2 : short_lanes;
  const RowRun* run = runs;
  for (const ProjectedBody* body = bodies; body != bodies + count; ++body)
    for (T* const to = matrix + body->column; run != runs + body->end; ++run) {
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

}  // namespace dalembert
