// Robot states from a text file, one a line: q, v, then what a function takes besides, numbers separated by blanks.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "diagnostics.hpp"
#include "ir/acting.hpp"
#include "ir/function.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/loading.hpp"

namespace dalembert {

struct State {
  std::string place;           // "line 3", for diagnostics
  Eigen::VectorXd q;           // nq, layout as `info` prints it; the base's quaternion is of unit length
  Eigen::VectorXd v;           // nv
  Eigen::VectorXd more{};      // nv: what the function takes besides; empty where it takes nothing
  Eigen::VectorXd wrenches{};  // six numbers for each of the scene's, where the function takes something besides
  ir::Acting acting{};         // as in a new workspace, where the state is a file's
  ir::Loading loading{};       // likewise
};

// What is read of a file or a pipe: some hundred thousand states of a humanoid.
inline constexpr size_t most_bytes_of_states = size_t{256} << 20;

// Reads the file, or standard input when its name is "-". '#' begins a comment; blank lines are skipped. "nan" is a number,
// for inputs that a quantity does not read (commands/finite_inputs refuses others). Throws InputError for a line with another
// count of numbers than the function takes, for what is no number, for a quaternion of length zero, for a file without states,
// and for what is no text or longer than that. A quaternion is normalised, with a warning when its length is off by more than
// 1e-6; one that holds NaN is left as it is.
std::vector<State> read_states(const std::string& path, const ir::KinematicTree& tree, ir::Function function,
                               Diagnostics& warnings);

// The same for a text; `file` is for the diagnostics.
std::vector<State> read_states_text(const std::string& file, const std::string& text, const ir::KinematicTree& tree,
                                    ir::Function function, Diagnostics& warnings);

}  // namespace dalembert
