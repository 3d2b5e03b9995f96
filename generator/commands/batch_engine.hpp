// The generated functions of many states behind the commands: compiled, loaded, and called through its C functions.
#pragma once

#include <Eigen/Core>
#include <dalembert/rollout_layout.hpp>
#include <string>
#include <vector>

#include "commands/compiler.hpp"
#include "commands/input_setters.hpp"
#include "commands/output.hpp"
#include "commands/state_file.hpp"
#include "commands/timing.hpp"
#include "pipeline.hpp"

namespace dalembert {

class BatchEngine {
 public:
  // Generates the model's batches with these outputs and compiles them.
  BatchEngine(const Model& model, const std::vector<Output>& outputs, const CompilerOptions& options);

  // Evaluates all outputs at all states, in one call per function; those of which constraints act otherwise than in a new
  // workspace once more in such calls, for what a workspace says is of all states.
  void evaluate(const std::vector<State>& states);

  // An output at one of the states last evaluated, rows × columns; and what its function reported of it: the coordinate at
  // which M is not positive definite, −1 where it is.
  Eigen::MatrixXd result(const Output& output, size_t state) const;
  int status(const Output& output, size_t state) const;

  // The outputs that rollouts move by: v̇, one of each function that tells it.
  std::vector<Output> accelerations() const;

  // Where motions end that such a function makes from the states on, what the states have besides acting in each step; and the
  // step that a motion could not make, or −1.
  struct Ends {
    std::vector<Eigen::VectorXd> q, v;
    std::vector<int> stopped;
  };
  Ends roll_out(const Output& acceleration, const std::vector<State>& states, size_t steps, double time_step,
                RolloutMethod method);

  // The time of computing all outputs, per state, of a batch of at least a thousand: these states over and over.
  double time_per_state(const std::vector<State>& states);

 private:
  // One of the generated functions, and where its results go.
  struct Call {
    std::string function;
    void* address;  // as declared in c_api.h
    std::vector<Output> outputs;
    std::vector<std::vector<char>> results;
    std::vector<int> status;
  };
  struct Columns {
    std::vector<char> q, v, more;  // numbers of the code's type, state after state
    std::vector<std::vector<char>> of_wrench;
    size_t count = 0;
  };

  // The options of c_api.h, matrices by columns. workspace: null: a new one.
  std::vector<char> options(const Columns& columns, const void* workspace = nullptr) const;
  template <class Scalar>
  Ends roll_out_in(const Output& acceleration, const std::vector<State>& states, size_t steps, double time_step,
                   RolloutMethod method);
  template <class Scalar>
  Columns columns(const std::vector<State>& states) const;
  void run(const Columns& columns, const void* workspace = nullptr);
  const Call& call_of(const Output& output, size_t& index) const;

  Model model_;
  LoadedCode code_;
  InputSetters input_setters_;
  std::vector<Call> calls_;
};

}  // namespace dalembert
