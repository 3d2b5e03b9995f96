// The generated code behind the commands: compiled, loaded, and called through its C functions.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "commands/compiler.hpp"
#include "commands/input_setters.hpp"
#include "commands/output.hpp"
#include "commands/state_file.hpp"
#include "commands/timing.hpp"
#include "pipeline.hpp"

namespace dalembert {

// What is generated beside the functions.
enum class Besides { nothing, self_test, task_graphs };

class GeneratedEngine {
 public:
  // Generates the model with these outputs, compiles it and makes a workspace. Task graphs take oneTBB.
  GeneratedEngine(const Model& model, const std::vector<Output>& outputs, const CompilerOptions& options,
                  Besides besides = Besides::nothing);

  // Evaluates all outputs at the state.
  void evaluate(const State& state);

  // An output at the state last evaluated, rows × columns.
  Eigen::MatrixXd result(const Output& output) const;

  // What the function of the output reported at the state last evaluated: the coordinate at which M is not positive definite,
  // so that its results are zero; −1 where it is, and of functions that do not ask.
  int status(const Output& output) const;

  // The time of computing all outputs, state to result, over the states in turn. Takes some hundredths of a second.
  CallTime time_per_call(const std::vector<State>& states);

  // The same of each function that is called for them.
  struct FunctionTime {
    std::string function;  // "evaluate"
    CallTime time;
  };
  std::vector<FunctionTime> time_per_function(const std::vector<State>& states);

  // Where there are task graphs: whether evaluate() and time_per_call() run these, as they do at first, or the functions.
  void run_task_graphs(bool run) { by_task_graph_ = run; }

  // Runs the emitted self-test, which the constructor was to leave in: the empty string when it passes, else which element is
  // wrong and by how much.
  std::string self_test() const;

  // The command that compiled the code, up to the flags.
  const std::string& command() const { return code_.command(); }

 private:
  using Workspace = void;
  using TaskGraphs = void;

  // Calls the evaluation with the state in the code's own number type.
  template <class Scalar>
  void call(const State& state);
  template <class Scalar>
  void set_inputs(const State& state);
  template <class Scalar>
  Eigen::MatrixXd read(const Output& output) const;
  struct Call;
  template <class Scalar>
  CallTime time_in(const std::vector<State>& states, const std::vector<Call>& calls);

  std::string name_;
  bool single_precision_;
  LoadedCode code_;
  // One of the generated functions the outputs need.
  struct Call {
    std::string name;
    void* function;  // void(const Scalar* q, const Scalar* v[, const Scalar* more], Workspace*)
    bool takes_more;
    void* by_task_graph;  // the same, but for TaskGraphs* at the end
  };
  template <class Scalar>
  void call(const Call& call, const Scalar* q, const Scalar* v, const Scalar* more);

  std::vector<Call> calls_;
  std::vector<void*> wrench_setters_;  // void(const Scalar* wrench, Workspace*), of the scene's in order
  InputSetters input_setters_;
  std::unique_ptr<Workspace, void (*)(Workspace*)> workspace_;
  std::unique_ptr<TaskGraphs, void (*)(TaskGraphs*)> task_graphs_;
  bool by_task_graph_ = false;
};

}  // namespace dalembert
