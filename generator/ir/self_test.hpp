// What generated code must give at a few states: the data of the emitted self-test. Numbers are exact in the scene's scalar
// where they are inputs, and right to its last place where they are results.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "ir/robot_description.hpp"
#include "ir/run_time_inputs.hpp"

namespace dalembert::ir {

// Numbers of one output at one state. Elements: whole columns one after another, of a symmetric matrix from the diagonal
// downwards. Products: each row times the test vector (dalembert/self_test.hpp), for which every element counts.
struct Expectation {
  enum class Kind { elements, symmetric_elements, products };

  int array = 0;  // index into the arrays of all functions, one after another
  int state = 0;  // index into SelfTest::states
  Kind kind = Kind::elements;
  std::vector<int> columns;  // those that are compared; of products: empty
  bool complete = true;      // `columns` are all there are
  std::vector<double> values;
  double scale = 1;      // errors are relative to it
  double tolerance = 0;  // largest relative error of right code
};

struct SelfTest {
  struct State {
    Eigen::VectorXd q, v;
    Eigen::VectorXd input{};  // what a function takes besides
  };
  std::vector<State> states;
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  // m/s², world axes: for a scene that gives it at run time
  Eigen::VectorXd wrenches{};                         // six numbers each, in the scene's order
  std::vector<Inertia> payloads;                      // in the links' frames, in the scene's order
  std::vector<Expectation> expectations;
  // Of dv/dt of one linearly implicit step of `step` seconds from the states, where the scene asks for such rollouts: vectors.
  std::vector<Expectation> implicit{};
  double step = 0;
  std::vector<int> left_out;  // indices as above: outputs whose results the scalar cannot hold
  std::string precision;      // of the arithmetic behind the expectations, in words

  // What the scene's run-time input has in it: one of those that there is one of for each state.
  std::vector<double> given(const RunTimeInput& input) const;
};

}  // namespace dalembert::ir
