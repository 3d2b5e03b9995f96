#include "ir/matrix_step.hpp"

#include "ir/coordinate_tree.hpp"
#include "ir/kinematic_tree.hpp"

namespace dalembert::ir {
namespace {

using Kind = MatrixStep::Kind;

// As written.
Operations factor(const CoordinateTree& tree) {
  Operations o;
  for (int k = 0; k < tree.size(); ++k) {
    const long above = tree.depth(k), products = above * (above + 1) / 2;
    o.multiply += products + above, o.add += products;
    ++o.divide;
  }
  return o;
}
Operations solve(const CoordinateTree& tree) {
  Operations o;
  for (int k = 0; k < tree.size(); ++k) {
    o.multiply += 2 * tree.depth(k), o.add += 2 * tree.depth(k);
    ++o.divide;
  }
  return o;
}

// As runtime/include/dalembert/solve.hpp takes them: M's factors by lanes, one column solved for number by number.
Operations executed_factor(const CoordinateTree& tree) {
  constexpr long lanes = 4;
  Operations o;
  const auto by_lanes = [&](long count, long factors) {
    const long each = factors * ((count + lanes - 1) / lanes * lanes);
    o.multiply += each, o.add += each;
  };
  for (const Chain& chain : chains(tree)) {
    const long above = tree.depth(chain.first), m = chain.count;
    for (long k = 0; k < m; ++k)
      for (long i = 0; i < k; ++i) by_lanes(above + i + 1, 1);
    for (long i = 0; i < above; ++i) by_lanes(i + 1, m);
    o.multiply += above * m + m * (m - 1);
    o.divide += m;
  }
  return o;
}
Operations executed_solve(const CoordinateTree& tree) {
  Operations o;
  for (int k = 0; k < tree.size(); ++k) o.add += 2 * tree.depth(k);
  o.multiply = o.add;
  o.divide = tree.size();
  return o;
}

// As runtime/include/dalembert/factor.hpp takes them: by eights of a column, and a chain's own in fours or eights.
long padded(long count, bool executed) { return executed ? (count + 7) / 8 * 8 : count; }
long padded_chain(long count, bool executed) { return !executed ? count : count <= 4 ? 4 : 8; }

Operations negative_product(const CoordinateTree& tree, const Chain& chain, bool executed) {
  const long rows = tree.depth(chain.first) + tree.last[static_cast<std::size_t>(chain.first)] + 1 - chain.first;
  Operations o;
  o.multiply = o.add = chain.count * rows * padded(tree.size(), executed);
  return o;
}
Operations invert(const CoordinateTree& tree, const Chain& chain, bool executed) {
  const long m = chain.count, above = tree.depth(chain.first), pairs = m * (m - 1) / 2, own = padded_chain(m, executed);
  Operations o;
  o.multiply = o.add = (m * above + pairs) * padded(chain.first, executed) + (2 * pairs + m * above) * own;
  o.multiply += m * own;
  o.divide = m;
  return o;
}

}  // namespace

std::vector<int> MatrixStep::read() const {
  std::vector<int> arrays{a};
  if (kind == Kind::invert || kind == Kind::negative_product) arrays.push_back(b);
  if (kind == Kind::solve) arrays.push_back(to);
  return arrays;
}

std::vector<int> MatrixStep::filled() const {
  std::vector<int> arrays{to};
  if (kind == Kind::factor) arrays.push_back(b);
  if (kind == Kind::invert) arrays.push_back(room);
  return arrays;
}

Operations operations_of(const MatrixStep& step, const KinematicTree& kinematic_tree, bool executed) {
  const CoordinateTree tree = coordinate_tree(kinematic_tree);
  if (step.kind == Kind::factor) return executed ? executed_factor(tree) : factor(tree);
  if (step.kind == Kind::solve) return executed ? executed_solve(tree) : solve(tree);
  Operations o;
  for (const Chain& chain : chains(tree, step.first))
    o += step.kind == Kind::invert ? invert(tree, chain, executed) : negative_product(tree, chain, executed);
  return o;
}

}  // namespace dalembert::ir
