#include "ir/coordinate_tree.hpp"

#include <algorithm>
#include <set>

#include "dalembert/chain_shapes.hpp"

namespace dalembert::ir {

int CoordinateTree::depth(int coordinate) const {
  int count = 0;
  for (int k = above[static_cast<std::size_t>(coordinate)]; k >= 0; k = above[static_cast<std::size_t>(k)]) ++count;
  return count;
}

namespace {

// Per coordinate, the last of those before it that it is tied to when all behind it have been eliminated.
std::vector<int> elimination(const KinematicTree& tree, int base) {
  const std::vector<int> coordinates = tree.coordinates();
  std::vector<std::set<int>> tied(static_cast<std::size_t>(tree.nv()));
  const auto tie = [&](int i, int k) {
    if (i != k) tied[static_cast<std::size_t>(std::max(i, k))].insert(std::min(i, k));
  };
  // Those that move a joint: its own, or what it follows by loops.
  const auto moving = [&](int body) {
    if (tree.bodies[static_cast<std::size_t>(body)].driven()) body = tree.bodies[static_cast<std::size_t>(body)].driven_by;
    std::vector<int> own;
    if (const int coordinate = coordinates[static_cast<std::size_t>(body)]; coordinate >= 0) own.push_back(base + coordinate);
    for (const Linkage& linkage : tree.linkages)
      if (std::find(linkage.dependent.begin(), linkage.dependent.end(), body) != linkage.dependent.end())
        for (const int followed : linkage.independent) own.push_back(base + coordinates[static_cast<std::size_t>(followed)]);
    return own;
  };
  for (int k = 0; k < tree.joints(); ++k)
    for (const int own : moving(k)) {
      for (int j = 0; j < base; ++j) tie(j, own);
      for (int i = k; i >= 0; i = tree.bodies[static_cast<std::size_t>(i)].parent)
        for (const int above : moving(i)) tie(above, own);
    }
  for (int k = 0; k < base; ++k)
    for (int j = 0; j < k; ++j) tie(j, k);
  std::vector<int> above(tied.size(), -1);
  for (std::size_t k = tied.size(); k-- > 0;) {
    if (tied[k].empty()) continue;
    above[k] = *tied[k].rbegin();
    std::set<int>& next = tied[static_cast<std::size_t>(above[k])];
    for (const int i : tied[k])
      if (i != above[k]) next.insert(i);
  }
  return above;
}

}  // namespace

CoordinateTree coordinate_tree(const KinematicTree& tree) {
  CoordinateTree t;
  if (tree.within) return t;  // nothing is solved with a part of M
  const int base = tree.base_coordinates();
  if (tree.independent_joints() < tree.joints()) {
    t.above = elimination(tree, base);
  } else {
    for (int j = 0; j < base; ++j) t.above.push_back(j - 1);
    for (const Body& body : tree.bodies) t.above.push_back(base + body.parent);
  }
  for (int k = 0; k < t.size(); ++k) t.last.push_back(k);
  for (std::size_t k = t.above.size(); k-- > 0;)
    if (t.above[k] >= 0) {
      int& last = t.last[static_cast<std::size_t>(t.above[k])];
      last = std::max(last, t.last[k]);
    }
  return t;
}

int most_above(const CoordinateTree& tree) {
  int most = 0;
  for (int k = 0; k < tree.size(); ++k) most = std::max(most, tree.depth(k));
  return most;
}

std::vector<Chain> chains(const CoordinateTree& tree, int first) {
  std::vector<int> directly_below(tree.above.size(), 0);
  for (const int k : tree.above)
    if (k >= 0) ++directly_below[static_cast<std::size_t>(k)];
  std::vector<Chain> found;
  for (int k = first; k < tree.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    const bool goes_on =
        !found.empty() && found.back().count < longest_chain && tree.above[at] == k - 1 && directly_below[at - 1] == 1;
    if (goes_on) ++found.back().count;
    else found.push_back({k, 1});
  }
  return found;
}

}  // namespace dalembert::ir
