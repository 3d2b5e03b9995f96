#include <algorithm>
#include <set>

#include "dalembert/constraint_shapes.hpp"
#include "ir/coordinate_tree.hpp"
#include "ir/kernel.hpp"
#include "ir/kinematic_tree.hpp"

namespace dalembert::ir {
namespace {

using Kind = Kernel::Kind;

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

int shared(const ConstraintPaths& paths, std::size_t a, std::size_t b) {
  const auto of = [&](std::size_t c) { return paths.path.begin() + paths.begin[c]; };
  const auto end = [&](std::size_t c) { return paths.path.begin() + paths.begin[c + 1]; };
  return static_cast<int>(std::count_if(of(a), end(a), [&](int k) { return std::binary_search(of(b), end(b), k); }));
}

struct Sum : Operations {
  void multiply_adds(long times) { multiply += times, add += times; }
};

long rows_of(const ConstraintPaths& paths, std::size_t c) { return paths.first[c + 1] - paths.first[c]; }

// Elements of J that are not zero.
long elements(const ConstraintPaths& paths) {
  long sum = 0;
  for (std::size_t c = 0; c + 1 < paths.first.size(); ++c) sum += paths.length(c) * rows_of(paths, c);
  return sum;
}

Operations respond(const Kernel& kernel, const KinematicTree& tree, bool executed) {
  Sum o;
  const long n = tree.nv(), rows = kernel.paths.first.back(), lanes = executed ? padded_rows(static_cast<int>(rows)) : rows,
             column = executed ? inverse_stride(static_cast<int>(n)) : n, known = elements(kernel.paths);
  o.multiply += executed ? n * rows : known;
  o.multiply_adds(known * column);  // M^-1 J'
  if (kernel.kind != Kind::respond_as_solved) {
    o.multiply_adds(executed ? known * lanes : (rows + 1) * known / 2);  // J M^-1 J'
    o.divide += rows;
    o.multiply += rows * lanes;
    o.multiply_adds(rows * (rows - 1) * lanes);
  }
  o.multiply += (kernel.solutions - 1) * rows * lanes;
  o.multiply_adds((kernel.solutions - 1) * rows * rows * lanes);
  o.multiply_adds(n * rows * lanes);   // B
  o.multiply += rows;                  // whether it is made once more
  o.multiply_adds(n * rows * column);  // N
  return o;
}

Operations derive(const Kernel& kernel, const KinematicTree& tree, bool executed) {
  Sum o;
  const long n = tree.nv(), rows = kernel.paths.first.back(), lanes = executed ? padded_rows(static_cast<int>(rows)) : rows,
             column = executed ? inverse_stride(static_cast<int>(n)) : n, more = kernel.turning_rows,
             known = elements(kernel.paths);
  const bool accelerations = kernel[Operand::to] >= 0, forces = kernel[Operand::forces] >= 0;
  if (accelerations) o.multiply_adds(known * column);
  if (forces) o.multiply_adds(known * lanes + n * n * lanes);
  o.multiply_adds(more * n * (column + lanes));
  if (accelerations) o.multiply_adds(more * n * column);
  if (forces) o.multiply_adds(more * n * lanes);
  return o;
}

// The base's equations along the world's axes, where forces have nothing to do with each other.
Operations support_at_points(const Kernel& kernel) {
  Sum o;
  const ConstraintPaths& paths = kernel.paths;
  const long solutions = kernel.solutions;
  o.multiply += 18, o.add += 12;  // what is lacking, along these axes
  o.divide += 6;                  // forces, and the inverse of what moments have left
  o.multiply += 16;
  o.multiply_adds(18);
  o.multiply += 6 * solutions;
  o.multiply_adds(18 * solutions + 6 * (solutions - 1));
  for (std::size_t c = 0; c + 1 < paths.first.size(); ++c) {
    o.multiply += 48, o.add += 45;  // products of rows, force and moment, both along the base's axes and taken from the base
    if (rows_of(paths, c) > 3) o.multiply += 3, o.add += 6;
    o.multiply_adds(6L * (paths.length(c) - 6));
  }
  return o;
}

Operations support(const Kernel& kernel) {
  Sum o;
  const ConstraintPaths& paths = kernel.paths;
  const long u = static_cast<long>(kernel.undriven.size()), rows = paths.first.back();
  o.multiply_adds(u * (u + 1) / 2 * rows + u * rows);
  o.multiply += u * rows + rows;
  o.multiply_adds(u * (u - 1) * (u + 1) / 6 + kernel.solutions * u * u);
  o.divide += u;
  if (!kernel.by_wrenches()) {
    o.multiply_adds(elements(paths));
    return o;
  }
  o.multiply_adds(6 * rows);
  for (std::size_t c = 0; c + 1 < paths.first.size(); ++c) o.multiply_adds(6L * (paths.length(c) - 6));
  return o;
}

// Whether constraints are points of limbs apart, which the runtime solves for limb by limb where loops leave their joints
// beside each other and a register holds a number of each (limbs_apart.hpp): as loops of four lanes and more execute them.
bool are_points_of_limbs_apart(const Kernel& kernel) {
  const ConstraintPaths& paths = kernel.paths;
  const auto count = static_cast<std::size_t>(paths.count());
  if (!kernel.by_limbs() || count < 3 || count > 8) return false;
  for (std::size_t a = 0; a < count; ++a) {
    if (rows_of(paths, a) != 3 || paths.length(a) < 9) return false;
    for (std::size_t b = a + 1; b < count; ++b)
      if (shared(paths, a, b) != 6) return false;
  }
  return true;
}
Operations solve_limbs_apart(const Kernel& kernel, const KinematicTree& tree) {
  const ConstraintPaths& paths = kernel.paths;
  const long limbs = paths.count() <= 4 ? 4 : 8, sums = limbs - 1, n = tree.nv(), joints = limbs * (paths.longest() - 6);
  Sum o;
  o.divide += 6 + joints;
  o.multiply += 39 * joints, o.add += 33 * joints;  // Y, and S of it
  o.multiply_adds(6 * joints + 45 * limbs);
  if (kernel.kind == Kind::delassus_by_limbs) {  // products at the base of each row with all limbs
    o.multiply += 18 * limbs;
    o.multiply_adds(3 * paths.count() * 18 * limbs);
    return o;
  }
  o.multiply += 18 * limbs;  // N
  o.multiply_adds(18 * limbs);
  o.divide += 3 * limbs;  // S^-1
  o.multiply += 10 * limbs;
  o.multiply_adds(9 * limbs);
  o.multiply += 39 * limbs + 15;  // what it makes of the base, factored
  o.multiply_adds((36 + 42 + 45) * limbs + 35);
  o.add += 21 * sums + 6;
  o.divide += 6;
  o.multiply_adds(45 * limbs * (kernel.solutions + 1));  // solutions, and what the last step adds
  o.add += 6 * sums * (kernel.solutions + 2);
  o.multiply += 6 * (kernel.solutions + 2);
  o.multiply_adds(2 * 3 * (joints + 6 * limbs));  // right side, forces on coordinates
  o.multiply += joints, o.add += 6 + joints;
  o.multiply_adds(15 + 12 * (n - 6));
  return o;
}

// J M^-1 J', and where it is not all that is wanted, solving for forces and what they do.
Operations solve_rows(const Kernel& kernel, const KinematicTree& tree, bool executed) {
  const ConstraintPaths& paths = kernel.paths;
  const CoordinateTree coordinates = coordinate_tree(tree);
  const long block = paths.block_rows(), padded = dalembert::block_lanes(paths.block_rows()), n = tree.nv();
  const auto count = static_cast<std::size_t>(paths.count());
  // Rows of a constraint as they stand in front of a product, and behind it.
  const auto rows = [&](std::size_t c) { return executed ? block : rows_of(paths, c); };
  const auto lanes = [&](std::size_t c) { return executed ? padded : rows(c); };
  Sum o;
  const std::set<int> above(paths.path.begin(), paths.path.end());
  const long divided = kernel.by_limbs() ? static_cast<long>(above.size()) : n;
  o.divide += divided;
  for (std::size_t a = 0; a < count; ++a) {
    const long length = paths.length(a), common = paths.common[a], one = paths.split[a] - common, other = length - common - one;
    const auto in_chain = [](long of) { return of * (of - 1) / 2; };
    if (kernel.by_limbs()) {  // up the limb, then up the base
      o.multiply += 12 * (length - 6) * lanes(a);
      o.add += 11 * (length - 6) * lanes(a);
      o.multiply_adds(15 * lanes(a));
    } else {
      o.multiply_adds((in_chain(common) + in_chain(one) + in_chain(other) + common * (one + other)) * lanes(a));
    }
    o.multiply += length * lanes(a);
    for (std::size_t b = a; b < count; ++b)
      o.multiply_adds(shared(paths, a, b) * (a == b && !executed ? rows(a) * (rows(a) + 1) / 2 : rows(a) * lanes(b)));
  }
  if (kernel.kind == Kind::delassus || kernel.kind == Kind::delassus_by_limbs) return o;
  for (std::size_t c = 0; c < count; ++c) o.multiply_adds(2 * paths.length(c) * lanes(c));  // right side, forces on coordinates
  // The inverse of all rows together, and steps with it.
  const long all = paths.first.back();
  const long columns = !executed                             ? all
                       : in_registers(static_cast<int>(all)) ? static_cast<long>(count) * padded
                                                             : padded_rows(static_cast<int>(all));
  o.divide += all;
  o.multiply += all * columns;
  o.multiply_adds(all * (all - 1) * columns);
  o.multiply_adds(kernel.solutions * all * columns);
  for (std::size_t a = 0; a < count; ++a) {  // what the last step adds
    o.multiply_adds(lanes(a));
    for (std::size_t b = a; b < count; ++b) o.multiply_adds((a == b ? 1 : 2) * rows(a) * lanes(b));
  }
  o.multiply += divided;
  if (kernel.by_limbs()) {
    o.add += divided;
    o.multiply_adds(15 + 12 * (n - 6));
    return o;
  }
  for (int k = 0; k < coordinates.size(); ++k)
    o.multiply_adds(kernel.kind == Kind::impact && !executed ? coordinates.depth(k) : 2 * coordinates.depth(k));
  return o;
}

}  // namespace

Operations operations_of(const Kernel& kernel, const KinematicTree& kinematic_tree, bool executed, bool in_loops) {
  const CoordinateTree tree = coordinate_tree(kinematic_tree);
  const auto of_chains = [&](const auto& of) {
    Operations o;
    for (const Chain& chain : chains(tree, kernel.first)) o += of(tree, chain, executed);
    return o;
  };
  switch (kernel.kind) {
    case Kind::factor: return executed ? executed_factor(tree) : factor(tree);
    case Kind::solve: return executed ? executed_solve(tree) : solve(tree);
    case Kind::invert: return of_chains(invert);
    case Kind::negative_product: return of_chains(negative_product);
    case Kind::delassus:
    case Kind::solve_constrained:
    case Kind::impact: return solve_rows(kernel, kinematic_tree, executed);
    case Kind::delassus_by_limbs:
    case Kind::solve_constrained_by_limbs:
    case Kind::impact_by_limbs:
      return in_loops && are_points_of_limbs_apart(kernel) ? solve_limbs_apart(kernel, kinematic_tree)
                                                           : solve_rows(kernel, kinematic_tree, executed);
    case Kind::support:
    case Kind::support_by_wrenches: return support(kernel);
    case Kind::support_at_points: return support_at_points(kernel);
    case Kind::respond:
    case Kind::respond_as_solved: return respond(kernel, kinematic_tree, executed);
    case Kind::derive: return derive(kernel, kinematic_tree, executed);
  }
  return {};
}

}  // namespace dalembert::ir
