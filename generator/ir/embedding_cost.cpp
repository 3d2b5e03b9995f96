#include "ir/embedding_cost.hpp"

#include "ir/kinematic_tree.hpp"

namespace dalembert::ir {

Operations operations_of_linkages(const KinematicTree& tree, bool moving) {
  Operations o;
  const auto multiply_adds = [&](long count) { o.multiply += count, o.add += count; };
  for (const Linkage& linkage : tree.linkages) {
    const long d = static_cast<long>(linkage.dependent.size()), y = static_cast<long>(linkage.independent.size()),
               times = moving ? 2 : 1;
    const LinkageRows rows = linkage_rows(linkage, tree);
    o += count(rows.graph, uses(rows.graph, rows.at_rest()));
    if (moving) {
      Operations of_rates = count(rows.graph, uses(rows.graph, rows.moving()));
      of_rates.sincos = 0;  // kept
      o += of_rates;
    }
    // Factors once; each of G and G' is solved for.
    multiply_adds((d * d * d - d) / 3 + times * d * d * y + (moving ? d * d * y + 2 * d * y : 0));
    o.divide += d;
  }
  return o;
}

Operations operations_of(const Projected& p, const KinematicTree& tree) {
  using Kind = Projected::Kind;
  const long elements = static_cast<long>(followers(tree).elements.size()), rows = p.from_rows, columns = p.from_columns;
  long count = 0;
  switch (p.kind) {
    case Kind::same: break;
    case Kind::columns: count = rows * elements; break;
    case Kind::rows: count = columns * elements; break;
    case Kind::both: count = (rows + tree.nv()) * elements; break;
    case Kind::both_turned: count = (2 * rows + tree.nv()) * elements; break;
    case Kind::turned: count = (rows + 1) * elements; break;
    case Kind::rows_of_turned: count = (rows + 2) * elements; break;
    case Kind::unbalanced: count = elements; break;
  }
  Operations o;
  o.multiply = o.add = count;
  if (p.kind == Kind::unbalanced) o.add += tree.nv();
  return o;
}

}  // namespace dalembert::ir
