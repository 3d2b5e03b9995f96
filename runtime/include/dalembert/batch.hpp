// Batches, inside: a function's straight program runs on registers whose lanes are states.
//
// Nothing in it depends on what stands in the other lanes, so that a state's results are the same bits wherever it stands.
// States are taken in blocks of one register, blocks in strips: where a program is cut into parts, each part runs over a strip
// before the next one does, so that its instructions are fetched once for all of them. Rows become lanes, and lanes rows, by
// transposing in registers; a block that is not full repeats its last state, and what it computes for the others is not stored.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "dalembert/batch_layout.hpp"
#include "dalembert/factor.hpp"
#include "dalembert/lanes.hpp"
#include "dalembert/sincos.hpp"
#include "dalembert/straight_line.hpp"

namespace dalembert {

// States that are computed together.
template <class T>
inline constexpr int batch_width = native_lanes* static_cast<int>(sizeof(double) / sizeof(T));

template <class T>
using BatchLanes = Lanes<T, batch_width<T>>;

// What is known of a block of states: `scratch` is what one part of the program leaves to later ones, `values` the results'
// elements, and a zero behind them.
template <class T, int nq, int nv, int more, int given_numbers, int angles, int kept_values, int elements>
struct BatchBlock {
  using V = BatchLanes<T>;
  static constexpr int at_least_one(int n) { return n > 0 ? n : 1; }
  static constexpr int element_count = elements;
  alignas(64) V q[at_least_one(nq)], v[at_least_one(nv)], input[at_least_one(more)], given[at_least_one(given_numbers)];
  alignas(64) V angle[at_least_one(angles)], sine[at_least_one(angles)], cosine[at_least_one(angles)];
  alignas(64) V scratch[at_least_one(kept_values)], values[elements + 1];
  int status[batch_width<T>];  // where the function solves equations with M
  int states;                  // that are wanted; other lanes may be anything
};

namespace detail {

template <class T, int distance, bool high, class V, int... lane>
DALEMBERT_INLINE V exchanged(const V& a, const V& b, std::integer_sequence<int, lane...>) {
  constexpr int n = sizeof...(lane);
  if constexpr (high) return shuffled<T, ((lane & distance) != 0 ? n + lane : lane + distance)...>(a, b);
  else return shuffled<T, ((lane & distance) != 0 ? n + lane - distance : lane)...>(a, b);
}

// Lane j of row i becomes lane i of row j.
template <class T, int n, int distance = n / 2, class V>
DALEMBERT_INLINE void transpose(V (&row)[n]) {
  if constexpr (distance > 0) {
    for_constants<n>([&](auto i) DALEMBERT_ALWAYS {
      if constexpr ((i & distance) == 0) {
        const V a = row[i], b = row[i + distance];
        row[i] = exchanged<T, distance, false>(a, b, std::make_integer_sequence<int, n>{});
        row[i + distance] = exchanged<T, distance, true>(a, b, std::make_integer_sequence<int, n>{});
      }
    });
    transpose<T, n, distance / 2>(row);
  }
}

// `count` numbers of each of batch_width states, row by row, a state's `apart` behind the one's before it.
template <int count, class T>
DALEMBERT_BLOCK void read_rows(const T* from, std::size_t apart, BatchLanes<T>* to) {
  constexpr int w = batch_width<T>;
  if constexpr (w == 1) {
    for (int i = 0; i < count; ++i) to[i] = from[i];
  } else if constexpr (count < w) {
    for (int i = 0; i < count; ++i) {
      T number[w];
      for (int j = 0; j < w; ++j) number[j] = from[static_cast<std::size_t>(j) * apart + static_cast<std::size_t>(i)];
      to[i] = load<w>(number);
    }
  } else {
    const auto tile = [&](int i) DALEMBERT_IN_BLOCK {
      BatchLanes<T> row[w];
      for_constants<w>([&](auto j) DALEMBERT_ALWAYS { row[j] = load<w>(from + j * apart + i); });
      transpose<T, w>(row);
      for_constants<w>([&](auto j) DALEMBERT_ALWAYS { to[i + j] = row[j]; });
    };
    for (int i = 0; i + w <= count; i += w) tile(i);
    if constexpr (count % w != 0) tile(count - w);
  }
}

}  // namespace detail

// `count` numbers of each of `states` states, from state `first` of the array on; of an array of `all` numbers a state, those
// from number `begin` on.
template <int count, class T>
static inline void read_states(const T* from, BatchLayout layout, std::size_t first, int states, BatchLanes<T>* to,
                               std::size_t all = count, std::size_t begin = 0) noexcept {
  constexpr int w = batch_width<T>, lanes = batch_lanes<T>;
  if (layout == BatchLayout::lanes) {
    const T* const at = from + batch_index<T>(layout, first, begin, all);
    if (states == w) {
      for (int i = 0; i < count; ++i) to[i] = load<w>(at + i * lanes);
      return;
    }
    for (int i = 0; i < count; ++i) {
      T number[w];
      for (int j = 0; j < w; ++j) number[j] = at[i * lanes + least(j, states - 1)];
      to[i] = load<w>(number);
    }
    return;
  }
  const T* const row = from + first * all + begin;
  if (states == w) return detail::read_rows<count>(row, all, to);
  T padded_rows[w * count];
  for (int j = 0; j < w; ++j)
    std::memcpy(padded_rows + j * count, row + static_cast<std::size_t>(least(j, states - 1)) * all, sizeof(T) * count);
  detail::read_rows<count>(padded_rows, count, to);
}

// Run-time inputs: those of each state, or where there are none, one for all of them.
template <int count, class T>
static inline void read_given(const T* of_each, const T* of_all, BatchLayout layout, std::size_t first, int states,
                              BatchLanes<T>* to) noexcept {
  if (of_each) return read_states<count>(of_each, layout, first, states, to);
  for (int i = 0; i < count; ++i) to[i] = broadcast<batch_width<T>, T>(of_all[i]);
}

// values[at[0]], values[at[1]], …, `count` of them, or without `at` those in order: into the array that `to` is, states from
// `first` on. Of an array of `all` numbers a state (0: `count`), those from number `begin` on.
template <class T>
static inline void write_states(const BatchLanes<T>* values, const std::uint16_t* at, int count, BatchLayout layout,
                                std::size_t first, int states, T* to, std::size_t all = 0, std::size_t begin = 0) noexcept {
  if (all == 0) all = static_cast<std::size_t>(count);
  constexpr int w = batch_width<T>, lanes = batch_lanes<T>;
  const auto value = [&](int i) DALEMBERT_ALWAYS -> const BatchLanes<T>& { return values[at ? at[i] : i]; };
  if (layout == BatchLayout::lanes) {
    T* const place = to + batch_index<T>(layout, first, begin, all);
    for (int i = 0; i < count; ++i) {
      if (states == w) store<w, T>(place + i * lanes, value(i));
      else
        for (int j = 0; j < states; ++j) place[i * lanes + j] = lane<w, T>(value(i), j);
    }
    return;
  }
  T* const first_row = to + first * all + begin;
  const auto row = [&](int j) DALEMBERT_ALWAYS { return first_row + static_cast<std::size_t>(j) * all; };
  if (count < w) {
    for (int i = 0; i < count; ++i)
      for (int j = 0; j < states; ++j) row(j)[i] = lane<w, T>(value(i), j);
    return;
  }
  if constexpr (w == 1) {
    for (int i = 0; i < count; ++i) first_row[i] = value(i);
  } else {
    const auto tile = [&](int i) DALEMBERT_IN_BLOCK {
      BatchLanes<T> of_state[w];
      detail::for_constants<w>([&](auto j) DALEMBERT_ALWAYS { of_state[j] = value(i + j); });
      detail::transpose<T, w>(of_state);
      if (states == w) {
        detail::for_constants<w>([&](auto j) DALEMBERT_ALWAYS { store<w, T>(row(j) + i, of_state[j]); });
      } else {
        for (int j = 0; j < states; ++j) store<w, T>(row(j) + i, of_state[j]);
      }
    };
    for (int i = 0; i + w <= count; i += w) tile(i);
    if (count % w != 0) tile(count - w);
  }
}

// `count` numbers of one state of a block, and back.
template <class T>
static inline void take_state(const BatchLanes<T>* from, int count, int state, T* to) noexcept {
  for (int i = 0; i < count; ++i) to[i] = lane<batch_width<T>, T>(from[i], state);
}
template <class T>
static inline void put_state(const T* from, int count, int state, BatchLanes<T>* to) noexcept {
  for (int i = 0; i < count; ++i) reinterpret_cast<T*>(to + i)[state] = from[i];
}

// Sines and cosines of `count` registers of angles. Of an angle that is large, the library's: of that one, not of others beside
// it.
template <class T>
static inline void batch_sincos(const BatchLanes<T>* angle, int count, BatchLanes<T>* sine, BatchLanes<T>* cosine) noexcept {
  constexpr int w = native_lanes < 2 ? 2 : native_lanes;
  const T* const x = reinterpret_cast<const T*>(angle);
  T *const s = reinterpret_cast<T*>(sine), *const c = reinterpret_cast<T*>(cosine);
  const int numbers = count * batch_width<T>;
  using V = Lanes<double, w>;
  V largest{}, smallest{};
  const auto compute = [&](const T* from, T* to_sine, T* to_cosine) DALEMBERT_IN_BLOCK {
    const V in = __builtin_convertvector(load<w>(from), V);
    largest = in > largest ? in : largest;
    smallest = in < smallest ? in : smallest;
    V si, co;
    detail::sincos_reduced<w>(in, si, co);
    store<w, T>(to_sine, __builtin_convertvector(si, Lanes<T, w>));
    store<w, T>(to_cosine, __builtin_convertvector(co, Lanes<T, w>));
  };
  if constexpr (batch_width<T> < w) {
    for (int i = 0; i < numbers; ++i) {
      const T twice[2] = {x[i], x[i]};
      T si[2], co[2];
      compute(twice, si, co);
      s[i] = si[0], c[i] = co[0];
    }
  } else {
    for (int i = 0; i < numbers; i += w) compute(x + i, s + i, c + i);
  }
  const V size = largest > -smallest ? largest : -smallest;
  bool small = true;
  for (int j = 0; j < w; ++j) small &= size[j] <= sincos_fast_limit;
#ifndef DALEMBERT_LIBRARY_SINES
  if (__builtin_expect(small, 1)) return;
#endif
  for (int i = 0; i < numbers; ++i) {
#ifndef DALEMBERT_LIBRARY_SINES
    if (std::fabs(static_cast<double>(x[i])) <= sincos_fast_limit) continue;
#endif
    s[i] = static_cast<T>(std::sin(static_cast<double>(x[i])));
    c[i] = static_cast<T>(std::cos(static_cast<double>(x[i])));
  }
}

// A matrix, or without `by_rows` and `by_columns` a vector, whose elements stand at values + first, `packed` of them; the
// tables say where among all values the elements of the whole matrix stand, `whole` of them.
struct BatchMatrix {
  int first, packed, whole;
  const std::uint16_t *by_rows, *by_columns;
};
template <class T>
static inline void write_matrix(const BatchLanes<T>* values, const BatchMatrix& matrix, MatrixLayout order, BatchLayout layout,
                                std::size_t first, int states, T* to) noexcept {
  if (!to) return;
  if (order == MatrixLayout::packed || !matrix.by_rows)
    return write_states<T>(values + matrix.first, nullptr, matrix.packed, layout, first, states, to);
  write_states<T>(values, order == MatrixLayout::by_rows ? matrix.by_rows : matrix.by_columns, matrix.whole, layout, first,
                  states, to);
}

// What every batch has to be: `widest` numbers of a state stand together at most.
static inline BatchError check_batch(std::size_t count, std::size_t first, std::size_t number, std::size_t widest,
                                     BatchLayout states, BatchLayout results, MatrixLayout matrices) noexcept {
  const auto known = [](BatchLayout layout) { return layout == BatchLayout::rows || layout == BatchLayout::lanes; };
  if (!known(states) || !known(results) || static_cast<unsigned>(matrices) > static_cast<unsigned>(MatrixLayout::packed))
    return BatchError::layout;
  // Of whole blocks, in bytes, and with a sign: differences of pointers.
  if (count > std::numeric_limits<std::size_t>::max() / 2 / sizeof(double) / widest - 16) return BatchError::count;
  const bool lanes = states == BatchLayout::lanes || results == BatchLayout::lanes;
  if (first > count || number > count - first || (lanes && first % 16 != 0)) return BatchError::range;
  return BatchError::none;
}

// Whether no pivot of M of any state needs a bound (dalembert/pivots.hpp), of n pivots and M's diagonal. status: -1 for each
// state of which that is so, 0 for others.
template <int n, class T>
static inline bool batch_holds(const BatchLanes<T>* pivots, const BatchLanes<T>* diagonal, int* status) noexcept {
  constexpr int w = batch_width<T>;
  bool all = true;
  if constexpr (w == 1) {
    all = detail::all_hold<n>(pivots, diagonal);
    status[0] = all ? -1 : 0;
  } else {
    using I = Lanes<detail::CountOf<T>, w>;
    I holds = I{} - 1;
    for (int k = 0; k < n; ++k) holds &= (pivots[k] > detail::least_ratio<T>() * diagonal[k]) & (pivots[k] > BatchLanes<T>{});
    for (int j = 0; j < w; ++j) {
      status[j] = holds[j] ? -1 : 0;
      all &= status[j] < 0;
    }
  }
  return all;
}

// Where a pivot does need a bound (status 0): of M with what a linearly implicit step adds to its diagonal, which no function
// computes at single states. What is added makes pivots larger by as much at least: where M may be solved with, this may, too.
// status: the first coordinate, from the last on, whose pivot is not above what rounding may leave of its diagonal element; −1.
template <int n, class T>
static inline void batch_pivots_hold(const BatchLanes<T>* pivots, const BatchLanes<T>* diagonal, int* status) noexcept {
  constexpr int w = batch_width<T>;
  for (int j = 0; j < w; ++j) {
    if (status[j] < 0) continue;
    status[j] = -1;
    for (int k = n - 1; k >= 0 && status[j] < 0; --k)
      if (!detail::exceeds<T>(lane<w, T>(pivots[k], j), lane<w, T>(diagonal[k], j), detail::rounding_left<T>(n))) status[j] = k;
  }
}

// What was solved for means nothing where M is not positive definite.
template <class T>
static inline void batch_clear(const int* status, BatchLanes<T>* values, int count) noexcept {
  constexpr int w = batch_width<T>;
  T* const number = reinterpret_cast<T*>(values);
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < w; ++j)
      if (status[j] >= 0) number[i * w + j] = T(0);
}

// Calls take(block, first state, how many) for the states from `first` up to `end`. Program: a function's, with a Block, how
// many of them are a strip (`strip`), and functions
//   fill(block, first state, how many): reads states,
//   run(blocks, how many): computes the values from them.
template <class Program, class Take>
static inline void run_batch(Program&& program, std::size_t first, std::size_t end, const Take& take) noexcept {
  using P = std::decay_t<Program>;
  using Block = typename P::Block;
  constexpr std::size_t w = P::width;
  Block blocks[P::strip];
  for (Block& block : blocks) block.values[Block::element_count] = typename Block::V{};
  while (first < end) {
    int count = 0;
    std::size_t states[P::strip];
    for (std::size_t at = first; at < end && count < P::strip; at += w, ++count) {
      states[count] = end - at < w ? end - at : w;
      blocks[count].states = static_cast<int>(states[count]);
      program.fill(blocks[count], at, blocks[count].states);
    }
    program.run(blocks, count);
    for (int i = 0; i < count; ++i) {
      take(blocks[i], first, static_cast<int>(states[i]));
      first += states[i];
    }
  }
}

}  // namespace dalembert
