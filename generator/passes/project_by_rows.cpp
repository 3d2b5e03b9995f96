#include "passes/project_by_rows.hpp"

#include <map>
#include <set>

#include "ir/moved_links.hpp"
#include "ir/row_runs.hpp"

namespace dalembert::passes {

std::vector<ir::ProjectedBody> projected_bodies(const ir::KinematicTree& tree, const ir::Projection& projection,
                                                const ir::OutputArray& array) {
  std::vector<ir::ProjectedBody> bodies;
  const std::vector<int> links = ir::numbers_of_links(tree);
  for (int k = 0; k < tree.joints(); ++k) {
    const int link = links[static_cast<std::size_t>(k)];
    if (link < 0) continue;
    const int column = array.column(static_cast<int>(projection.columns.size()) * link);
    if (column >= 0) bodies.push_back({k, column, ir::row_runs(tree, k, array.row_map)});
  }
  return bodies;
}

namespace {

ir::Operations operations_of(const ir::Program& program, const std::set<int>& arrays) {
  return ir::count(program.graph, ir::uses(program.graph, program.roots(arrays)));
}

// Of two counts, the second of some of the first's nodes.
ir::Operations rest(const ir::Operations& whole, const ir::Operations& part) {
  return {whole.add - part.add, whole.multiply - part.multiply, whole.divide - part.divide, whole.sincos - part.sincos};
}

// Operations and stores of a projection's rows of joints, by the body's first column: of what no other element needs.
std::map<int, long> alone_in_line(const ir::Program& program, const ir::Projection& p, int base_rows) {
  constexpr int nobody = -1, several = -2;
  const int columns = static_cast<int>(p.columns.size());
  std::vector<int> user(static_cast<std::size_t>(program.graph.size()), nobody);
  std::map<int, long> alone;
  const auto use = [&](ir::NodeId node, int by) {
    if (node == ir::no_node) return;
    int& one = user[static_cast<std::size_t>(node)];
    one = one == nobody || one == by ? by : several;
  };
  for (const ir::OutputElement& e : program.elements) {
    const bool of_joint = e.array == p.array && e.row >= base_rows;
    const int by = of_joint ? e.column / columns * columns : several;
    use(e.node, by);
    if (of_joint) ++alone[by];
  }
  for (ir::NodeId id = program.graph.size() - 1; id >= 0; --id) {
    const int by = user[static_cast<std::size_t>(id)];
    if (by == nobody) continue;
    const ir::Node& n = program.graph[id];
    use(n.a, by), use(n.b, by);
    ir::Operations own;
    own.count(n.op);
    if (by != several) alone[by] += own.total();
  }
  return alone;
}

// Whether lanes along rows take less time than straight lines, which know more zeros: of registers of four, the usual ones.
// A body's first register waits for its own sums, the next are computed beside it.
bool lanes_pay(const ir::Projection& p, const ir::ProjectedBody& body, long alone) {
  const long each = ir::count(p.graph, ir::uses(p.graph, p.columns)).total();
  constexpr long handed_on = 30;
  const long registers = ir::row_counts({body}, 4).registers;
  const long in_lanes = each + handed_on + registers * (each / 2 + static_cast<long>(p.columns.size()));
  return alone > in_lanes;
}

}  // namespace

void project_by_rows(ir::Algorithm& algorithm, ir::Program& program, Unroll& unroll, const ir::KinematicTree& tree) {
  const int base_rows = tree.base_coordinates();
  const auto array = [&](const std::string& name, int rows, int columns) {
    algorithm.arrays.push_back({name, rows, columns, true});
    return static_cast<int>(algorithm.arrays.size()) - 1;
  };
  const auto put = [&](int to, int row, int column, ir::NodeId node) {
    if (!program.graph.is_constant(node, 0)) program.elements.push_back({to, row, column, node});
  };
  for (ir::Projection& p : algorithm.projections) {
    constexpr int most_in_line = 6;  // of fewer columns straight lines are as fast, or faster
    const int columns = static_cast<int>(p.columns.size());
    const ir::OutputArray& to = algorithm.arrays[static_cast<std::size_t>(p.array)];
    if (columns <= most_in_line || to.is_part()) continue;
    p.by_rows = projected_bodies(tree, p, to);
    std::map<int, long> alone = alone_in_line(program, p, base_rows);
    std::erase_if(p.by_rows, [&](const ir::ProjectedBody& body) { return !lanes_pay(p, body, alone[body.column]); });
    if (p.by_rows.empty()) continue;
    const ir::Operations in_line = operations_of(program, {p.array});
    std::set<int> theirs;  // first columns
    for (const ir::ProjectedBody& body : p.by_rows) theirs.insert(body.column);
    std::erase_if(program.elements, [&](const ir::OutputElement& e) {
      return e.array == p.array && e.row >= base_rows && theirs.contains(e.column / columns * columns);
    });
    const std::vector<ir::Input> of_body = p.inputs(ir::InputKind::state), of_joint = p.inputs(ir::InputKind::carried);
    const std::string name = to.name;
    constexpr int room = 8;  // registers are read from any row on
    p.bodies = array(name + "_bodies", static_cast<int>(of_body.size()), tree.joints());
    p.joints = array(name + "_joints", tree.joints() + room, static_cast<int>(of_joint.size()));
    for (const ir::ProjectedBody& body : p.by_rows)
      for (std::size_t i = 0; i < of_body.size(); ++i)
        put(p.bodies, static_cast<int>(i), body.body, unroll.kept(of_body[i].index, of_body[i].component, body.body));
    for (int k = 0; k < tree.joints(); ++k)
      for (std::size_t i = 0; i < of_joint.size(); ++i)
        put(p.joints, k, static_cast<int>(i), unroll.kept(of_joint[i].index, of_joint[i].component, k));
    program.counted.shares.push_back({{p.array}, rest(in_line, operations_of(program, {p.array, p.bodies, p.joints}))});
  }
  if (!algorithm.projections.empty()) program.arrays = algorithm.arrays;
}

}  // namespace dalembert::passes
