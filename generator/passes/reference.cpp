#include "passes/reference.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace dalembert::passes {
namespace {

// Of arms and chains of three to ten joints the second or third body was the best: further up the first rows of M cost more
// than is saved beyond.
constexpr std::size_t furthest = 4;
// Of what a straight line is chosen for; longer ones take long to compare.
constexpr int most_joints = 64;
// Moments of inertia about the frame's origin, against those about the first body's, that count as no more; and against those
// about a joint, of what is behind it, where neither frame is near.
constexpr double as_near = 1.5, near_enough = 30;

using Path = std::vector<int>;  // from the first body of a branch to one of its bodies

Path path_to(const ir::KinematicTree& tree, int body) {
  Path path;
  for (int at = body; at >= 0; at = tree.bodies[static_cast<std::size_t>(at)].parent) path.push_back(at);
  std::reverse(path.begin(), path.end());
  return path;
}

// Of the path's first body, and of each behind it, the most that it and those behind it can have about the origin of the path's
// last, slides at rest: Σ m d², kg m².
std::vector<double> spreads(const ir::NormalTree& normal, const Path& path) {
  std::vector<double> away(normal.bodies.size(), -1);  // of their origins, along the joints; −1: not of the branch
  std::vector<double> sums(normal.bodies.size(), 0);
  double length = 0;
  for (std::size_t i = path.size(); i-- > 0;) {
    away[static_cast<std::size_t>(path[i])] = length;
    length += normal.bodies[static_cast<std::size_t>(path[i])].translation.norm();
  }
  for (std::size_t k = 0; k < normal.bodies.size(); ++k) {
    const ir::NormalBody& n = normal.bodies[k];
    const double before = n.parent < 0 ? -1 : away[static_cast<std::size_t>(n.parent)];
    if (away[k] < 0 && before >= 0) away[k] = before + n.translation.norm();
    if (away[k] < 0) continue;
    const double reach = std::sqrt(std::max(0.0, n.own.second.trace())) + std::sqrt(n.own.mass) * away[k];
    sums[k] = reach * reach;
  }
  for (std::size_t k = normal.bodies.size(); k-- > 0;)
    if (const int parent = normal.bodies[k].parent; parent >= 0 && sums[k] > 0)
      sums[static_cast<std::size_t>(parent)] += sums[k];
  return sums;
}

// Whether masses are no farther than from the first body, all together and behind each joint: M's smallest element is rounded
// by the squared distances of what is behind its own.
bool is_as_near(const ir::KinematicTree& tree, const ir::NormalTree& normal, const Path& path) {
  const auto slides = [&](int body) {
    return tree.bodies[static_cast<std::size_t>(body)].slides() && !tree.carries_reference(static_cast<std::size_t>(body));
  };
  if (std::any_of(path.begin(), path.end(), slides)) return false;
  const std::vector<double> from_first = spreads(normal, {path.front()}), from_last = spreads(normal, path);
  const auto first = static_cast<std::size_t>(path.front());
  if (from_last[first] > as_near * from_first[first]) return false;
  for (std::size_t k = 0; k < from_last.size(); ++k)
    if (from_last[k] > as_near * from_first[k] && from_last[k] > near_enough * spreads(normal, {static_cast<int>(k)})[k])
      return false;
  return true;
}

// Whether what is asked of one body reads no joint for it that is not above that body.
bool reads_no_more(const ir::Algorithm& algorithm, const ir::KinematicTree& tree, const Path& path) {
  const auto of_others = [&](const ir::Sweep& sweep) {
    if (sweep.over.contains(tree, path.front()) && !sweep.over.contains(tree, path.back())) return true;
    for (ir::NodeId id = 0; id < sweep.graph.size(); ++id) {
      const ir::Node& n = sweep.graph[id];
      if (n.op != ir::Op::input || n.input.kind != ir::InputKind::of_body || n.input.body < 0) continue;
      if (tree.is_above(path.front(), n.input.body) && !tree.is_above(path.back(), n.input.body)) return true;
    }
    return false;
  };
  return std::none_of(algorithm.sweeps.begin(), algorithm.sweeps.end(), of_others);
}

}  // namespace

std::vector<int> reference_bodies(const ir::Algorithm& algorithm, const ir::KinematicTree& tree, const ir::NormalTree& normal,
                                  const std::function<double(const std::vector<int>&)>& cost) {
  const bool free = std::any_of(algorithm.sweeps.begin(), algorithm.sweeps.end(),
                                [](const ir::Sweep& sweep) { return sweep.back.has_value(); });
  if (!free) return {};
  std::map<int, int> best;  // by the first body of the branch
  for (int body = 0; body < tree.joints(); ++body)
    if (tree.bodies[static_cast<std::size_t>(body)].parent < 0) best[body] = body;
  const auto bodies = [](const std::map<int, int>& of_branches) {
    std::vector<int> all;
    for (const auto& [first, body] : of_branches) all.push_back(body);
    return all;
  };
  if (tree.joints() > most_joints) return bodies(best);
  double least = cost(bodies(best));
  for (int body = 0; body < tree.joints(); ++body) {
    const Path path = path_to(tree, body);
    const bool fits = path.size() > 1 && path.size() <= furthest + 1 && is_as_near(tree, normal, path) &&
                      reads_no_more(algorithm, tree, path);
    if (!fits) continue;
    std::map<int, int> tried = best;
    tried[path.front()] = body;
    const double costs = cost(bodies(tried));
    if (costs >= least) continue;
    least = costs, best = std::move(tried);
  }
  return bodies(best);
}

}  // namespace dalembert::passes
