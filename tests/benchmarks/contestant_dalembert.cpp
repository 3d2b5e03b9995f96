// Generated code: each choice of quantities is a library of its own, generated with these outputs only.
#include <memory>
#include <vector>

#include "code_size.hpp"
#include "contestants.hpp"
#include "generated_robot.hpp"

namespace dalembert::benchmarks {

namespace {

// The one that takes more than q and v, if there is one.
ir::Function function_of(const GeneratedRobot& library) {
  for (const GeneratedOutput& output : library.results)
    if (output.values && ir::row_of(output.quantity).function != ir::Function::evaluate)
      return ir::row_of(output.quantity).function;
  return ir::Function::evaluate;
}

}  // namespace

bool has_generated(const std::string& robot, Quantities quantities) { return find_generated(robot, label(quantities)); }

Contestant dalembert_contestant(const BenchmarkRobot& robot, Quantities quantities) {
  const GeneratedRobot* generated = find_generated(robot.name(), label(quantities));
  if (!generated) return {};
  const auto evaluation = std::make_shared<GeneratedEvaluation>(*generated);
  const CodeSize size = code_size(generated->archive);
  struct Input {
    const testing::State* state;
    const Eigen::VectorXd* more;
  };
  std::vector<Input> inputs;
  for (int i = 0; i < BenchmarkRobot::state_count; ++i)
    inputs.push_back({&robot.states()[static_cast<size_t>(i)], &robot.more(function_of(*generated), i)});
  const auto run = [evaluation, inputs](int state) {
    const Input& input = inputs[static_cast<size_t>(state)];
    evaluation->run(*input.state, *input.more);
  };
  return {run,
          [evaluation, run, &robot](int state) {
            run(state);
            return evaluation->results(robot.tree());
          },
          size.text, size.tables};
}

}  // namespace dalembert::benchmarks
