#include "ir/coordinate_tree.hpp"

#include <algorithm>

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

}  // namespace dalembert::ir
