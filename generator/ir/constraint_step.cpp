#include "ir/constraint_step.hpp"

#include <algorithm>

#include "dalembert/constraint_shapes.hpp"
#include "ir/coordinate_tree.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/scene.hpp"

namespace dalembert::ir {
namespace {

// The last coordinate that moves the body; -1: none.
int last_coordinate(const KinematicTree& tree, int body) {
  const std::vector<int> coordinates = tree.coordinates();
  const int base = tree.nv() - tree.independent_joints();
  int last = base - 1;
  for (; body >= 0; body = tree.bodies[static_cast<std::size_t>(body)].parent)
    last = std::max(last, base + coordinates[static_cast<std::size_t>(body)]);
  return last;
}

int shared(const ConstraintPaths& paths, std::size_t a, std::size_t b) {
  const auto of = [&](std::size_t c) { return paths.path.begin() + paths.begin[c]; };
  const auto end = [&](std::size_t c) { return paths.path.begin() + paths.begin[c + 1]; };
  return static_cast<int>(std::mismatch(of(a), end(a), of(b), end(b)).first - of(a));
}

}  // namespace

std::vector<int> ConstraintStep::read() const {
  std::vector<int> arrays{jacobian, factor, pivots};
  if (right >= 0) arrays.push_back(right);
  if (kind != Kind::delassus) arrays.push_back(to);
  return arrays;
}

int ConstraintPaths::longest() const {
  int most = 0;
  for (std::size_t c = 0; c + 1 < begin.size(); ++c) most = std::max(most, begin[c + 1] - begin[c]);
  return most;
}

int ConstraintPaths::block_rows() const {
  int most = 0;
  for (std::size_t c = 0; c + 1 < first.size(); ++c) most = std::max(most, first[c + 1] - first[c]);
  return dalembert::block_rows(most);
}

ConstraintPaths constraint_paths(const KinematicTree& tree, const Scene& scene) {
  const CoordinateTree coordinates = coordinate_tree(tree);
  ConstraintPaths paths{{0}, {}, {0}};
  for (const Contact& contact : scene.contacts) {
    const auto link =
        std::find_if(tree.links.begin(), tree.links.end(), [&](const LinkPlacement& l) { return l.link == contact.link; });
    std::vector<int> above;
    for (int k = last_coordinate(tree, link->body); k >= 0; k = coordinates.above[static_cast<std::size_t>(k)])
      above.push_back(k);
    paths.path.insert(paths.path.end(), above.rbegin(), above.rend());
    paths.begin.push_back(static_cast<int>(paths.path.size()));
    paths.first.push_back(paths.first.back() + contact.rows());
  }
  return paths;
}

int constraint_room(const ConstraintPaths& paths) {
  return dalembert::constraint_room(paths.count(), paths.block_rows(), paths.longest());
}

Operations operations_of(const ConstraintStep& step, const KinematicTree& tree, bool executed) {
  const ConstraintPaths& paths = step.paths;
  const CoordinateTree coordinates = coordinate_tree(tree);
  const long block = paths.block_rows(), padded = dalembert::block_lanes(paths.block_rows()), n = tree.nv();
  const auto count = static_cast<std::size_t>(paths.count());
  // Rows of a constraint as they stand in front of a product, and behind it.
  const auto rows = [&](std::size_t c) { return executed ? block : static_cast<long>(paths.first[c + 1] - paths.first[c]); };
  const auto lanes = [&](std::size_t c) { return executed ? padded : rows(c); };
  Operations o;
  const auto multiply_adds = [&](long times) { o.multiply += times, o.add += times; };
  o.divide += n;
  for (std::size_t a = 0; a < count; ++a) {
    const long length = paths.begin[a + 1] - paths.begin[a];
    multiply_adds(length * (length - 1) / 2 * lanes(a));
    o.multiply += length * lanes(a);
    for (std::size_t b = a; b < count; ++b) {
      const long elements = rows(a) * lanes(b);
      multiply_adds(shared(paths, a, b) * (a == b && !executed ? rows(a) * (rows(a) + 1) / 2 : elements));
    }
  }
  if (step.kind == ConstraintStep::Kind::delassus) return o;
  long all = 0;
  for (std::size_t c = 0; c < count; ++c) {
    const long length = paths.begin[c + 1] - paths.begin[c];
    multiply_adds(2 * length * lanes(c));  // on the right, and forces on coordinates
    o.divide += rows(c);
    multiply_adds(rows(c) * (rows(c) - 1) * lanes(c));
    for (std::size_t a = c + 1; a < count; ++a) {
      multiply_adds(rows(c) * rows(c) * lanes(a));
      for (std::size_t b = a; b < count; ++b) multiply_adds(rows(c) * rows(a) * lanes(b));
      all += 2 * rows(c) * lanes(a);
    }
    all += rows(c) * lanes(c);
  }
  multiply_adds(step.solutions * all);
  for (int k = 0; k < coordinates.size(); ++k)
    multiply_adds(step.kind == ConstraintStep::Kind::impact && !executed ? coordinates.depth(k) : 2 * coordinates.depth(k));
  o.multiply += n;
  return o;
}

}  // namespace dalembert::ir
