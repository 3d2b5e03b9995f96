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

void InputsRead::add(const Input& in) {
  if (in.kind == InputKind::position) positions.insert(in.index);
  if (in.kind == InputKind::velocity) velocities.insert(in.index);
  input = input || in.kind == InputKind::acceleration || in.kind == InputKind::effort;
}

InputsRead inputs_read(const Program& program, const std::vector<std::int32_t>& uses) {
  InputsRead read;
  read.base_positions = program.base_positions;
  for (NodeId id = 0; id < program.graph.size(); ++id)
    if (const Node& n = program.graph[id]; uses[static_cast<std::size_t>(id)] > 0 && n.op == Op::input) read.add(n.input);
  return read;
}

}  // namespace dalembert::ir
