#include "ir/coordinate_tree.hpp"

#include <algorithm>

#include "dalembert/chain_shapes.hpp"

namespace dalembert::ir {

int CoordinateTree::depth(int coordinate) const {
  int count = 0;
  for (int k = above[static_cast<std::size_t>(coordinate)]; k >= 0; k = above[static_cast<std::size_t>(k)]) ++count;
  return count;
}

CoordinateTree coordinate_tree(const KinematicTree& tree) {
  CoordinateTree t;
  const int base = tree.nv() - tree.independent_joints();
  for (int j = 0; j < base; ++j) t.above.push_back(j - 1);
  for (const Body& body : tree.bodies) t.above.push_back(base + body.parent);
  for (int k = 0; k < t.size(); ++k) t.last.push_back(k);
  for (std::size_t k = t.above.size(); k-- > 0;)
    if (t.above[k] >= 0) {
      int& last = t.last[static_cast<std::size_t>(t.above[k])];
      last = std::max(last, t.last[k]);
    }
  return t;
}

std::vector<Chain> chains(const CoordinateTree& tree, int first) {
  std::vector<Chain> found;
  for (int k = first; k < tree.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    const bool goes_on =
        !found.empty() && found.back().count < longest_chain && tree.above[at] == k - 1 && tree.last[at] == tree.last[at - 1];
    if (goes_on) ++found.back().count;
    else found.push_back({k, 1});
  }
  return found;
}

}  // namespace dalembert::ir
