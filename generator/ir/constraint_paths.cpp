#include "ir/constraint_paths.hpp"

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
  const int base = tree.base_coordinates();
  int last = base - 1;
  for (; body >= 0; body = tree.bodies[static_cast<std::size_t>(body)].parent)
    last = std::max(last, base + coordinates[static_cast<std::size_t>(body)]);
  return last;
}

// The coordinates above a link's body, the tree's root first.
std::vector<int> coordinates_above(const KinematicTree& tree, const CoordinateTree& coordinates, const std::string& name) {
  std::vector<int> above;
  for (int k = last_coordinate(tree, tree.find_link(name)->body); k >= 0; k = coordinates.above[static_cast<std::size_t>(k)])
    above.push_back(k);
  std::reverse(above.begin(), above.end());
  return above;
}

}  // namespace

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
  ConstraintPaths paths{{0}, {}, {0}, {}, {}, {}, {}};
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
  paths.regularization.assign(scene.contacts.size(), contact_rows);
  paths.regularization.resize(scene.contacts.size() + scene.loops.size(), loop_rows);
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
  for (int k = 0; k < tree.joints(); ++k) {
    const Body& body = tree.bodies[static_cast<std::size_t>(k)];
    if (std::count(scene.passive.begin(), scene.passive.end(), body.of.empty() ? body.joint : body.of) > 0)
      undriven.push_back(base + coordinates[static_cast<std::size_t>(k)]);
  }
  std::sort(undriven.begin(), undriven.end());
  undriven.erase(std::unique(undriven.begin(), undriven.end()), undriven.end());
  return undriven;
}

}  // namespace dalembert::ir
