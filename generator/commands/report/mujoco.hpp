// MuJoCo beside the generated code: loaded where the user's compiler finds it, with a model made from the compiler's tree.
//
// Its coordinates differ from ours and are converted here, nowhere else: quaternions w x y z, and a base velocity whose linear
// part is along the world's axes.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "commands/compiler.hpp"
#include "commands/output.hpp"
#include "commands/state_file.hpp"
#include "commands/timing.hpp"
#include "pipeline.hpp"

namespace dalembert::reporting {

inline constexpr const char* mujoco_variant = "MuJoCo";

class Mujoco {
 public:
  // Compiles the calls of MuJoCo and loads them, if that is possible.
  Mujoco(const Model& model, const CompilerOptions& compiler);

  bool found() const { return !version_.empty(); }
  const std::string& version() const { return version_; }  // "2.2.2"
  const std::string& why_not_found() const { return obstacle_; }

  // Why it does not compute this; empty: it does.
  std::string obstacle(const Output& output) const;

  // Of outputs without an obstacle: rows × columns, in our coordinates. M, which the bias needs besides where the base moves,
  // and the change of coordinates cost no time in time_per_call().
  Eigen::MatrixXd result(const Output& output, const State& state) const;
  CallTime time_per_call(const Output& output, const std::vector<State>& states) const;

 private:
  struct Peer;
  struct Input {
    std::vector<double> qpos, qvel, more;
  };
  struct Turned;
  using Quantity = const double*(Peer*, const double* qpos, const double* qvel, const double* more);

  void load(const CompilerOptions& compiler);
  Quantity* function(ir::Quantity quantity) const;
  Input input_of(const Output& output, const State& state) const;

  Model model_;
  std::string version_, obstacle_;
  std::unique_ptr<LoadedCode> code_;
  std::shared_ptr<Peer> peer_;
};

}  // namespace dalembert::reporting
