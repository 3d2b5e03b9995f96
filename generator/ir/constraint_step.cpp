#include "ir/constraint_step.hpp"

#include <algorithm>
#include <set>

#include "dalembert/constraint_shapes.hpp"
#include "ir/coordinate_tree.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/scene.hpp"

namespace dalembert::ir {
namespace {

// The last coordinate that moves the body; -1: none.
int last_coordinate(const KinematicTree& tree, int body) {
  const std::vector<int> coordinates = tree.coordinates();
  const int base = tree.base_coordinates();
  int last = base - 1;
  for (; body >= 0; body = tree.bodies[static_cast<std::size_t>(body)].parent)
    last = std::max(last, base + coordinates[static_cast<std::size_t>(body)]);
  return last;
}

int shared(const ConstraintPaths& paths, std::size_t a, std::size_t b) {
  const auto of = [&](std::size_t c) { return paths.path.begin() + paths.begin[c]; };
  const auto end = [&](std::size_t c) { return paths.path.begin() + paths.begin[c + 1]; };
  return static_cast<int>(std::count_if(of(a), end(a), [&](int k) { return std::binary_search(of(b), end(b), k); }));
}

// The coordinates above a link's body, the tree's root first.
std::vector<int> coordinates_above(const KinematicTree& tree, const CoordinateTree& coordinates, const std::string& name) {
  const auto link = std::find_if(tree.links.begin(), tree.links.end(), [&](const LinkPlacement& l) { return l.link == name; });
  std::vector<int> above;
  for (int k = last_coordinate(tree, link->body); k >= 0; k = coordinates.above[static_cast<std::size_t>(k)])
    above.push_back(k);
  std::reverse(above.begin(), above.end());
  return above;
}

}  // namespace

std::vector<int> ConstraintStep::read() const {
  if (kind == Kind::support) return by_wrenches() ? std::vector<int>{jacobian, axes, to} : std::vector<int>{jacobian, to};
  if (kind == Kind::respond) return inverted ? std::vector<int>{jacobian, inverse, room} : std::vector<int>{jacobian, inverse};
  if (kind == Kind::derive) {
    std::vector<int> arrays{room, inverse, efforts, changes};
    for (const int array : {to, left, turned})
      if (array >= 0) arrays.push_back(array);
    return arrays;
  }
  std::vector<int> arrays{jacobian, pivots};
  if (by_limbs()) arrays.insert(arrays.end(), {gain, joint});
  else arrays.push_back(factor);
  if (right >= 0) arrays.push_back(right);
  if (kind != Kind::delassus) arrays.push_back(to);
  return arrays;
}

std::vector<int> ConstraintStep::filled() const {
  std::vector<int> arrays;
  for (const int array : {to, forces, plain, response, kind == Kind::respond ? room : -1})
    if (array >= 0) arrays.push_back(array);
  return arrays;
}

int ConstraintPaths::longest() const {
  int most = 0;
  for (std::size_t c = 0; c + 1 < begin.size(); ++c) most = std::max(most, begin[c + 1] - begin[c]);
  return most;
}

std::vector<int> ConstraintPaths::moving() const {
  std::vector<int> all;
  for (const int k : path)
    if (std::find(all.begin(), all.end(), k) == all.end()) all.push_back(k);
  return all;
}

int ConstraintPaths::block_rows() const {
  int most = 0;
  for (std::size_t c = 0; c + 1 < first.size(); ++c) most = std::max(most, first[c + 1] - first[c]);
  return dalembert::block_rows(most);
}

ConstraintPaths constraint_paths(const KinematicTree& tree, const Scene& scene) {
  const CoordinateTree coordinates = coordinate_tree(tree);
  ConstraintPaths paths{{0}, {}, {0}, {}, {}, {}};
  const auto add = [&](const std::vector<int>& one, const std::vector<int>& other, int rows, int linear) {
    const auto fork = std::mismatch(one.begin(), one.end(), other.begin(), other.end());
    const auto tail = [&](const std::vector<int>& list, std::vector<int>::const_iterator from) {
      paths.path.insert(paths.path.end(), from, list.end());
    };
    // The branches one behind the other, so that the whole is in order.
    const bool swap = fork.first != one.end() && fork.second != other.end() && *fork.second < *fork.first;
    paths.common.push_back(static_cast<int>(fork.first - one.begin()));
    paths.path.insert(paths.path.end(), one.begin(), fork.first);
    if (swap) tail(other, fork.second);
    else tail(one, fork.first);
    paths.split.push_back(static_cast<int>(paths.path.size()) - paths.begin.back());
    if (swap) tail(one, fork.first);
    else tail(other, fork.second);
    // With driven joints branches may be interleaved: M's factors are zero between them, and are read.
    if (const auto begin = paths.path.begin() + paths.begin.back(); !std::is_sorted(begin, paths.path.end())) {
      std::sort(begin, paths.path.end());
      paths.common.back() = paths.split.back() = static_cast<int>(paths.path.end() - begin);
    }
    paths.begin.push_back(static_cast<int>(paths.path.size()));
    paths.first.push_back(paths.first.back() + rows);
    paths.linear.push_back(linear);
  };
  for (const Contact& contact : scene.contacts) {
    const std::vector<int> above = coordinates_above(tree, coordinates, contact.link);
    add(above, above, contact.rows(), 3);
  }
  for (const Loop& loop : scene.loops)
    add(coordinates_above(tree, coordinates, loop.links[0]), coordinates_above(tree, coordinates, loop.links[1]), loop.rows(),
        loop.linear_rows());
  return paths;
}

int constraint_room(const ConstraintPaths& paths) {
  return dalembert::constraint_room(paths.count(), paths.block_rows(), paths.longest(), paths.first.back());
}

std::vector<int> undriven_coordinates(const KinematicTree& tree, const Scene& scene) {
  const std::vector<int> coordinates = tree.coordinates();
  const int base = tree.base_coordinates();
  std::vector<int> undriven;
  for (int j = 0; j < base; ++j) undriven.push_back(j);
  for (int k = 0; k < tree.joints(); ++k)
    if (std::count(scene.passive.begin(), scene.passive.end(), tree.bodies[static_cast<std::size_t>(k)].joint) > 0)
      undriven.push_back(base + coordinates[static_cast<std::size_t>(k)]);
  std::sort(undriven.begin(), undriven.end());
  undriven.erase(std::unique(undriven.begin(), undriven.end()), undriven.end());
  return undriven;
}

namespace {

Operations operations_of_respond(const ConstraintStep& step, const KinematicTree& tree, bool executed) {
  Operations o;
  const auto multiply_adds = [&](long times) { o.multiply += times, o.add += times; };
  const long n = tree.nv(), rows = step.paths.first.back(), lanes = executed ? padded_rows(static_cast<int>(rows)) : rows,
             column = executed ? inverse_stride(static_cast<int>(n)) : n;
  long known = 0;  // elements of J
  for (std::size_t c = 0; c + 1 < step.paths.first.size(); ++c)
    known += static_cast<long>(step.paths.length(c)) * (step.paths.first[c + 1] - step.paths.first[c]);
  o.multiply += executed ? n * rows : known;
  multiply_adds(known * column);  // M^-1 J'
  if (!step.inverted) {
    multiply_adds(executed ? known * lanes : (rows + 1) * known / 2);  // J M^-1 J'
    o.divide += rows;
    o.multiply += rows * lanes;
    multiply_adds(rows * (rows - 1) * lanes);
  }
  o.multiply += (step.solutions - 1) * rows * lanes;
  multiply_adds((step.solutions - 1) * rows * rows * lanes);
  multiply_adds(n * rows * lanes);   // B
  multiply_adds(n * rows * column);  // N
  return o;
}

Operations operations_of_derive(const ConstraintStep& step, const KinematicTree& tree, bool executed) {
  Operations o;
  const auto multiply_adds = [&](long times) { o.multiply += times, o.add += times; };
  const long n = tree.nv(), rows = step.paths.first.back(), lanes = executed ? padded_rows(static_cast<int>(rows)) : rows,
             column = executed ? inverse_stride(static_cast<int>(n)) : n, more = step.turning_rows;
  long known = 0;
  for (std::size_t c = 0; c + 1 < step.paths.first.size(); ++c)
    known += static_cast<long>(step.paths.length(c)) * (step.paths.first[c + 1] - step.paths.first[c]);
  if (step.to >= 0) multiply_adds(known * column);
  if (step.forces >= 0) multiply_adds(known * lanes + n * n * lanes);
  multiply_adds(more * n * (column + lanes));
  if (step.to >= 0) multiply_adds(more * n * column);
  if (step.forces >= 0) multiply_adds(more * n * lanes);
  return o;
}

Operations operations_of_support(const ConstraintStep& step) {
  Operations o;
  const auto multiply_adds = [&](long times) { o.multiply += times, o.add += times; };
  const long u = static_cast<long>(step.undriven.size()), rows = step.paths.first.back();
  multiply_adds(u * (u + 1) / 2 * rows + u * rows);
  o.multiply += u * rows + rows;
  multiply_adds(u * (u - 1) * (u + 1) / 6 + step.solutions * u * u);
  o.divide += u;
  if (step.by_wrenches()) {
    multiply_adds(6 * rows);
    for (std::size_t c = 0; c + 1 < step.paths.first.size(); ++c) multiply_adds(6L * (step.paths.length(c) - 6));
    return o;
  }
  for (std::size_t c = 0; c + 1 < step.paths.first.size(); ++c)
    multiply_adds(static_cast<long>(step.paths.length(c)) * (step.paths.first[c + 1] - step.paths.first[c]));
  return o;
}

}  // namespace

Operations operations_of(const ConstraintStep& step, const KinematicTree& tree, bool executed) {
  if (step.kind == ConstraintStep::Kind::support) return operations_of_support(step);
  if (step.kind == ConstraintStep::Kind::respond) return operations_of_respond(step, tree, executed);
  if (step.kind == ConstraintStep::Kind::derive) return operations_of_derive(step, tree, executed);
  const ConstraintPaths& paths = step.paths;
  const CoordinateTree coordinates = coordinate_tree(tree);
  const long block = paths.block_rows(), padded = dalembert::block_lanes(paths.block_rows()), n = tree.nv();
  const auto count = static_cast<std::size_t>(paths.count());
  // Rows of a constraint as they stand in front of a product, and behind it.
  const auto rows = [&](std::size_t c) { return executed ? block : static_cast<long>(paths.first[c + 1] - paths.first[c]); };
  const auto lanes = [&](std::size_t c) { return executed ? padded : rows(c); };
  Operations o;
  const auto multiply_adds = [&](long times) { o.multiply += times, o.add += times; };
  const std::set<int> above(paths.path.begin(), paths.path.end());
  const long divided = step.by_limbs() ? static_cast<long>(above.size()) : n;
  o.divide += divided;
  for (std::size_t a = 0; a < count; ++a) {
    const long length = paths.length(a), common = paths.common[a], one = paths.split[a] - common, other = length - common - one;
    const auto in_chain = [](long count) { return count * (count - 1) / 2; };
    if (step.by_limbs()) {  // up the limb, then up the base
      o.multiply += 12 * (length - 6) * lanes(a);
      o.add += 11 * (length - 6) * lanes(a);
      multiply_adds(15 * lanes(a));
    } else {
      multiply_adds((in_chain(common) + in_chain(one) + in_chain(other) + common * (one + other)) * lanes(a));
    }
    o.multiply += length * lanes(a);
    for (std::size_t b = a; b < count; ++b) {
      const long elements = rows(a) * lanes(b);
      multiply_adds(shared(paths, a, b) * (a == b && !executed ? rows(a) * (rows(a) + 1) / 2 : elements));
    }
  }
  if (step.kind == ConstraintStep::Kind::delassus) return o;
  for (std::size_t c = 0; c < count; ++c) {
    const long length = paths.begin[c + 1] - paths.begin[c];
    multiply_adds(2 * length * lanes(c));  // on the right, and forces on coordinates
  }
  // The inverse of all rows together, and steps with it.
  const long all = paths.first.back();
  const long columns = !executed                             ? all
                       : in_registers(static_cast<int>(all)) ? static_cast<long>(count) * padded
                                                             : padded_rows(static_cast<int>(all));
  o.divide += all;
  o.multiply += all * columns;
  multiply_adds(all * (all - 1) * columns);
  multiply_adds(step.solutions * all * columns);
  for (std::size_t a = 0; a < count; ++a) {  // what the last step adds
    multiply_adds(lanes(a));
    for (std::size_t b = a; b < count; ++b) multiply_adds((a == b ? 1 : 2) * rows(a) * lanes(b));
  }
  o.multiply += divided;
  if (step.by_limbs()) {
    o.add += divided;
    multiply_adds(15 + 12 * (n - 6));
    return o;
  }
  for (int k = 0; k < coordinates.size(); ++k)
    multiply_adds(step.kind == ConstraintStep::Kind::impact && !executed ? coordinates.depth(k) : 2 * coordinates.depth(k));
  return o;
}

}  // namespace dalembert::ir
