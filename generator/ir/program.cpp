#include "ir/program.hpp"

#include <algorithm>

namespace dalembert::ir {

Operations operations(const Program& program) {
  Operations sum = count(program.graph, uses(program.graph, program.roots()));
  for (const CountedElements::Share& share : program.counted.shares) sum += share.operations;
  return sum;
}

Operations counted(const Program& program, const std::set<int>& of_arrays) {
  Operations sum;
  for (const CountedElements::Share& share : program.counted.shares)
    if (std::any_of(share.arrays.begin(), share.arrays.end(), [&](int array) { return of_arrays.contains(array); }))
      sum += share.operations;
  return sum;
}

InputsRead inputs_read(const Program& program, const std::vector<std::int32_t>& uses) {
  InputsRead read;
  read.base_positions = program.base_positions;
  for (NodeId id = 0; id < program.graph.size(); ++id) {
    const Node& n = program.graph[id];
    if (uses[static_cast<std::size_t>(id)] == 0 || n.op != Op::input) continue;
    if (n.input.kind == InputKind::position) read.positions.insert(n.input.index);
    if (n.input.kind == InputKind::velocity) read.velocities.insert(n.input.index);
    read.input = read.input || n.input.kind == InputKind::acceleration || n.input.kind == InputKind::effort;
    read.constraints = read.constraints || n.input.kind == InputKind::constraint;
  }
  return read;
}

}  // namespace dalembert::ir
