// Generated code: each choice of quantities is a library of its own, generated with these outputs only.
#include "code_size.hpp"
#include "contestants.hpp"
#include "generated_robot.hpp"

namespace dalembert::benchmarks {

bool has_generated(const std::string& robot, Quantities quantities) { return find_generated(robot, label(quantities)); }

Contestant dalembert_contestant(const BenchmarkRobot& robot, Quantities quantities) {
  const GeneratedRobot* generated = find_generated(robot.name(), label(quantities));
  if (!generated) return {};
  const auto evaluation = std::make_shared<GeneratedEvaluation>(*generated);
  const CodeSize size = code_size(generated->archive);
  const auto run = [evaluation, &states = robot.states()](int state) { evaluation->run(states[static_cast<size_t>(state)]); };
  return {run,
          [evaluation, run, nv = robot.tree().nv()](int state) {
            run(state);
            return evaluation->results(nv);
          },
          size.text, size.tables};
}

}  // namespace dalembert::benchmarks
