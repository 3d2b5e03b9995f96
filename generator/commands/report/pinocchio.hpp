// Pinocchio beside the generated code: a library of its algorithms (report/pinocchio_calls.h), made once where its sources are,
// and loaded where it is found: $DALEMBERT_PINOCCHIO, or libdalembert_pinocchio.so in the folder lib beside this program's.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "commands/output.hpp"
#include "commands/report/pinocchio_calls.h"
#include "commands/state_file.hpp"
#include "commands/timing.hpp"
#include "pipeline.hpp"

namespace dalembert::reporting {

inline constexpr const char* pinocchio_variant = "Pinocchio";

// The library with one robot in it.
class PinocchioRobot {
 public:
  // Throws std::runtime_error where there is no library, or it cannot be loaded.
  PinocchioRobot(const ir::KinematicTree& tree, const Eigen::Vector3d& gravity);

  std::string version() const;   // "3.7.0"
  std::string compiled() const;  // "clang++ 14.0.6, -O3 -march=native"

  using Call = dalembert_pinocchio_call;
  // The call that computes just these, or, of one quantity, the first that computes it among others; null: there is none.
  const Call* call(const std::vector<ir::Quantity>& quantities) const;

  // `more`: what the function takes besides q and v.
  void run(const Call& call, const double* q, const double* v, const double* more) const { call.run(robot_.get(), q, v, more); }
  // Of the run before, in our layout.
  Eigen::MatrixXd result(const Call& call, ir::Quantity quantity, int rows, int columns) const;

 private:
  template <class Function>
  Function* function(const char* name) const;

  std::shared_ptr<void> library_;
  std::vector<Call> calls_;
  std::shared_ptr<dalembert_pinocchio_robot> robot_;
};

// Where the library is, or would be.
std::string pinocchio_library();

// A report's.
class Pinocchio {
 public:
  explicit Pinocchio(const Model& model);

  bool found() const { return robot_ != nullptr; }
  std::string version() const { return robot_->version(); }
  std::string compiled() const { return robot_->compiled(); }

  // Why it does not compute this; empty: it does.
  std::string obstacle(const Output& output) const;
  // Of outputs without an obstacle: rows × columns, in our layout.
  Eigen::MatrixXd result(const Output& output, const State& state) const;
  CallTime time_per_call(const Output& output, const std::vector<State>& states) const;

 private:
  State input_of(const Output& output, const State& state) const;
  const PinocchioRobot::Call* call(const Output& output) const;

  Model model_;
  std::unique_ptr<PinocchioRobot> robot_;
};

}  // namespace dalembert::reporting
