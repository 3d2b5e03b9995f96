// The generated code behind the commands: compiled, loaded, and called through its C functions.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "commands/compiler.hpp"
#include "commands/output.hpp"
#include "commands/state_file.hpp"
#include "pipeline.hpp"

namespace dalembert {

class GeneratedEngine {
 public:
  // Generates the model with these outputs, compiles it (`optimisation`: "-O1") and makes a workspace.
  GeneratedEngine(const Model& model, const std::vector<Output>& outputs, const std::string& optimisation);

  // Evaluates all outputs at the state.
  void evaluate(const State& state);

  // An output at the state last evaluated, rows × columns.
  Eigen::MatrixXd result(const Output& output) const;

  // The mean time of a call of the evaluation, ns, state to result, over the states in turn.
  double time_per_call(const std::vector<State>& states);

 private:
  using Workspace = void;

  // Calls the evaluation with the state in the code's own number type.
  template <class Scalar>
  void call(const State& state);
  template <class Scalar>
  Eigen::MatrixXd read(const Output& output) const;

  std::string name_;
  bool single_precision_;
  LoadedCode code_;
  void* evaluate_;  // void(const Scalar* q, const Scalar* v, Workspace*)
  std::unique_ptr<Workspace, void (*)(Workspace*)> workspace_;
};

}  // namespace dalembert
