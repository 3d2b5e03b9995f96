// A straight program, cut into parts, whose values are registers of states.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "backend/emit.hpp"
#include "ir/run_time_inputs.hpp"

namespace dalembert::backend {

// An array of the function's among the values of a block of states.
struct BatchArray {
  ir::OutputArray array;
  int first = 0;                            // of its elements' places among the values
  std::vector<std::pair<int, int>> packed;  // row and column of each; of a symmetric matrix on and below the diagonal
  bool symmetric = false;                   // by construction: an element and its mirror image are one value
  std::vector<int> by_columns;              // place of each element of the whole matrix, column by column; −1: zero
  bool cleared = false;                     // where M is not positive definite
  std::vector<int> by_rows() const;         // row by row
};

class BatchProgram {
 public:
  // Of the function's straight form for batches. Arrays between are none of its results.
  // Where there is none (CodeInput::batch), the function itself is called for one state after another: nothing is printed here,
  // and every element of a result has a place. all_given: a block has all run-time inputs, not only those that the line reads.
  explicit BatchProgram(const CodeInput& code, bool all_given = false) : BatchProgram(code, code.batch, all_given) {}
  // Of another line of the function's, or null: of none.
  BatchProgram(const CodeInput& code, const CodeInput* line, bool all_given = false);

  bool by_calls() const { return by_calls_; }

  // The run-time inputs that a block of states has, one behind the other; how many numbers they are, and where the one of an
  // input of the scene stands.
  const std::vector<ir::RunTimeInput>& given() const { return given_; }
  int given_count() const;
  int given_place(const ir::Input& input) const;

  const std::vector<BatchArray>& results() const { return results_; }
  // M's pivots and diagonal, where the function has a guard.
  const std::vector<BatchArray>& checked() const { return checked_; }
  int elements() const { return elements_; }
  int angles() const { return static_cast<int>(angle_index_.size()); }
  int kept() const { return kept_; }
  int parts() const { return parts_; }
  long operations() const { return operations_; }
  // Which of the vectors that it takes it reads.
  bool reads_positions() const { return reads_positions_; }
  bool reads_velocities() const { return reads_velocities_; }
  bool reads_input() const { return reads_input_; }

  // Statements that compute the angles, and values that are zero in every state; or a part of the values.
  std::string angle_statements() const;
  std::string part_statements(int part) const;

 private:
  bool reads(const ir::RunTimeInput& input) const;
  void place_elements();
  void place_all();
  void find_angles();
  void cut();
  std::string input_text(const ir::Input& input) const;
  std::string given_text(const ir::Input& input) const;
  bool is_free(ir::NodeId id) const;

  const bool by_calls_;
  const CodeInput& code_;
  const ir::Graph& graph_;
  std::vector<std::int32_t> uses_;
  std::vector<ir::RunTimeInput> given_;
  std::vector<BatchArray> results_, checked_;
  std::vector<std::vector<int>> places_;   // per node: among the values
  std::vector<int> zeros_;                 // of vectors: places of elements that are zero in every state
  std::map<ir::NodeId, int> angle_index_;  // angle → number
  std::vector<int> part_of_, slot_of_;     // per node; slot −1: not needed by a later part
  int elements_ = 0, kept_ = 0, parts_ = 1;
  long operations_ = 0;
  bool reads_positions_ = false, reads_velocities_ = false, reads_input_ = false;
};

}  // namespace dalembert::backend
