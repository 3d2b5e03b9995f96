#include "ir/embedding_cost.hpp"

#include "ir/kinematic_tree.hpp"

namespace dalembert::ir {

Operations operations_of_linkages(const KinematicTree& tree, bool moving) {
  Operations o;
  const auto multiply_adds = [&](long count) { o.multiply += count, o.add += count; };
  for (const Linkage& linkage : tree.linkages) {
    const long d = static_cast<long>(linkage.dependent.size()), y = static_cast<long>(linkage.independent.size()),
               times = moving ? 2 : 1;
    long joints = 0;
    for (const LinkageLoop& loop : linkage.loops) {
      const long own = static_cast<long>(loop.joints[0].size() + loop.joints[1].size()), rows = loop.rows();
      joints += own;
      multiply_adds(times * own * (2 * 60 + rows * (moving ? 12 : 3)));
    }
    o.sincos += 2 * times * joints;
    multiply_adds(times * (d * (d * d - 1) / 3 + d * d * y) + (moving ? d * d * y + 2 * d * y : 0));
    o.divide += times * (d * (d + 1) / 2 + d * y);
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
    case Kind::coriolis: count = (2 * rows + tree.nv()) * elements; break;
    case Kind::bias: count = (rows + 1) * elements; break;
    case Kind::force: count = (rows + 2) * elements; break;
    case Kind::unbalanced: count = elements; break;
  }
  Operations o;
  o.multiply = o.add = count;
  if (p.kind == Kind::unbalanced) o.add += tree.nv();
  return o;
}

}  // namespace dalembert::ir
