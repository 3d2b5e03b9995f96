// Batches: a function of generated code at many states in one call. What callers say and are told; batch.hpp is what the code
// itself includes.
#pragma once

#include <cstddef>

namespace dalembert {

// How the k numbers of one state stand beside those of the others.
enum class BatchLayout : int {
  rows,   // a state's one after another, then the next state's: an array of n × k row by row
  lanes,  // states in blocks of batch_lanes: the first number of each state of a block, the second number of each, …; then the
          // next block. The last block takes as much room as the others: ceil(n / batch_lanes) × k × batch_lanes numbers.
          // Places of states that there are not are neither read nor written.
};

// A block of states in memory fills a cache line with each number, whatever processor the code was compiled for.
template <class T>
inline constexpr int batch_lanes = 64 / static_cast<int>(sizeof(T));

// Where number i of k of a state stands in an array of that layout.
template <class T>
constexpr std::size_t batch_index(BatchLayout layout, std::size_t state, std::size_t i, std::size_t k) noexcept {
  constexpr std::size_t lanes = batch_lanes<T>;
  return layout == BatchLayout::rows ? state * k + i : (state / lanes * k + i) * lanes + state % lanes;
}

// The order of a matrix's elements within a state.
enum class MatrixLayout : int {
  by_rows,     // all elements, as numpy has them
  by_columns,  // all elements, as Eigen has them
  packed,      // those that are not zero in every state, row by row; of symmetric matrices those on and below the diagonal
};

// An element of a matrix.
struct MatrixPlace {
  int row, column;
};

// What was wrong; nothing is computed then.
enum class BatchError : int {
  none = 0,
  count,    // more states than memory can hold
  range,    // of states beyond the batch, or one that begins within a block of batch_lanes
  q,        // null, and needed
  v,        // likewise
  input,    // likewise
  layout,   // no value of BatchLayout or MatrixLayout
  results,  // null: no function to hand blocks to
  // Of rollouts:
  steps,      // more of them than memory can hold
  time_step,  // not finite
  method,     // no value of RolloutMethod
  control,    // a function, and an input too
  left_out,   // a method that the scene does not ask for
  active,     // contacts that come on and go, which the scene does not ask for
};

constexpr const char* describe(BatchError error) noexcept {
  switch (error) {
    case BatchError::none: return "nothing is wrong";
    case BatchError::count: return "the number of states is larger than memory can hold; is it negative?";
    case BatchError::range: return "the range of states ends beyond the batch, or begins within a block of states in lanes";
    case BatchError::q: return "q is null, and positions are read";
    case BatchError::v: return "v is null, and velocities are read";
    case BatchError::input: return "what the function takes besides q and v is null, and read";
    case BatchError::layout: return "a layout is none of those there are";
    case BatchError::results: return "the function that takes blocks is null";
    case BatchError::steps: return "the number of steps is larger than memory can hold; is it negative?";
    case BatchError::time_step: return "the time step is not a finite number of seconds";
    case BatchError::method: return "the method is none of those there are";
    case BatchError::left_out:
      return "the method is not in this code: generate it with the scene key rollouts: [linearly_implicit]";
    case BatchError::active:
      return "contacts do not come on and go in this code: generate it with the scene key rollouts: [impacts]";
    case BatchError::control: return "what acts is given by an array and by a function; one of them has to be null";
  }
  return "no error of batches has this number";
}

// Blocks of that many bytes in a strip: as many as the second-level cache holds beside other things, one where nothing is cut.
constexpr int batch_strip(std::size_t bytes, int parts) {
  constexpr std::size_t room = 192 * 1024, most = 8;
  const std::size_t blocks = room / bytes < 1 ? 1 : room / bytes > most ? most : room / bytes;
  return parts == 1 ? 1 : static_cast<int>(blocks);
}

}  // namespace dalembert
